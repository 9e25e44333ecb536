//! Changes of a move under way: another volume and flow from the last segment that was sent, without a rest.

use std::error::Error;
use std::path::Path;

use pump_bench::built_in;
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request as DoseRequest, Retarget};
use pump_ctl::step::Segment;
use pump_link::message::{AXES, Answer, AxisState, End, MoveChange, Request};
use pump_link::sender::Stream;

use crate::board::host::{Host, Move, TICK_RATE};
use crate::board::motor::rises;
use crate::check;
use crate::doses::START_RAD;

/// Largest distance of a rise from its time in the old or the new plan, us.
const MOST_OFF_US: f64 = 1.0;

/// Most instructions for which a change may keep the interrupts off: 15 us at 200 MHz, by a cycle each.
const MOST_KEPT_OFF: f64 = 3_000.0;

/// Changes: volume and flow before and after, mL and mL/s.
const CHANGES: [[(f64, f64); 2]; 3] =
    [[(3.0, 4.0), (4.5, 2.0)], [(6.0, 4.0), (3.5, 4.0)], [(-2.0, 2.0), (-3.0, 4.0)]];

/// Part of the plan's segments that are sent before the change.
const SENT: usize = 3;

/// Changes doses on their way, and holds each rise of the step pin against the plan that was in force.
pub(crate) fn retarget(firmware: &Path) -> Result<(), Box<dyn Error>> {
    for [before, after] in CHANGES {
        changed(firmware, before, after)?;
    }
    Ok(())
}

/// Returns the shortest interval of segments, as they are sent.
fn shortest(segments: &[Segment]) -> Result<u32, Box<dyn Error>> {
    Ok(Move::new(0, segments.iter().copied())?.shortest_interval() - 1)
}

fn changed(firmware: &Path, before: (f64, f64), after: (f64, f64)) -> Result<(), Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let doser = Doser::new(&pump, file.limits())?;
    let request = DoseRequest::new(before.0, Cruise::Flow { ml_s: before.1 }).with_smooth(true);
    let plan = doser.plan(Phase::known(START_RAD), &request)?;
    let segments: Vec<Segment> = plan.segments(TICK_RATE).collect();

    let mut host = Host::new(firmware, 500)?;
    host.configure(0, &file.limits().motor.brake(TICK_RATE)?)?;
    let made = Move::new(0, segments.iter().copied())?;
    let mut stream = Box::new(Stream::<256>::new(0));
    let Answer::Accepted { next, room } = host.prepare(1, &made)? else {
        return Err("the move was refused".into());
    };
    stream.accepted(next, room)?;
    feed(&mut host, &mut stream, &segments[..segments.len() / SENT])?;
    host.emulator.take_edges();
    let mut moves = [0; AXES];
    moves[0] = 1;
    check(host.begin_moves(moves)? == Answer::Begun, "that the move begins")?;
    host.emulator.counts()?;

    let takeover = stream.retarget();
    let made = takeover.position.unsigned_abs();
    let change = Retarget::new(made, after.0, Cruise::Flow { ml_s: after.1 });
    let rest = doser.retarget(&plan, &change)?;
    let new: Vec<Segment> = rest.segments(TICK_RATE).collect();
    let change = MoveChange {
        number: 1,
        first: takeover.first,
        last: takeover.position + rest.steps(),
        shortest_interval: shortest(&new)?,
    };
    let request = Request::Retarget { axis: 0, move_number: 1, change };
    // A repeated change is none.
    for _ in 0..2 {
        let Answer::Accepted { next, room } = host.ask(&request)? else {
            return Err("the change was refused".into());
        };
        stream.accepted(next, room)?;
    }
    let kept_off = host.emulator.counts()?.kept_off;
    stream.go_on();
    feed(&mut host, &mut stream, &new)?;
    loop {
        match host.status(0)?.state {
            AxisState::Moving => {}
            AxisState::Ended(End::Complete) => break,
            other => return Err(format!("the changed move ended so: {other:?}").into()),
        }
    }
    let rose = rises(&host.emulator.take_edges(), 0);
    hold(&plan, &rest, made, &rose, kept_off, (before, after))
}

/// Sends segments as the board has room for them.
fn feed(host: &mut Host, stream: &mut Stream<256>, segments: &[Segment]) -> Result<(), Box<dyn Error>> {
    let mut rest = segments.iter();
    loop {
        while stream.room() > 0 {
            let Some(segment) = rest.next() else { break };
            stream.push(*segment)?;
        }
        let mut packed = [0; 128];
        if let Some(chunk) = stream.chunk(&mut packed) {
            let packed = packed.get(..chunk.bytes).unwrap_or_default();
            let request = Request::Segments { axis: 0, move_number: 1, first: chunk.first, packed };
            match host.ask(&request)? {
                Answer::Accepted { next, room } => stream.accepted(next, room)?,
                other => return Err(format!("segments were refused: {other:?}").into()),
            }
        } else if rest.len() == 0 && stream.taken() == stream.sent() {
            return Ok(());
        } else {
            let status = host.status(0)?;
            stream.accepted(status.next_segment, status.room)?;
        }
    }
}

/// Holds the rises against the old plan up to the change, and the new one from there on.
fn hold(
    plan: &Plan,
    rest: &Plan,
    made: u64,
    rose: &[f64],
    kept_off: f64,
    (before, after): ((f64, f64), (f64, f64)),
) -> Result<(), Box<dyn Error>> {
    let old: Vec<f64> = plan.each_step().take(made as usize).map(|step| 1e6 * step.time_s).collect();
    let junction_us = old.last().copied().unwrap_or(0.0);
    let due = old.iter().copied().chain(rest.each_step().map(|step| junction_us + 1e6 * step.time_s));
    let off: Vec<f64> = due.zip(rose).map(|(due, at_ns)| 1e-3 * at_ns - due).collect();
    let (least, most) = off.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    println!(
        "{} mL at {} mL/s becomes {} mL at {} mL/s after {made} of {} steps: {} steps, rises within {half_us:.2} us of \
         the plans; interrupts off for {kept_off:.0} instructions at most",
        before.0,
        before.1,
        after.0,
        after.1,
        plan.steps().abs(),
        rose.len(),
    );
    check(rose.len() as u64 == made + rest.steps().unsigned_abs(), "the number of steps of a changed dose")?;
    check(half_us <= MOST_OFF_US, "the times of the steps of a changed dose")?;
    check(kept_off <= MOST_KEPT_OFF, "the bound of interrupts that are off")
}
