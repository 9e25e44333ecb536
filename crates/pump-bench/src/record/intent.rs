//! The intent of a motion: its plan, as the journal announces it before the rotor turns.

use pump_ctl::plan::{FlowMotion, Phase, Plan, Turned};
use pump_model::Pump;
use serde::{Deserialize, Serialize};

use super::{Account, DeliveredRange, DoseTerms, MotorWay, Purpose, Told, Whole};
use crate::displacement::Correction;

/// Plan of a motion, as the journal announces it before the rotor turns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Intent {
    /// Time of the entry by the system clock, in seconds since 1970. The safety limit of a day follows it.
    pub(crate) unix_s: u64,
    /// Reason for which the pump turns.
    pub(crate) purpose: Purpose,
    /// Volume asked for, in mL. Negative in reverse.
    pub(crate) requested_ml: f64,
    /// Carry from earlier doses, in mL.
    pub(crate) carry_in_ml: f64,
    /// Half width of the range around the carry on record before the dose that holds the true carry, in mL.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) carry_in_half_width_ml: f64,
    /// Volume of the planned steps, in mL.
    pub(crate) planned_ml: f64,
    /// Carry to the next dose once every step is made, in mL.
    pub(crate) carry_out_ml: f64,
    /// Angle of the rotor at the start, in rad.
    pub(crate) start_angle_rad: f64,
    /// Half width of the range around the start angle that holds the true angle, in rad.
    pub(crate) half_width_rad: f64,
    /// Turn of the earlier doses that the motion was planned with. `None` if it was planned alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) turned: Option<Turned>,
    /// Number of motor steps. Negative in reverse.
    pub steps: i64,
    /// Angle of a step, in rad.
    pub(crate) step_rad: f64,
    /// Volume of a revolution by the pump file of that day, in mL, without the correction. `None` in an entry of an
    /// early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) revolution_ml: Option<f64>,
    /// True if the motor's direction was turned round by the pump file of that day.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) inverted: bool,
    /// Way in which the motor is turned. `None` for a simulated motor, and in an entry of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) motor_way: Option<MotorWay>,
    /// Duration of the motion, in s.
    pub(crate) motion_s: f64,
    /// Cruise speed, in rad/s, positive. 0 in an entry of an early version, which does not tell it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) speed_rad_s: f64,
    /// Volume to suck back after the dose, in mL. `None` without a retraction.
    #[serde(default)]
    pub(crate) retract_ml: Option<f64>,
    /// Whole dose of which this motion makes the rest. `None` if the motion makes the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) whole: Option<Whole>,
    /// Terms of the dose besides its volume.
    #[serde(default, skip_serializing_if = "DoseTerms::is_none")]
    pub(crate) terms: DoseTerms,
    /// Correction of the displacement that the plan was made with.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub(crate) correction: Correction,
    /// Part that only the log needs. `None` in an entry of an early version, and for a turn to a mark.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) told: Option<Told>,
}

/// Relative difference between the volumes of two revolutions that is rounding.
const SAME_VOLUME: f64 = 1e-9;

