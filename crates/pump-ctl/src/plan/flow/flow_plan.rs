//! The plan of a flow over time: rows in, stretches of motor steps out.

use pump_model::units::{degrees, rpm};
use pump_model::{FlowCurve, Pump};

use super::error::FlowError;
use super::row::{FlowKnot, FlowRow};
use super::stretch::FlowStretch;
use crate::plan::limits::Motor;
use crate::plan::target::MAX_STEPS;
use crate::plan::words::Phase;
use crate::step::Direction;

/// The plan of a flow over time at the rollers of the outlet. It takes rows one by one and holds the last one alone.
///
/// Between two rows the flow is linear in time, so the volume is a parabola. The angle is the inverse of the curve's
/// volume, V(theta) = V(theta_0) + integral of the flow. A motor step is made when that angle has gone a whole step
/// further, so the rotor is behind the flow by less than a step.
///
/// A row is refused at the first instant that the motor cannot meet: its speed, flow over flow per radian, or its
/// acceleration from step to step. A step of the flow, at the start and the end too, asks for a jump of the speed by
/// w. The rotor does it within w over its acceleration a, half of it before the step, and leaves the flow's angle by
/// w²/(8 a). That must be a motor step at most. Pressures and torque are not predicted.
///
/// ```
/// use pump_ctl::plan::{FlowPlan, FlowRow, Motor, Phase};
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let mut plan = FlowPlan::new(&pump, motor, Phase::known(0.3))?;
/// // A triangle of 10 s up to 4 mL/s and down to rest: 20 mL.
/// for row in [FlowRow::new(0.0, 0.0), FlowRow::new(5.0, 4.0), FlowRow::new(10.0, 0.0)] {
///     for step in plan.take(row)?.into_iter().flatten() {
///         assert!(step.time_s <= 10.0);
///     }
/// }
/// assert!(plan.end()?.peak_rad_s < motor.max_speed_rad_s);
/// assert!((plan.volume_ml() - 20.0).abs() < 1e-12);
/// # Ok::<(), pump_ctl::plan::FlowError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FlowPlan<'p> {
    curve: &'p FlowCurve,
    motor: Motor,
    /// Volume of the curve at the start angle, mL.
    start_ml: f64,
    start_rad: f64,
    /// Last row. `None` before the first.
    last: Option<FlowRow>,
    rows: u64,
    direction: Option<Direction>,
    /// Volume since the start, mL, without its sign.
    volume_ml: f64,
    made: u64,
    pace: FlowPace,
    /// Time of the last step made, s.
    stepped_s: f64,
}

/// Speeds of a flow over time, for the stop and the pressures of its motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct FlowPace {
    /// Fastest speed of the pump head, rad/s.
    pub peak_rad_s: f64,
    /// Longest time between two motor steps, or from the start to the first, s.
    pub longest_interval_s: f64,
}

impl<'p> FlowPlan<'p> {
    /// Begins a plan on `pump` with the rollers at `start`.
    ///
    /// # Errors
    ///
    /// [`FlowError::Reverses`] for a head whose flow reverses, [`FlowError::UnsureAngle`] if the angle is not known to
    /// a motor step, and [`FlowError::Plan`] if the motor or the angle is out of its range.
    pub fn new(pump: &'p Pump, motor: Motor, start: Phase) -> Result<Self, FlowError> {
        motor.validate()?;
        start.validate()?;
        let curve = pump.outlet_curve();
        if curve.reverses() {
            return Err(FlowError::Reverses { least_ml_rad: curve.flow_range_ml_rad().0 });
        }
        if start.half_width_rad() > motor.step_rad() {
            return Err(FlowError::UnsureAngle {
                half_width_deg: degrees(start.half_width_rad()),
                step_deg: degrees(motor.step_rad()),
            });
        }
        Ok(Self {
            curve,
            motor,
            start_ml: curve.volume_ml(start.angle_rad()),
            start_rad: start.angle_rad(),
            last: None,
            rows: 0,
            direction: None,
            volume_ml: 0.0,
            made: 0,
            pace: FlowPace::default(),
            stepped_s: 0.0,
        })
    }

