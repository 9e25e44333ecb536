//! The last dose: how far the rollers turned for what is in the vessel.

mod dose_by_weight;
mod dosed_fluid;

use pump_ctl::plan::Phase;
use serde::{Deserialize, Serialize};

use super::{Intent, Purpose, Unfinished};
use crate::displacement::Correction;
pub use dose_by_weight::DoseByWeight;
pub use dosed_fluid::DosedFluid;

/// Turn of the rollers for the last dose, from the end of the dose before. A scale can weigh it.
///
/// The parts of a dose that was stopped and resumed are one turn. So are the retraction after one dose and the next
/// dose, which repays it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LastDose {
    /// Time of the dose by the system clock, in seconds since 1970.
    pub(crate) unix_s: u64,
    /// Cruise speed of the pump head, in rad/s, positive.
    pub(crate) speed_rad_s: f64,
    /// Angle of the rotor at the start, in rad.
    pub start_angle_rad: f64,
    /// Half width of the range around the start angle that holds the true angle, in rad.
    pub(crate) half_width_rad: f64,
    /// Angle turned, in rad. Negative in reverse.
    pub turned_rad: f64,
    /// Half width of the range around the angle turned that holds the true turn, in rad.
    pub(crate) turned_half_width_rad: f64,
    /// Angle turned after the dose by its retraction, in rad.
    #[serde(default)]
    pub(crate) retracted_rad: f64,
    /// Half width of the range around the retraction's angle that holds the true one, in rad.
    #[serde(default)]
    pub(crate) retracted_half_width_rad: f64,
    /// Fluid of the dose. `None` in a record of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluid: Option<DosedFluid>,
    /// Correction of the displacement that the dose was planned with.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub(crate) correction: Correction,
    /// Weighing of the dose. `None` if no balance ended it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_weight: Option<DoseByWeight>,
}

impl LastDose {
    /// Returns the angle at the start with its half width.
    pub(crate) fn start(&self) -> Phase {
        Phase::within(self.start_angle_rad, self.half_width_rad)
    }

    /// Returns the last dose after `made_least` to `made_most` net steps of `intent`. `before` is the last dose
    /// until then, and `None` if the vessel holds something else too.
    pub(super) fn after(
        before: Option<Self>,
        intent: &Intent,
        made_least: i64,
        made_most: i64,
    ) -> Option<Self> {
        let [least, most] = [made_least, made_most].map(|made| intent.turn_rad(made));
        let (turn_rad, half_width_rad) = (0.5 * (least + most), 0.5 * (most - least).abs());
        match intent.purpose {
            // A rotor that is set to a mark delivers what nobody weighs.
            Purpose::Jog | Purpose::Calibrate | Purpose::Prime | Purpose::Purge | Purpose::Run => None,
            Purpose::Retract => before.map(|dose| Self {
                retracted_rad: dose.retracted_rad + turn_rad,
                retracted_half_width_rad: dose.retracted_half_width_rad + half_width_rad,
                ..dose
            }),
            Purpose::Dose => {
                let fresh = Self {
                    unix_s: intent.unix_s,
                    speed_rad_s: intent.speed_rad_s,
                    start_angle_rad: intent.start_angle_rad,
                    half_width_rad: intent.half_width_rad,
                    turned_rad: 0.0,
                    turned_half_width_rad: 0.0,
                    retracted_rad: 0.0,
                    retracted_half_width_rad: 0.0,
                    fluid: intent.told.and_then(|told| told.fluid),
                    correction: intent.correction,
                    by_weight: None,
                };
                let begun = match before {
                    Some(first) if intent.whole.is_some() => first,
                    None if intent.whole.is_some() => return None,
                    Some(repaid) => Self {
                        start_angle_rad: intent.start_angle_rad - repaid.retracted_rad,
                        half_width_rad: intent.half_width_rad + repaid.retracted_half_width_rad,
                        turned_rad: repaid.retracted_rad,
                        turned_half_width_rad: repaid.retracted_half_width_rad,
                        ..fresh
                    },
                    None => fresh,
                };
                Some(Self {
                    turned_rad: begun.turned_rad + turn_rad,
                    turned_half_width_rad: begun.turned_half_width_rad + half_width_rad,
                    ..begun
                })
            }
        }
    }

    /// Returns the last dose once its device tells that it made `made` steps of the last motion, `part`.
    pub(super) fn recounted(self, part: &Unfinished, made: i64) -> Self {
        let [least, most] = [part.made_least, part.made_most].map(|made| part.intent.turn_rad(made));
        let more_rad = part.intent.turn_rad(made) - 0.5 * (least + most);
        let surer_rad = 0.5 * (most - least).abs();
        let surer = |half_width_rad: f64| (half_width_rad - surer_rad).max(0.0);
        if part.intent.purpose == Purpose::Retract {
            let retracted_half_width_rad = surer(self.retracted_half_width_rad);
            return Self { retracted_rad: self.retracted_rad + more_rad, retracted_half_width_rad, ..self };
        }
        let turned_half_width_rad = surer(self.turned_half_width_rad);
        Self { turned_rad: self.turned_rad + more_rad, turned_half_width_rad, ..self }
    }
}