/// Returns true for zero, which an entry leaves out.
pub(super) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Intent {
    /// Returns the intent with the volumes of its own day for `pump`, whose file may give others by now: the pump file
    /// told what the steps deliver when they were made.
    #[must_use]
    pub(super) fn of_volumes(self, pump: &Pump) -> Self {
        let Some((then_ml, now_ml)) = self.other_volumes(pump) else { return self };
        let correction = Correction { factor: self.correction.factor * then_ml / now_ml, ..self.correction };
        Self { revolution_ml: Some(now_ml), correction, ..self }
    }

    /// Returns the volumes of a revolution of that day and of `pump`, in mL, without corrections. `None` if they are
    /// the same, or that of the day is not on record.
    pub(super) fn other_volumes(&self, pump: &Pump) -> Option<(f64, f64)> {
        let now_ml = pump.revolution_ml();
        let differs = |then_ml: &f64| (then_ml / now_ml - 1.0).abs() > SAME_VOLUME;
        self.revolution_ml.filter(differs).map(|then_ml| (then_ml, now_ml))
    }

    /// Returns the angle of the rotor at the start, with its half width.
    pub(crate) fn start(&self) -> Phase {
        Phase::within(self.start_angle_rad, self.half_width_rad)
    }

    /// Returns the angle of a step by the motor of that day, in rad, negative if its direction was turned round.
    pub(super) fn way_rad(&self) -> f64 {
        if self.inverted { -self.step_rad } else { self.step_rad }
    }

    /// Returns the angle after `made` net steps, in rad, unwrapped. It equals the plan's.
    pub(crate) fn angle_after(&self, made: i64) -> f64 {
        self.start_angle_rad + self.turn_rad(made)
    }

    /// Returns the volume asked for in all, in mL: that of the whole dose if this is the rest of one.
    pub(crate) fn whole_requested_ml(&self) -> f64 {
        self.whole.map_or(self.requested_ml, |whole| whole.requested_ml)
    }

    /// Returns the volume that the first `made` steps are booked with, in mL, negative in reverse.
    ///
    /// From a known angle it is their volume. Otherwise it is their part of the middle of all sums with the
    /// earlier doses.
    pub(crate) fn delivered_ml(&self, pump: &Pump, made: i64) -> f64 {
        self.booked_ml(pump, made, made)
    }

    /// Returns the volume that `least` to `most` net steps are booked with, in mL, negative in reverse.
    pub(crate) fn booked_ml(&self, pump: &Pump, least: i64, most: i64) -> f64 {
        let of = |turned| self.account(turned).middle_ml(pump);
        of(self.turned_after(least, most)) - of(self.turned_before())
    }

    /// Returns the volume of `least` to `most` net steps, over the angles from which they may have been made.
    pub(crate) fn delivered(&self, pump: &Pump, least: i64, most: i64) -> DeliveredRange {
        let alone = self.turned_by(Turned::at(self.start()), least, most);
        let (least_ml, most_ml) = self.account(alone).range_ml(pump);
        DeliveredRange { least_ml, middle_ml: self.booked_ml(pump, least, most), most_ml }
    }

    /// Returns the turn of the earlier doses.
    fn turned_before(&self) -> Turned {
        self.turned.unwrap_or(Turned::at(self.start()))
    }

    /// Returns the turn of the earlier doses and of `least` to `most` net steps.
    pub(super) fn turned_after(&self, least: i64, most: i64) -> Turned {
        self.turned_by(self.turned_before(), least, most)
    }

    /// Returns a turn after `least` to `most` net steps more.
    pub(super) fn turned_by(&self, turned: Turned, least: i64, most: i64) -> Turned {
        let [a, b] = [least, most].map(|made| self.turn_rad(made));
        turned.by(a.min(b), a.max(b))
    }

    /// Returns the account of a turn, with the correction of this motion.
    pub(super) fn account(&self, turned: Turned) -> Account {
        Account { turned, correction: self.correction }
    }

    /// Returns the angle of `made` net steps, in rad, negative in reverse.
    pub(super) fn turn_rad(&self, made: i64) -> f64 {
        let direction = if self.steps < 0 { -1.0 } else { 1.0 };
        direction * (made as f64 * self.step_rad)
    }

    /// Widens the start angle to `half_width_rad`: the rotor was disturbed since the motion was planned. The
    /// motion counts alone from there on.
    pub(crate) fn widen(&mut self, half_width_rad: f64, pump: &Pump) {
        self.half_width_rad = half_width_rad;
        self.turned = None;
        let (start, correction) = (self.start(), self.correction);
        if let Some(whole) = &mut self.whole {
            let (least_ml, most_ml) = Account { turned: whole.turned, correction }.range_ml(pump);
            whole.least_ml += least_ml;
            whole.most_ml += most_ml;
            whole.turned = Turned::at(start);
        }
    }

    /// Describes a flow over time as an intent, whose steps give `planned_ml`. It has no terms yet.
    pub(crate) fn of_flow(
        flow: &FlowMotion<'_>,
        planned_ml: f64,
        correction: Correction,
        carry_out_ml: f64,
        unix_s: u64,
    ) -> Self {
        let start = flow.start();
        let turn_rad = flow.steps().unsigned_abs() as f64 * flow.step_rad();
        Self {
            unix_s,
            purpose: Purpose::Run,
            requested_ml: flow.volume_ml(),
            carry_in_ml: 0.0,
            carry_in_half_width_ml: 0.0,
            planned_ml,
            carry_out_ml,
            start_angle_rad: start.angle_rad(),
            half_width_rad: start.half_width_rad(),
            turned: None,
            steps: flow.steps(),
            step_rad: flow.step_rad(),
            revolution_ml: None,
            inverted: false,
            motor_way: None,
            motion_s: flow.duration_s(),
            speed_rad_s: turn_rad / flow.duration_s(),
            retract_ml: None,
            whole: None,
            terms: DoseTerms::default(),
            correction,
            told: None,
        }
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
            requested_ml: plan.requested_ml(),
            carry_in_ml: plan.carry_in_ml(),
            carry_in_half_width_ml: 0.0,
            planned_ml: plan.planned_ml(),
            carry_out_ml,
            start_angle_rad: plan.start().angle_rad(),
            half_width_rad: plan.start().half_width_rad(),
            turned: (plan.turned() != Turned::at(plan.start())).then_some(plan.turned()),
            steps: plan.steps(),
            step_rad: plan.step_rad(),
            revolution_ml: None,
            inverted: false,
            motor_way: None,
            motion_s: plan.profile().duration_s(),
            speed_rad_s: plan.profile().cruise_rad_s().abs(),
            retract_ml: None,
            whole: None,
            terms: DoseTerms::default(),
            correction,
            told: None,
        }
    }
}
