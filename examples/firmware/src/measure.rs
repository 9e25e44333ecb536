//! Measures costs in instructions, flash and RAM.

use core::fmt::{Result, Write};
use core::hint::black_box;

use pump_ctl::plan::{Cruise, Doser, Phase, Plan, PlanError, Ramps, Request, Segments};
use pump_ctl::step::{Action, Brake, Stepper};
use pump_model::{FlowCurve, Pump};

use crate::board::counts;
use crate::dose::{self, DOSE_ML, Executor, TICK_RATE};
use crate::machine::Record;
use crate::memory;
use crate::pump::{LIMITS, PUMP};

/// With `-icount shift=3` an instruction takes 8 ns of the emulated time, and a count of the 25 MHz timer 40 ns.
pub const INSTRUCTIONS_PER_COUNT: u32 = 5;

/// Does `work` and returns its result with the instructions that it took, to the nearest five.
pub fn counting<R>(work: impl FnOnce() -> R) -> (R, u32) {
    let began = counts();
    let result = black_box(work());
    (result, INSTRUCTIONS_PER_COUNT * counts().wrapping_sub(began))
}

/// Refuses to measure where a count is not five instructions, by a loop of 2,000,000.
pub fn check_clock() {
    let ((), found) = counting(|| cortex_m::asm::delay(1_000_000));
    assert!(found.abs_diff(2_000_000) < 20, "{found} instructions for 2000000: run with -icount shift=3");
}

/// Writes `total` / `number` with one decimal.
pub fn tenths(out: &mut impl Write, total: u32, number: u32, what: &str) -> Result {
    let tenths = (10 * u64::from(total) + u64::from(number) / 2) / u64::from(number);
    writeln!(out, "cost: {}.{} instructions {what}", tenths / 10, tenths % 10)
}

/// Plans the dose with a smooth flow.
fn plan_smooth(doser: &Doser<'_>, volume_ml: f64) -> core::result::Result<Plan, PlanError> {
    let request =
        Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 }).with_smooth(true).with_ramps(Ramps::Fastest);
    doser.plan(Phase::known(0.3), &request)
}

/// Plans the dose and writes the plan and its cost. It is not inlined, so that its part of the stack is
/// free afterwards.
#[inline(never)]
pub fn plan(out: &mut impl Write) -> core::result::Result<Plan, core::fmt::Error> {
    let doser = dose::doser();
    let (plan, planning) = counting(|| dose::plan_dose(black_box(&doser), black_box(DOSE_ML)));
    let plan = plan.expect("the dose can be planned");
    let (segments, fitting) = counting(|| black_box(&plan).segments(TICK_RATE).map(black_box).count());
    let (prediction, predicting) = counting(|| black_box(&plan).predict(&PUMP));
    dose::write_plan(out, &plan, &prediction.expect("the lines settle"))?;
    let (aware, choosing) = counting(|| dose::plan_line_aware(black_box(&doser), black_box(DOSE_ML)));
    dose::write_line_aware(out, &aware.expect("the dose can be planned with line-aware ramps"))?;
    writeln!(out, "cost: {choosing} instructions to plan with line-aware ramps")?;
    let (smooth, smoothing) = counting(|| plan_smooth(&doser, black_box(DOSE_ML)));
    let smooth = smooth.expect("the dose can be planned with a smooth flow");
    let (pieces, cutting) = counting(|| black_box(&smooth).segments(TICK_RATE).map(black_box).count());
    writeln!(
        out,
        "cost: {} instructions for a plan with a smooth flow: {smoothing} for angle and profile, \
         {cutting} for {pieces} segments",
        smoothing + cutting
    )?;
    let (_, braking) = counting(|| black_box(LIMITS.motor).brake(TICK_RATE));
    writeln!(
        out,
        "cost: {} instructions for a plan: {planning} for angle and profile, {fitting} for {segments} segments",
        planning + fitting
    )?;
    writeln!(out, "cost: {predicting} instructions for a prediction of pressures and settling")?;
    writeln!(out, "cost: {braking} instructions for the motor's brake, once")?;
    Ok(plan)
}

fn queued(plan: &Plan) -> Executor {
    let mut executor = Executor::new(LIMITS.motor.brake(TICK_RATE).expect("the motor can be stopped"));
    dose::queue(&mut executor, plan);
    executor
}

/// Makes a step of the executor. It is not inlined, so that it reads and writes the executor's state at
/// every step, as in an interrupt.
#[inline(never)]
fn on_deadline(executor: &mut Executor, now: u64) -> Action {
    executor.on_deadline(now)
}

/// Measures `Stepper::on_deadline` alone, over a whole move. It is not inlined, as [`plan`].
#[inline(never)]
pub fn executor(out: &mut impl Write, plan: &Plan) -> Result {
    let mut executor = queued(plan);
    let mut due = executor.start(0).expect("the executor is at rest, with segments queued");
    let (steps, all) = counting(|| {
        let mut steps = 0;
        while let Action::Step { next, .. } = on_deadline(&mut executor, due) {
            due = next;
            steps += 1;
        }
        steps
    });
    tenths(out, all, steps, "a step in on_deadline, its call and the loop around it included")?;

    let mut executor = queued(plan);
    let mut due = executor.start(0).expect("the executor is at rest, with segments queued");
    let mut most = 0;
    loop {
        let (action, cost) = counting(|| on_deadline(&mut executor, due));
        most = most.max(cost);
        let Action::Step { next, .. } = action else { break };
        due = next;
    }
    writeln!(
        out,
        "cost: {most} instructions at most for a step in on_deadline, by a timer read in {}",
        counting(|| ()).1
    )
}

/// Writes the use of flash and RAM.
pub fn memory(out: &mut impl Write) -> Result {
    let (flash, statics) = memory::flash_and_statics();
    let record = size_of::<Record>();
    writeln!(out, "memory: {flash} bytes of flash")?;
    writeln!(out, "memory: {} bytes of statics, and {record} for the record of steps", statics - record)?;
    writeln!(out, "memory: {} bytes of stack", memory::stack())?;
    let (places, place) = (size_of::<Executor>(), size_of::<Stepper<65>>() - size_of::<Stepper<64>>());
    writeln!(
        out,
        "memory: {} bytes of an executor without its queue, {place} a place, {} its brake, {places} with 64 places",
        places - 64 * place,
        size_of::<Brake>()
    )?;
    writeln!(
        out,
        "memory: {} bytes of a plan, {} its segments, {} a pump, {} a flow curve",
        size_of::<Plan>(),
        size_of::<Segments>(),
        size_of::<Pump>(),
        size_of::<FlowCurve>()
    )
}
