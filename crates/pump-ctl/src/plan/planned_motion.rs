//! A motion for a drive: a dose, or a flow over time.

use core::iter::FusedIterator;

use pump_model::Pump;

use super::Plan;
use super::flow::{FlowMotion, FlowSegments};
use super::segments::Segments;
use super::words::Phase;
use crate::step::{Direction, Segment, TickRate};

/// A motion for a drive: a dose with a speed over the angle, or a flow over time.
#[derive(Debug, Clone, Copy)]
pub enum PlannedMotion<'a> {
    /// Dose or turn.
    Dose(&'a Plan),
    /// Flow over time.
    Flow(&'a FlowMotion<'a>),
}

/// The segments of a motion in order, computed one by one.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one at a time, and no allocator")]
pub enum MotionSegments<'a> {
    /// Segments of a dose.
    Dose(Segments),
    /// Segments of a flow over time.
    Flow(FlowSegments<'a>),
}

impl<'a> From<&'a Plan> for PlannedMotion<'a> {
    fn from(plan: &'a Plan) -> Self {
        Self::Dose(plan)
    }
}

impl<'a> From<&'a FlowMotion<'a>> for PlannedMotion<'a> {
    fn from(flow: &'a FlowMotion<'a>) -> Self {
        Self::Flow(flow)
    }
}

impl<'a> PlannedMotion<'a> {
    /// Returns the angle of the rollers at the start.
    pub fn start(&self) -> Phase {
        match self {
            Self::Dose(plan) => plan.start(),
            Self::Flow(flow) => flow.start(),
        }
    }

    /// Returns the number of motor steps, negative in reverse.
    pub fn steps(&self) -> i64 {
        match self {
            Self::Dose(plan) => plan.steps(),
            Self::Flow(flow) => flow.steps(),
        }
    }

    /// Returns the direction in which the rotor turns.
    pub fn direction(&self) -> Direction {
        match self {
            Self::Dose(plan) => plan.direction(),
            Self::Flow(flow) => flow.direction(),
        }
    }

    /// Returns the angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        match self {
            Self::Dose(plan) => plan.step_rad(),
            Self::Flow(flow) => flow.step_rad(),
        }
    }

    /// Returns the time of step `number`, s since the start. Step 0 is the start.
    pub fn time_of(&self, number: u64) -> f64 {
        match self {
            Self::Dose(plan) => plan.profile().time_of(number as f64 * plan.step_rad()),
            Self::Flow(flow) => flow.time_of(number),
        }
    }

    /// Returns the angle after `count` steps, rad, counted on from the start angle.
    pub fn angle_after(&self, count: u64) -> f64 {
        match self {
            Self::Dose(plan) => plan.angle_after(count),
            Self::Flow(flow) => flow.angle_after(count),
        }
    }

    /// Returns the fastest speed of the pump head, rad/s.
    pub fn peak_rad_s(&self) -> f64 {
        match self {
            Self::Dose(plan) => plan.profile().peak_rad_s(),
            Self::Flow(flow) => flow.pace().peak_rad_s,
        }
    }

    /// Returns the acceleration with which the motor stops, rad/s².
    pub fn acceleration_rad_s2(&self) -> f64 {
        match self {
            Self::Dose(plan) => plan.profile().acceleration_rad_s2(),
            Self::Flow(flow) => flow.acceleration_rad_s2(),
        }
    }

    /// Returns the volume of the planned steps once the line has settled, mL, negative in reverse.
    pub fn planned_ml(&self, pump: &Pump) -> f64 {
        match self {
            Self::Dose(plan) => plan.planned_ml(),
            Self::Flow(_) => self.delivered_ml(pump, self.steps().unsigned_abs()),
        }
    }

    /// Returns the volume of the first `count` steps once the line has settled, mL, negative in reverse.
    pub fn delivered_ml(&self, pump: &Pump, count: u64) -> f64 {
        match self {
            Self::Dose(plan) => plan.delivered_ml(pump, count),
            Self::Flow(flow) => {
                let curve = pump.outlet_curve();
                curve.volume_ml(flow.angle_after(count)) - curve.volume_ml(flow.start().angle_rad())
            }
        }
    }

    /// Returns the fewest steps in which the rotor stops once `made` steps are made, no more than are left.
    pub fn stopping_steps(&self, made: u64) -> u64 {
        match self {
            Self::Dose(plan) => {
                let left = plan.steps().unsigned_abs().saturating_sub(made);
                let steps = plan.stopping_steps(made, plan.profile().acceleration_rad_s2());
                steps.unsigned_abs().min(left)
            }
            Self::Flow(flow) => flow.stopping_steps(made),
        }
    }

    /// Plans the way to rest from the moment at which `made` steps are made. The result is `None` if the rotor stands
    /// at that moment.
    pub fn stop(&self, pump: &Pump, made: u64) -> Option<Plan> {
        match self {
            Self::Dose(plan) => plan.stop(pump, made),
            Self::Flow(flow) => flow.stop(pump, made),
        }
    }

    /// Returns the segments for a timer of this rate.
    pub fn segments(&self, tick_rate: TickRate) -> MotionSegments<'a> {
        match self {
            Self::Dose(plan) => MotionSegments::Dose(plan.segments(tick_rate)),
            Self::Flow(flow) => MotionSegments::Flow(flow.segments(tick_rate)),
        }
    }
}

impl Iterator for MotionSegments<'_> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        match self {
            Self::Dose(segments) => segments.next(),
            Self::Flow(segments) => segments.next(),
        }
    }
}

impl FusedIterator for MotionSegments<'_> {}
