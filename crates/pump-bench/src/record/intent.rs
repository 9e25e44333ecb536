//! The intent of a motion: its plan, as the journal announces it before the rotor turns.

use pump_ctl::plan::{Phase, Plan};
use pump_model::Pump;
use serde::{Deserialize, Serialize};

use super::{Purpose, Terms};
use crate::displacement::Correction;

/// Plan of a motion, as the journal announces it before the rotor turns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intent {
    /// Time of the entry by the system clock, in seconds since 1970. Only people read it.
    pub unix_s: u64,
    /// Reason for which the pump turns.
    pub purpose: Purpose,
    /// Volume asked for, in mL. Negative in reverse.
    pub requested_ml: f64,
    /// Carry from earlier doses, in mL.
    pub carry_in_ml: f64,
    /// Volume of the planned steps, in mL.
    pub planned_ml: f64,
    /// Carry to the next dose once every step is made, in mL.
    pub carry_out_ml: f64,
    /// Angle of the rotor at the start, in rad.
    pub start_angle_rad: f64,
    /// Half width of the range around the start angle that holds the true angle, in rad.
    pub half_width_rad: f64,
    /// Number of motor steps. Negative in reverse.
    pub steps: i64,
    /// Angle of a step, in rad.
    pub step_rad: f64,
    /// Duration of the motion, in s.
    pub motion_s: f64,
    /// Volume to suck back after the dose, in mL. `None` without a retraction.
    #[serde(default)]
    pub retract_ml: Option<f64>,
    /// Terms of the dose besides its volume.
    #[serde(default, skip_serializing_if = "Terms::is_none")]
    pub terms: Terms,
    /// Correction of the displacement that the plan was made with.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub correction: Correction,
}

impl Intent {
    /// Returns the angle of the rotor at the start, with its half width.
    pub fn start(&self) -> Phase {
        Phase { angle_rad: self.start_angle_rad, half_width_rad: self.half_width_rad }
    }

    /// Returns the angle after `made` steps, in rad, unwrapped. It equals the plan's.
    pub fn angle_after(&self, made: u64) -> f64 {
        let direction = if self.steps < 0 { -1.0 } else { 1.0 };
        self.start_angle_rad + direction * (made as f64 * self.step_rad)
    }

    /// Returns the volume of the first `made` steps from the middle of the possible start angles, in mL.
    ///
    /// The volume is negative in reverse.
    pub fn delivered_ml(&self, pump: &Pump, made: u64) -> f64 {
        self.correction.volume_ml(pump, self.start_angle_rad, self.angle_after(made))
    }

    /// Returns the smallest and largest volume of the first `made` steps over all possible start angles, in
    /// mL.
    pub(super) fn range_ml(&self, pump: &Pump, made: u64) -> (f64, f64) {
        if self.half_width_rad == 0.0 {
            let volume_ml = self.delivered_ml(pump, made);
            return (volume_ml, volume_ml);
        }
        let direction = if self.steps < 0 { -1.0 } else { 1.0 };
        self.correction.range_ml(pump, self.start(), direction * (made as f64 * self.step_rad))
    }

    /// Describes `plan` as an intent, without a retraction and without terms.
    pub(crate) fn of(
        plan: &Plan,
        correction: Correction,
        purpose: Purpose,
        carry_out_ml: f64,
        unix_s: u64,
    ) -> Self {
        Self {
            unix_s,
            purpose,
            requested_ml: plan.requested_ml,
            carry_in_ml: plan.carry_in_ml,
            planned_ml: plan.planned_ml,
            carry_out_ml,
            start_angle_rad: plan.start.angle_rad,
            half_width_rad: plan.start.half_width_rad,
            steps: plan.steps,
            step_rad: plan.step_rad,
            motion_s: plan.profile.duration_s(),
            retract_ml: None,
            terms: Terms::default(),
            correction,
        }
    }
}
