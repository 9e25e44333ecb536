//! What is dosed, and how it is written down. The host's check compiles this file too, so that both do the same.

use core::fmt;

use pump_ctl::plan::{Cruise, Phase, Plan, PlanError, Prediction, Request, plan};
use pump_ctl::step::{Segment, Stepper};

use crate::pump::{LIMITS, PUMP};

/// The time of a step is counted in microseconds.
pub const TICK_HZ: u32 = 1_000_000;

/// Segments that are queued before the motor starts: all of a dose, some 20 here.
pub const QUEUE: usize = 64;

/// What says when to make a step.
pub type Executor = Stepper<QUEUE>;

/// The dose, and what it is changed to on the way, mL.
pub const DOSE_ML: f64 = 25.0;
pub const CHANGED_ML: f64 = 20.0;

/// A dose from 0.3 rad at 5 mL/s.
pub fn plan_dose(volume_ml: f64) -> Result<Plan, PlanError> {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
    plan(&PUMP, Phase::known(0.3), &request, &LIMITS)
}

/// Queues a whole plan.
pub fn queue(executor: &mut Executor, plan: &Plan) {
    let all = executor.fill(&mut plan.segments(TICK_HZ).peekable());
    assert!(all == Ok(true), "the plan has more segments than the queue");
}

/// What is left of `segments` after the first `made` steps.
pub fn after_steps(segments: impl Iterator<Item = Segment>, made: u32) -> impl Iterator<Item = Segment> {
    let mut to_drop = made;
    segments.filter_map(move |segment| {
        let dropped = to_drop.min(segment.steps());
        to_drop -= dropped;
        let left = (segment.steps() - dropped) as i32;
        let first = (i128::from(segment.interval) << 32) + i128::from(segment.frac);
        let interval = first + i128::from(segment.add) * i128::from(dropped);
        (left > 0).then_some(Segment {
            count: i32::from(segment.direction()) * left,
            interval: (interval >> 32) as u64,
            frac: interval as u32,
            add: segment.add,
        })
    })
}

/// Writes a plan, its profile, its segments and its prediction, to the last bit.
pub fn write_plan(out: &mut impl fmt::Write, plan: &Plan, prediction: &Prediction) -> fmt::Result {
    writeln!(out, "plan: {} steps", plan.steps)?;
    let mut number = |name: &str, value: f64| writeln!(out, "{name}: {value:.6} = {:#018x}", value.to_bits());
    number("planned mL", plan.planned_ml)?;
    number("carry mL", plan.carry_ml)?;
    number("end angle rad", plan.end_angle_rad())?;
    number("duration s", plan.profile.duration_s())?;
    for leg in plan.legs() {
        number("leg start s", leg.start_s)?;
        number("leg duration s", leg.duration_s)?;
        number("leg angle rad", leg.angle_rad)?;
        number("leg speed rad/s", leg.speed_rad_s)?;
        number("leg acceleration rad/s2", leg.acceleration_rad_s2)?;
    }
    number("inlet min kPa", prediction.inlet.min_kpa)?;
    number("inlet max kPa", prediction.inlet.max_kpa)?;
    number("outlet min kPa", prediction.outlet.min_kpa)?;
    number("outlet max kPa", prediction.outlet.max_kpa)?;
    number("single step kPa", prediction.step_kpa)?;
    number("settling s", prediction.settle_s)?;
    for segment in plan.segments(TICK_HZ) {
        writeln!(out, "{segment:?}")?;
    }
    Ok(())
}