    /// Takes the next row. Returns the stretch from the row before, or `None` for the first row and for a step of the
    /// flow.
    ///
    /// # Errors
    ///
    /// [`FlowError`] if the row is no row, or the motor cannot meet the flow up to it.
    pub fn take(&mut self, row: FlowRow) -> Result<Option<FlowStretch<'p>>, FlowError> {
        let number = self.rows + 1;
        let FlowRow { time_s, flow_ml_s } = row;
        if !(time_s >= 0.0 && time_s.is_finite()) || (self.rows == 0 && time_s > 0.0) {
            return Err(FlowError::Time { row: number, time_s });
        }
        if !flow_ml_s.is_finite() {
            return Err(FlowError::Flow { row: number, flow_ml_s });
        }
        let turns = Direction::of(if flow_ml_s < 0.0 { -1 } else { 1 });
        let direction = self.direction.unwrap_or(turns);
        if flow_ml_s != 0.0 && direction != turns {
            return Err(FlowError::TurnsBack { row: number, flow_ml_s });
        }
        let before = self.last.unwrap_or(FlowRow::new(0.0, 0.0));
        if time_s < before.time_s {
            return Err(FlowError::TimeGoesBack { row: number, time_s, before_s: before.time_s });
        }
        let is_stretch = time_s > before.time_s;
        let mut stretch = FlowStretch {
            curve: self.curve,
            direction,
            start_ml: self.start_ml,
            start_rad: self.start_rad,
            step_rad: self.motor.step_rad(),
            from: before,
            to: row,
            before_ml: self.volume_ml,
            made: self.made,
            ends: self.made,
        };
        let ends = stretch.last_step();
        if !(stretch.volume_ml().is_finite() && ends <= MAX_STEPS) {
            return Err(FlowError::TooManySteps { row: number, time_s });
        }
        stretch.ends = self.made.max(ends as u64);
        let (mut pace, mut stepped_s) = (self.pace, self.stepped_s);
        if is_stretch {
            self.check(number, &stretch, &mut pace, &mut stepped_s)?;
        } else {
            self.check_step(number, before.flow_ml_s, row)?;
        }
        self.rows = number;
        self.last = Some(row);
        if flow_ml_s != 0.0 {
            self.direction = Some(direction);
        }
        self.volume_ml += stretch.volume_ml();
        self.made = stretch.ends;
        (self.pace, self.stepped_s) = (pace, stepped_s);
        Ok(is_stretch.then_some(stretch))
    }

    /// Ends the plan after its last row, from whose flow the rotor stops. Returns the speeds of the whole.
    ///
    /// # Errors
    ///
    /// [`FlowError::Nothing`] if nothing flows, and [`FlowError::Step`] if the last flow is too large to stop from.
    pub fn end(&self) -> Result<FlowPace, FlowError> {
        match self.last {
            Some(last) if self.made > 0 => {
                self.check_step(self.rows, last.flow_ml_s, FlowRow { flow_ml_s: 0.0, ..last })?;
                Ok(self.pace)
            }
            _ => Err(FlowError::Nothing { rows: self.rows }),
        }
    }

    /// Returns the place that the last row has in the plan. `None` before the first row.
    pub fn knot(&self) -> Option<FlowKnot> {
        Some(FlowKnot { row: self.last?, volume_ml: self.volume_ml, steps: self.made })
    }

    /// Returns the volume of the rows so far at the rollers, mL, negative in reverse.
    pub fn volume_ml(&self) -> f64 {
        self.sign() * self.volume_ml
    }

    /// Returns the motor steps of the rows so far, negative in reverse.
    pub fn steps(&self) -> i64 {
        let made = i64::try_from(self.made).unwrap_or(i64::MAX);
        if self.sign() < 0.0 { -made } else { made }
    }

    fn sign(&self) -> f64 {
        f64::from(self.direction.unwrap_or(Direction::Forward).sign())
    }

    /// Refuses a stretch at the first step that the motor cannot make in time.
    fn check(
        &self,
        row: u64,
        stretch: &FlowStretch<'_>,
        pace: &mut FlowPace,
        stepped_s: &mut f64,
    ) -> Result<(), FlowError> {
        let limit_rad_s = self.motor.max_speed_rad_s;
        let limit_rad_s2 = self.motor.max_acceleration_rad_s2;
        let mut check = |time_s: f64, speed_rad_s: f64| {
            pace.peak_rad_s = pace.peak_rad_s.max(speed_rad_s);
            if speed_rad_s <= limit_rad_s {
                return Ok(());
            }
            Err(FlowError::TooFast { row, time_s, needed_rpm: rpm(speed_rad_s), limit_rpm: rpm(limit_rad_s) })
        };
        let (mut time_s, mut speed_rad_s) = (stretch.from.time_s, stretch.first_speed_rad_s());
        check(time_s, speed_rad_s)?;
        let mut longest_s = pace.longest_interval_s;
        for step in stretch.clone() {
            longest_s = longest_s.max(step.time_s - *stepped_s);
            *stepped_s = step.time_s;
            let next_rad_s = stretch.speed_rad_s(step.time_s, step.angle_rad);
            check(step.time_s, next_rad_s)?;
            let interval_s = step.time_s - time_s;
            let needed_rad_s2 = (next_rad_s - speed_rad_s).abs() / interval_s;
            if interval_s > 0.0 && needed_rad_s2 > limit_rad_s2 {
                return Err(FlowError::TooSteep { row, time_s, needed_rad_s2, limit_rad_s2 });
            }
            (time_s, speed_rad_s) = (step.time_s, next_rad_s);
        }
        pace.longest_interval_s = longest_s;
        Ok(())
    }

    /// Refuses a step of the flow that would have the rotor leave it by more than a motor step.
    fn check_step(&self, row: u64, from_ml_s: f64, to: FlowRow) -> Result<(), FlowError> {
        let angle_rad = self.curve.angle_rad(self.start_ml + self.volume_ml());
        let jump_rad_s = ((to.flow_ml_s - from_ml_s) / self.curve.flow_ml_rad(angle_rad)).abs();
        let limit_rad_s2 = self.motor.max_acceleration_rad_s2;
        let off_steps = jump_rad_s * jump_rad_s / (8.0 * limit_rad_s2) / self.motor.step_rad();
        if off_steps <= 1.0 {
            return Ok(());
        }
        Err(FlowError::Step {
            row,
            time_s: to.time_s,
            from_ml_s,
            to_ml_s: to.flow_ml_s,
            off_steps,
            least_s: jump_rad_s / limit_rad_s2,
        })
    }
}
