//! The motion of a whole flow over time: every step by its number.

use pump_model::Pump;

use super::flow_plan::FlowPace;
use super::row::FlowKnot;
use super::stretch::FlowStretch;
use crate::plan::limits::Motor;
use crate::plan::steps::Step;
use crate::plan::words::Phase;
use crate::step::Direction;

/// The motion of a whole flow over time, from the knots that its [`FlowPlan`](super::FlowPlan) gave.
///
/// A drive asks it for the time of any step. The knots stay with the caller, so that the motion needs no memory of its
/// own.
///
/// ```
/// use pump_ctl::plan::{FlowMotion, FlowPlan, FlowRow, Motor, Phase};
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let mut plan = FlowPlan::new(&pump, motor, Phase::known(0.3))?;
/// let mut knots = Vec::new();
/// for row in [FlowRow::new(0.0, 0.0), FlowRow::new(5.0, 4.0), FlowRow::new(10.0, 0.0)] {
///     plan.take(row)?;
///     knots.extend(plan.knot());
/// }
/// let motion = FlowMotion::new(&pump, motor, Phase::known(0.3), &knots, plan.end()?);
/// assert_eq!(motion.steps(), plan.steps());
/// // Half of the volume has passed at the top of the triangle.
/// let half = motion.steps().unsigned_abs() / 2;
/// assert!((motion.time_of(half) - 5.0).abs() < 0.3);
/// # Ok::<(), pump_ctl::plan::FlowError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct FlowMotion<'a> {
    pub(super) pump: &'a Pump,
    pub(super) motor: Motor,
    pub(super) start: Phase,
    pub(super) knots: &'a [FlowKnot],
    pub(super) pace: FlowPace,
    pub(super) direction: Direction,
    /// Volume of the curve at the start angle, mL.
    start_ml: f64,
}

impl<'a> FlowMotion<'a> {
    /// Makes the motion of `knots`, in order, from a plan of the same pump, motor and start angle. `pace` is that of
    /// the plan's end.
    pub fn new(pump: &'a Pump, motor: Motor, start: Phase, knots: &'a [FlowKnot], pace: FlowPace) -> Self {
        let is_back = knots.iter().any(|knot| knot.row.flow_ml_s < 0.0);
        let direction = if is_back { Direction::Reverse } else { Direction::Forward };
        let start_ml = pump.outlet_curve().volume_ml(start.angle_rad());
        Self { pump, motor, start, knots, pace, direction, start_ml }
    }

    /// Returns the angle of the rollers at the start.
    pub fn start(&self) -> Phase {
        self.start
    }

    /// Returns the direction in which the rotor turns.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Returns the number of motor steps, negative in reverse.
    pub fn steps(&self) -> i64 {
        let steps = i64::try_from(self.all()).unwrap_or(i64::MAX);
        i64::from(self.direction.sign()) * steps
    }

    /// Returns the angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        self.motor.step_rad()
    }

    /// Returns the speeds of the motion.
    pub fn pace(&self) -> FlowPace {
        self.pace
    }

    /// Returns the largest acceleration of the motor, rad/s², with which it stops.
    pub fn acceleration_rad_s2(&self) -> f64 {
        self.motor.max_acceleration_rad_s2
    }

    /// Returns the time of the last row, s.
    pub fn duration_s(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.row.time_s)
    }

    /// Returns the volume of the rows at the rollers, mL, negative in reverse.
    pub fn volume_ml(&self) -> f64 {
        f64::from(self.direction.sign()) * self.knots.last().map_or(0.0, |knot| knot.volume_ml)
    }

    /// Returns the angle after `count` steps, rad, counted on from the start angle.
    pub fn angle_after(&self, count: u64) -> f64 {
        self.start.angle_rad + f64::from(self.direction.sign()) * (count as f64 * self.step_rad())
    }

    /// Returns the time of step `number`, s since the start. Step 0 is the start.
    pub fn time_of(&self, number: u64) -> f64 {
        self.stretch_of(number).map_or(0.0, |stretch| stretch.step(number).time_s)
    }

    /// Returns the speed of the pump head at the time of step `count`, rad/s, not negative. It is 0 before the first
    /// step and once the last is made.
    pub fn speed_after(&self, count: u64) -> f64 {
        if count >= self.all() {
            return 0.0;
        }
        let Some(stretch) = self.stretch_of(count) else { return 0.0 };
        let step = stretch.step(count);
        stretch.speed_rad_s(step.time_s, step.angle_rad)
    }

    /// Returns every step with its time.
    pub fn each_step(&self) -> impl Iterator<Item = Step> + use<'a> {
        let motion = *self;
        (1..motion.knots.len()).filter_map(move |n| motion.stretch(n)).flatten()
    }

    /// Returns the number of motor steps, without its sign.
    pub(super) fn all(&self) -> u64 {
        self.knots.last().map_or(0, |knot| knot.steps)
    }

    /// Returns the stretch that ends with knot `n`. `None` for a step of the flow.
    pub(super) fn stretch(&self, n: usize) -> Option<FlowStretch<'a>> {
        let before = self.knots.get(n.checked_sub(1)?)?;
        let after = self.knots.get(n)?;
        (after.row.time_s > before.row.time_s).then(|| self.between(before, after))
    }

    fn between(&self, before: &FlowKnot, after: &FlowKnot) -> FlowStretch<'a> {
        FlowStretch {
            curve: self.pump.outlet_curve(),
            direction: self.direction,
            start_ml: self.start_ml,
            start_rad: self.start.angle_rad,
            step_rad: self.step_rad(),
            from: before.row,
            to: after.row,
            before_ml: before.volume_ml,
            made: before.steps,
            ends: after.steps,
        }
    }

    /// Returns the stretch in which step `number` is made. `None` for step 0 and beyond the last.
    fn stretch_of(&self, number: u64) -> Option<FlowStretch<'a>> {
        let n = self.knot_of(number)?;
        self.stretch(n)
    }

    /// Returns the number of the knot at the end of the stretch in which step `number` is made.
    pub(super) fn knot_of(&self, number: u64) -> Option<usize> {
        (number > 0).then(|| self.knots.partition_point(|knot| knot.steps < number))
    }

    /// Returns the number of the row, from 1, at the end of the stretch of `time_s`.
    pub(super) fn row_number(&self, time_s: f64) -> u64 {
        let n = self.knots.partition_point(|knot| knot.row.time_s < time_s);
        n.min(self.knots.len().saturating_sub(1)) as u64 + 1
    }
}
