//! The stand of a pump that would have exceeded a safety limit.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::numbers::significant;
use crate::words::words;

/// Limit that keeps a pump safe while nobody looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SafetyLimit {
    /// The most volume in 24 hours.
    Day,
    /// The volume that the receiving vessel holds.
    Vessel,
}

words!(SafetyLimit { Day = "day", Vessel = "vessel" });

/// Stand of a pump that would have exceeded a safety limit. It lasts until a person clears it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Stand {
    /// Limit that was reached.
    pub limit: SafetyLimit,
    /// Volume that counted before the motion that was refused, or after the run that the limit has ended, in mL.
    pub used_ml: f64,
    /// Volume that was planned, in mL; 0 for a run until it was stopped, which the limit has ended.
    pub planned_ml: f64,
    /// Volume that the limit allows, in mL.
    pub allowed_ml: f64,
    /// Time at which the pump came to stand, in seconds since 1970.
    pub unix_s: u64,
}

impl Stand {
    /// Returns the volume that the limit leaves, in mL.
    pub(crate) fn left_ml(&self) -> f64 {
        (self.allowed_ml - self.used_ml).max(0.0)
    }
}

impl fmt::Display for Stand {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [used, planned, allowed] =
            [self.used_ml, self.planned_ml, self.allowed_ml].map(|volume_ml| significant(volume_ml, 6));
        match self.limit {
            SafetyLimit::Day if self.planned_ml == 0.0 => write!(
                to,
                "the limit has ended a run until it was stopped: {used} mL were pumped in the last 24 h, and the limit \
                 of 24 h is {allowed} mL"
            ),
            SafetyLimit::Vessel if self.planned_ml == 0.0 => write!(
                to,
                "the limit has ended a run until it was stopped: the vessel has received {used} mL since it was \
                 emptied, and it holds {allowed} mL"
            ),
            SafetyLimit::Day => write!(
                to,
                "{planned} mL were planned, {used} mL were pumped in the last 24 h, and the limit of 24 h is \
                 {allowed} mL"
            ),
            SafetyLimit::Vessel => write!(
                to,
                "{planned} mL were planned, the vessel has received {used} mL since it was emptied, and it holds \
                 {allowed} mL"
            ),
        }
    }
}
