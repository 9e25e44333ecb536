//! One dose in the log.

use pump_model::Pump;
use serde::{Deserialize, Serialize};

use super::{LogEnd, Stamp};
use crate::record::{DosedFluid, Purpose, ShortText, Unfinished};

/// Place of an entry in the log: the number of its dose, and whether it is the second entry of that dose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct LogPlace {
    pub(crate) number: u64,
    pub(crate) counted_later: bool,
}

/// One dose in the log: a motion that delivers, or all stretches that one command makes of a dose by weight.
///
/// The rest of a dose that was stopped and resumed, and the retraction after a dose, have entries of their own. Each
/// tells its own share, so the volumes of all entries add up. A turn of the rotor to a mark has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LogEntry {
    /// Number of the dose, one more than that of the dose before.
    pub number: u64,
    /// Time at which the dose began, by the clock of that day.
    pub time: Stamp,
    /// Purpose of the dose.
    pub purpose: Purpose,
    /// Volume as it was typed. `None` if a program gave a number.
    pub asked: Option<ShortText>,
    /// Volume that was asked for, in mL. Negative in reverse.
    pub requested_ml: f64,
    /// True for a run until it is stopped. `requested_ml` is then the most that it may have delivered.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub until_stopped: bool,
    /// Volume that the made steps are booked with, in mL. A dose that a balance ended has the weighed volume.
    pub delivered_ml: f64,
    /// Smallest and largest volume, in mL, where nobody knows how many steps were made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delivered_range_ml: Option<(f64, f64)>,
    /// Expanded uncertainty (k = 2) of the delivered volume, in mL. `None` for a retraction. A dose that was cut off
    /// has that of the part that was made, with half of the volume of the steps that nobody counted added. It is that
    /// of the whole plan if the pump file or the calibration has changed since, so that the plan cannot be made anew.
    pub expanded_uncertainty_ml: Option<f64>,
    /// Carry to the next dose, in mL. Positive toward the outlet.
    pub carry_ml: f64,
    /// End of the dose.
    pub end: LogEnd,
    /// Cause of a fault with its sources, or who or what stopped the dose. `None` where there is none, or nobody says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// Rack of which the dose was a part. `None` for a pump by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rack: Option<ShortText>,
    /// Order of a service by which the dose was made. `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<ShortText>,
    /// True if the dose is the rest of one that was stopped or cut off.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub resumed: bool,
    /// True if the device told the steps made after the dose was first recorded, because it was out of reach then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub counted_later: bool,
    /// Number of the tube, from 1. Each new tube has the next number.
    pub tube: u32,
    /// Number of the calibration that the dose used. `None` without one.
    pub calibration: Option<u32>,
    /// Fluid that was pumped. `None` in an entry of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluid: Option<DosedFluid>,
    /// Motor steps made, negative in reverse. `None` where nobody knows.
    pub steps: Option<i64>,
    /// Time that the motion took, in s. `None` where nobody knows.
    pub motion_s: Option<f64>,
}

impl LogEntry {
    /// Describes a motion of `part` that the drive has ended, or of which nobody has recorded the end. `number` is the
    /// next number, for a motion of an early version that tells none. `expanded_ml` is the expanded uncertainty of the
    /// most steps that it may have made, in mL.
    pub(crate) fn of(
        part: &Unfinished,
        pump: &Pump,
        end: LogEnd,
        tube: u32,
        number: u64,
        expanded_ml: Option<f64>,
    ) -> Self {
        let Unfinished { intent, made_least, made_most, .. } = *part;
        let told = intent.told;
        let is_exact = made_least == made_most;
        let earlier_ml = told.map_or(0.0, |told| told.earlier_ml);
        // The stretches that one command makes of a dose by weight are one entry.
        let delivered = if intent.terms.by_weight {
            part.delivered(pump).less(earlier_ml)
        } else {
            part.motion_delivered(pump)
        };
        // The uncertainty has the angle's share. The steps that nobody counted are added. The plan of a run
        // until it is stopped is no measure of what it delivered, so its bounds alone are told.
        let [fewest_ml, most_steps_ml] = [made_least, made_most].map(|made| intent.delivered_ml(pump, made));
        let half_ml = 0.5 * (most_steps_ml - fewest_ml).abs();
        let is_endless = intent.terms.until_stopped;
        let uncertainty_ml = expanded_ml.filter(|_| !is_endless);
        Self {
            number: told.map_or(number, |told| told.number),
            time: Stamp::new(intent.unix_s, told.map_or(0, |told| told.utc_offset_s)),
            purpose: intent.purpose,
            asked: told.and_then(|told| told.asked),
            requested_ml: intent.requested_ml,
            until_stopped: is_endless,
            delivered_ml: delivered.middle_ml,
            delivered_range_ml: Some(delivered.range_ml())
                .filter(|(least_ml, most_ml)| !is_exact || is_endless && least_ml < most_ml),
            expanded_uncertainty_ml: uncertainty_ml.map(|ml| if is_exact { ml } else { ml + half_ml }),
            carry_ml: 0.0,
            end,
            cause: None,
            rack: told.and_then(|told| told.rack),
            order: told.and_then(|told| told.order),
            resumed: if intent.terms.by_weight { earlier_ml != 0.0 } else { intent.whole.is_some() },
            counted_later: false,
            tube,
            calibration: told.and_then(|told| told.calibration),
            fluid: told.and_then(|told| told.fluid),
            steps: is_exact.then_some(made_least * intent.steps.signum()),
            motion_s: None,
        }
    }

    /// Returns the place of this entry in the log. A later entry of one dose takes the place of the earlier one.
    pub(crate) fn place(&self) -> LogPlace {
        LogPlace { number: self.number, counted_later: self.counted_later }
    }

    /// Returns a dose of 1 mL at a time, for tests.
    #[cfg(test)]
    pub(crate) fn example(number: u64, unix_s: u64) -> Self {
        Self {
            number,
            time: Stamp::new(unix_s, 0),
            purpose: Purpose::Dose,
            asked: None,
            requested_ml: 1.0,
            until_stopped: false,
            delivered_ml: 1.0,
            delivered_range_ml: None,
            expanded_uncertainty_ml: Some(0.1),
            carry_ml: 0.0,
            end: LogEnd::Done,
            cause: None,
            rack: None,
            order: None,
            resumed: false,
            counted_later: false,
            tube: 1,
            calibration: None,
            fluid: None,
            steps: Some(1000),
            motion_s: Some(1.0),
        }
    }
}
