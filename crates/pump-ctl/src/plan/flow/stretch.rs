//! The motor steps between two rows of a flow.

use libm::{floor, sqrt};
use pump_model::FlowCurve;

use super::row::FlowRow;
use crate::plan::steps::Step;
use crate::step::Direction;

/// Part of a step by which an angle may be off by rounding. A flow that ends on a step has that step.
const ON_A_STEP: f64 = 1e-6;

/// The motor steps between two rows of a flow over time, computed one by one.
#[derive(Debug, Clone)]
pub struct FlowStretch<'p> {
    pub(super) curve: &'p FlowCurve,
    pub(super) direction: Direction,
    /// Volume of the curve at the start angle of the plan, mL.
    pub(super) start_ml: f64,
    pub(super) start_rad: f64,
    pub(super) step_rad: f64,
    pub(super) from: FlowRow,
    pub(super) to: FlowRow,
    /// Volume before this stretch, mL, without its sign.
    pub(super) before_ml: f64,
    /// Number of the last step made.
    pub(super) made: u64,
    /// Number of the last step of the stretch.
    pub(super) ends: u64,
}

impl FlowStretch<'_> {
    /// Returns the row at the start.
    pub fn from(&self) -> FlowRow {
        self.from
    }

    /// Returns the row at the end.
    pub fn to(&self) -> FlowRow {
        self.to
    }

    /// Returns the volume of the stretch, mL, without its sign: a trapezoid.
    pub(super) fn volume_ml(&self) -> f64 {
        0.5 * (self.from.flow_ml_s.abs() + self.to.flow_ml_s.abs()) * (self.to.time_s - self.from.time_s)
    }

    /// Returns the number of the last step that the flow reaches by the end of the stretch.
    pub(super) fn last_step(&self) -> f64 {
        let sign = f64::from(self.direction.sign());
        let end_rad = self.curve.angle_rad(self.start_ml + sign * (self.before_ml + self.volume_ml()));
        floor(sign * (end_rad - self.start_rad) / self.step_rad + ON_A_STEP)
    }

    /// Returns the speed at the start, rad/s, not negative.
    pub(super) fn first_speed_rad_s(&self) -> f64 {
        let sign = f64::from(self.direction.sign());
        let angle_rad = self.curve.angle_rad(self.start_ml + sign * self.before_ml);
        self.speed_rad_s(self.from.time_s, angle_rad)
    }

    /// Returns the speed at a time of the stretch where the rollers stand at `angle_rad`, rad/s, not negative.
    pub(super) fn speed_rad_s(&self, time_s: f64, angle_rad: f64) -> f64 {
        let part = (time_s - self.from.time_s) / (self.to.time_s - self.from.time_s);
        let flow_ml_s = self.from.flow_ml_s + part * (self.to.flow_ml_s - self.from.flow_ml_s);
        (flow_ml_s / self.curve.flow_ml_rad(angle_rad)).abs()
    }

    /// Returns the time at which the volume of the stretch has reached `volume_ml`, s: the root of the parabola
    /// q t + s t²/2 in the form that does not cancel.
    fn time_of(&self, volume_ml: f64) -> f64 {
        let (first, last) = (self.from.flow_ml_s.abs(), self.to.flow_ml_s.abs());
        let length_s = self.to.time_s - self.from.time_s;
        let slope = (last - first) / length_s;
        let flow_then = sqrt((first * first + 2.0 * slope * volume_ml).max(0.0));
        let sum = first + flow_then;
        let after_s = if sum > 0.0 { 2.0 * volume_ml / sum } else { 0.0 };
        self.from.time_s + after_s.max(0.0).min(length_s)
    }

    /// Returns the angle at which the volume since the start of the plan is `volume_ml`, rad.
    pub(super) fn angle_at_volume(&self, volume_ml: f64) -> f64 {
        self.curve.angle_rad(self.start_ml + f64::from(self.direction.sign()) * volume_ml)
    }

    /// Returns the time at which the rollers reach an angle of the stretch, s.
    pub(super) fn time_at_angle(&self, angle_rad: f64) -> f64 {
        let sign = f64::from(self.direction.sign());
        let volume_ml = sign * (self.curve.volume_ml(angle_rad) - self.start_ml) - self.before_ml;
        self.time_of(volume_ml.max(0.0))
    }

    /// Returns step `number` of the plan, which is one of this stretch.
    pub(super) fn step(&self, number: u64) -> Step {
        let sign = f64::from(self.direction.sign());
        let angle_rad = self.start_rad + sign * (number as f64 * self.step_rad);
        Step { number, time_s: self.time_at_angle(angle_rad), direction: self.direction, angle_rad }
    }
}

impl Iterator for FlowStretch<'_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        if self.made >= self.ends {
            return None;
        }
        self.made += 1;
        Some(self.step(self.made))
    }
}
