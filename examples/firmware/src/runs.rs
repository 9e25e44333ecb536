//! Makes three moves: a whole dose, one that is stopped, one whose volume is changed on the way.

use core::fmt::{Result, Write};

use pump_ctl::plan::Plan;
use pump_ctl::step::Segment;

use crate::board::{COUNT_HZ, StepPin, Wait, counts};
use crate::dose::{self, CHANGE_TICKS, QUEUE, TICK_RATE};
use crate::machine::{self, with};
use crate::measure::{INSTRUCTIONS_PER_COUNT, counting, tenths};

/// Makes a whole dose, and measures the cost of its interrupts.
pub fn whole(out: &mut impl Write, plan: &Plan) -> Result {
    // Beside the steps the processor does pieces of work of a known length. The time that is missing in the
    // end went into the interrupts.
    let piece = || cortex_m::asm::delay(500_000);
    let ((), ten) = counting(|| (0..10).for_each(|_| piece()));
    let waited = Wait::waited();
    with(|machine| machine.start(plan));
    let (pieces, all) = counting(|| {
        let mut pieces = 0;
        while machine::is_moving() {
            piece();
            pieces += 1;
        }
        pieces
    });
    let waiting = INSTRUCTIONS_PER_COUNT * Wait::waited().wrapping_sub(waited);
    let steps = plan.steps().unsigned_abs() as u32;
    writeln!(out, "run: whole")?;
    write_steps(out)?;
    let interrupts = all - pieces * (ten / 10) - waiting;
    tenths(out, interrupts, steps, "a step for the whole interrupt")?;
    tenths(out, waiting, steps, "a step more of waiting: 1.9 us high, 1.9 us low")
}

/// Makes a dose that is stopped after 2 s.
pub fn stopped(out: &mut impl Write, plan: &Plan) -> Result {
    with(|machine| machine.start(plan));
    wait(2 * COUNT_HZ);
    wait_for_step();
    let (made, asked, (promise, cost)) = with(|machine| {
        let asked = machine.elapsed();
        (machine.position(), asked, counting(|| machine.stop(asked)))
    });
    writeln!(out, "run: stopped")?;
    writeln!(
        out,
        "stop: after {made} steps, at {asked} us: {} steps, the last at {} us",
        promise.final_count, promise.last_step_at
    )?;
    write_steps(out)?;
    writeln!(out, "cost: {cost} instructions for a stop, with interrupts off")
}

/// Makes a dose whose volume and rate are changed after 2 s. The change is planned while the motor turns.
#[inline(never)]
pub fn changed(out: &mut impl Write, plan: &Plan) -> Result {
    let doser = dose::doser();
    with(|machine| machine.start(plan));
    wait(2 * COUNT_HZ);
    // The old plan stays until there is a new one.
    let (asked, junction) = with(|machine| {
        let asked = machine.elapsed();
        (asked, machine.junction(asked + u64::from(CHANGE_TICKS)))
    });
    let junction = junction.expect("the motor turns, with seconds to go");
    let (changed, planning) = counting(|| dose::change(&doser, plan, junction.position.unsigned_abs()));
    let changed = changed.expect("the rotor can still stop for the smaller volume");
    let mut segments = [Segment::default(); QUEUE];
    let (count, fitting) = counting(|| {
        let places = segments.iter_mut().zip(changed.segments(TICK_RATE));
        places.map(|(place, found)| *place = found).count()
    });
    let (taken_over, cost) = with(|machine| counting(|| machine.retarget(junction.at)));
    assert!(taken_over == Some(junction), "planning took longer than the motor could wait");
    with(|machine| machine.set_end(junction.position + changed.steps()));
    for segment in segments.into_iter().take(count) {
        with(|machine| machine.push(segment));
    }
    with(|machine| machine.finish());
    writeln!(out, "run: changed")?;
    writeln!(out, "change: asked at {asked} us: from step {} at {} us", junction.position, junction.at)?;
    write_steps(out)?;
    writeln!(out, "cost: {planning} instructions to plan a change, {fitting} for its {count} segments")?;
    writeln!(out, "cost: {cost} instructions for a retarget, with interrupts off")
}

fn wait(wanted: u32) {
    let began = counts();
    while counts().wrapping_sub(began) < wanted {}
}

/// Waits for the next step. Work right after it with interrupts off delays no step.
fn wait_for_step() {
    let last = StepPin::rose_at();
    while StepPin::rose_at() == last {}
}

/// Waits for the end, and writes the times at which each step was due and was made.
fn write_steps(out: &mut impl Write) -> Result {
    while machine::is_moving() {}
    with(|machine| {
        if let Some(fault) = machine.fault() {
            writeln!(out, "fault: {fault:?}")?;
        }
        for made in machine.record() {
            writeln!(out, "step: due {} us, made {} counts", made.due, made.rose)?;
        }
        writeln!(out, "position: {}", machine.position())
    })
}
