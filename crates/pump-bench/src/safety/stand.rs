//! The stand of a pump that would have exceeded a safety limit, or was ordered to stand.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::cut_text::CutText;
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
    /// The order of a person or a program.
    Ordered,
}

words!(SafetyLimit { Day = "day", Vessel = "vessel", Ordered = "ordered" });

/// Reason of a stand that was ordered. More than 120 bytes are cut, and the journal keeps the whole text.
pub type StandReason = CutText<120>;

/// Stand of a pump that would have exceeded a safety limit, or that was ordered to stand. It lasts until a person
/// clears it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Stand {
    /// Limit that was reached.
    pub limit: SafetyLimit,
    /// Volume that counted before the motion that was refused, or after the run that the limit has ended, in mL; 0 if
    /// the stand was ordered.
    pub used_ml: f64,
    /// Volume that was planned, in mL; 0 for a run until it is stopped, which ends at the limit, and if the stand
    /// was ordered.
    pub planned_ml: f64,
    /// Volume that the limit allows, in mL; 0 if the stand was ordered.
    pub allowed_ml: f64,
    /// Time at which the pump came to stand, in seconds since 1970.
    pub unix_s: u64,
    /// Reason of a stand that was ordered. `None` at a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<StandReason>,
    /// True once the vessel was emptied while the pump stood.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_emptied: bool,
}

impl Stand {
    /// Returns the stand of a pump at a limit of volumes.
    pub(super) fn at_limit(
        limit: SafetyLimit,
        used_ml: f64,
        planned_ml: f64,
        allowed_ml: f64,
        unix_s: u64,
    ) -> Self {
        Self { limit, used_ml, planned_ml, allowed_ml, unix_s, reason: None, is_emptied: false }
    }

    /// Returns the stand of a pump that is ordered to stand.
    pub(crate) fn ordered(reason: &str, unix_s: u64) -> Self {
        let reason = Some(StandReason::new(reason));
        Self { reason, ..Self::at_limit(SafetyLimit::Ordered, 0.0, 0.0, 0.0, unix_s) }
    }

    /// Returns the words between `stands` and the time: the place where a pump stands.
    pub(crate) fn place(&self) -> &'static str {
        if self.limit == SafetyLimit::Ordered { "by order" } else { "at a safety limit" }
    }

    /// Returns true if the pump stands because of its vessel, which nobody has emptied since.
    pub(crate) fn has_full_vessel(&self) -> bool {
        self.limit == SafetyLimit::Vessel && !self.is_emptied
    }

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
            SafetyLimit::Ordered => {
                let reason = self.reason.as_ref().map_or("no reason was given", StandReason::as_str);
                write!(to, "it was ordered to stand: {reason}")
            }
            SafetyLimit::Day if self.planned_ml == 0.0 => write!(
                to,
                "a run until it is stopped ends at the limit: {used} mL were pumped in the last 24 h, and the limit of \
                 24 h is {allowed} mL"
            ),
            SafetyLimit::Vessel if self.planned_ml == 0.0 && !self.is_emptied => write!(
                to,
                "a run until it is stopped ends at the limit: the vessel has received {used} mL since it was emptied, \
                 and it holds {allowed} mL"
            ),
            SafetyLimit::Day if self.used_ml == 0.0 => {
                write!(to, "{planned} mL were planned, and the limit of 24 h is {allowed} mL")
            }
            SafetyLimit::Day => write!(
                to,
                "{planned} mL were planned, {used} mL were pumped in the last 24 h, and the limit of 24 h is \
                 {allowed} mL"
            ),
            SafetyLimit::Vessel if self.is_emptied => write!(
                to,
                "the vessel had received {used} mL and holds {allowed} mL, and it was emptied since"
            ),
            SafetyLimit::Vessel if self.used_ml == 0.0 => {
                write!(to, "{planned} mL were planned, and the vessel holds {allowed} mL")
            }
            SafetyLimit::Vessel => write!(
                to,
                "{planned} mL were planned, the vessel has received {used} mL since it was emptied, and it holds \
                 {allowed} mL"
            ),
        }
    }
}
