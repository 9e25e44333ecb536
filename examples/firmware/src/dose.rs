//! The dose, and the form in which it is written down. The host's check compiles this file too, so that
//! both agree.

use core::fmt;

use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Plan, PlanError, Prediction, Ramps, Request, Retarget};
use pump_ctl::step::{Stepper, TickRate};

use crate::pump::{self, PUMP};

/// Limits of the motor alone. Pressures are predicted in a step of their own, so that planning stays fast.
const LIMITS: Limits = Limits::new(pump::LIMITS.motor);

/// Rate of the timer, Hz: the time of a step is counted in microseconds.
pub(crate) const TICK_HZ: u32 = 1_000_000;

/// Rate of the timer, for brake and segments.
pub(crate) const TICK_RATE: TickRate = TickRate::from_hz(TICK_HZ).expect("the timer runs");

/// Most segments that are queued before the motor starts: all of a dose, some 20 here.
pub(crate) const QUEUE: usize = 64;

/// Executor that says when to make a step.
pub(crate) type Executor = Stepper<QUEUE>;

/// Volume of the dose, mL.
pub(crate) const DOSE_ML: f64 = 25.0;

/// Volume and rate to which the dose is changed on the way, mL and mL/s.
const CHANGED_ML: f64 = 20.0;
const CHANGED_ML_S: f64 = 3.0;

/// Time for which the motor goes on with the old plan meanwhile, ticks.
pub(crate) const CHANGE_TICKS: u32 = 9_000;

/// Makes the planner of all doses.
pub(crate) fn doser() -> Doser<'static> {
    Doser::new(&PUMP, LIMITS).expect("the limits are in their ranges")
}

/// Plans a dose from 0.3 rad at 5 mL/s. It has the fastest ramps, so that a change can be planned beside the steps.
pub(crate) fn plan_dose(doser: &Doser<'_>, volume_ml: f64) -> Result<Plan, PlanError> {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
    doser.plan(Phase::known(0.3), &request.with_ramps(Ramps::Fastest))
}

/// Plans the dose with line-aware ramps.
pub(crate) fn plan_line_aware(doser: &Doser<'_>, volume_ml: f64) -> Result<Plan, PlanError> {
    doser.plan(Phase::known(0.3), &Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 }))
}

/// Writes the legs of the plan with line-aware ramps, to the last bit.
pub(crate) fn write_line_aware(out: &mut impl fmt::Write, plan: &Plan) -> fmt::Result {
    for leg in plan.legs() {
        let numbers = [leg.start_s, leg.duration_s, leg.angle_rad, leg.speed_rad_s, leg.acceleration_rad_s2];
        let [start, duration, angle, speed, acceleration] = numbers.map(f64::to_bits);
        writeln!(out, "line-aware leg: {start:#x} {duration:#x} {angle:#x} {speed:#x} {acceleration:#x}")?;
    }
    Ok(())
}

/// Plans the rest of the dose after `made` steps of `plan`, with the changed volume and rate.
pub(crate) fn change(doser: &Doser<'_>, plan: &Plan, made: u64) -> Result<Plan, PlanError> {
    doser.retarget(plan, &Retarget::new(made, CHANGED_ML, Cruise::Flow { ml_s: CHANGED_ML_S }))
}

/// Queues a whole plan.
pub(crate) fn queue(executor: &mut Executor, plan: &Plan) {
    let all = executor.fill(&mut plan.segments(TICK_RATE).feed());
    assert!(all == Ok(true), "the plan has more segments than the queue");
}

/// Writes a plan, its profile, its segments and its prediction, to the last bit.
pub(crate) fn write_plan(out: &mut impl fmt::Write, plan: &Plan, prediction: &Prediction) -> fmt::Result {
    writeln!(out, "plan: {} steps", plan.steps())?;
    let mut number = |name: &str, value: f64| writeln!(out, "{name}: {value:.6} = {:#018x}", value.to_bits());
    number("planned mL", plan.planned_ml())?;
    number("carry mL", plan.carry_ml())?;
    number("end angle rad", plan.end_angle_rad())?;
    number("duration s", plan.profile().duration_s())?;
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
    for segment in plan.segments(TICK_RATE) {
        writeln!(out, "{segment:?}")?;
    }
    Ok(())
}
