//! Four axes at once.

use std::error::Error;
use std::path::Path;

use pump_bench::built_in;
use pump_ctl::plan::{Cruise, Doser, Phase, Request};
use pump_ctl::step::Segment;
use pump_link::message::{Answer, AxisState, End, Refusal};

use crate::board::emulator::{Counts, Edge, Emulator};
use crate::board::host::{Host, Move, TICK_RATE};
use crate::board::motor::rises;
use crate::check;

/// Axes whose steps are due within this time count as due together, us.
const TOGETHER_US: f64 = 10.0;

/// Allowed distance of a rise from its time for each axis that is due together with it, us.
const MOST_OFF_US: f64 = 2.0;

/// Allowed distance of 99.9 % of the rises that are due alone, us.
const MOSTLY_OFF_US: f64 = 1.0;

/// Longest interval of evenly spread steps whose queues are fed on their way, us. Below it the thread finds no gap for
/// its critical sections, and each of them may hold up a step.
const FED_US: u64 = 16;

/// Options of the emulator for a host at each port of the board.
const UART: &[&str] = &[];
const USB: &[&str] = &["--usb"];

/// Segments that a move begins with, and those that follow where the queue is fed on its way: more than it holds.
const SEGMENTS: usize = 4;
const FED_SEGMENTS: usize = 300;

/// Most instructions of an interrupt, and of a step on average. The waits within the interrupt are among them.
const MOST_INSTRUCTIONS: f64 = 6_000.0;
const MEAN_INSTRUCTIONS: f64 = 1_100.0;

/// Doses smoothly with four axes that begin at one tick.
pub(crate) fn smooth(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut host = Host::new(firmware, 500)?;
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let doser = Doser::new(&pump, file.limits())?;
    let mut moves = Vec::new();
    for (axis, (volume_ml, ml_s, phase)) in
        (0..).zip([(1.0, 2.0, 0.3), (1.0, 2.0, 0.3), (-0.7, 1.5, 1.0), (1.5, 3.0, 2.0)])
    {
        let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(true);
        let plan = doser.plan(Phase::known(phase), &request)?;
        host.configure(axis, &file.limits().motor.brake(TICK_RATE)?)?;
        moves.push(Move::new(axis, plan.segments(TICK_RATE))?);
    }
    println!("four smooth doses at 2, 2, -1.5 and 3 mL/s, begun at one tick:");
    make(&mut host, &moves)
}

/// Makes even steps with some axes, `apart` us from one axis to the next. Fast moves are so long that the queues are
/// fed meanwhile.
fn even(firmware: &Path, port: &[&str], axes: u8, interval: u64, apart: u64) -> Result<(), Box<dyn Error>> {
    let mut host = Host::over(Emulator::with_options(firmware, port)?, 500)?;
    let brake = built_in("three-roller").ok_or("no such pump")?.limits().motor.brake(TICK_RATE)?;
    let gap = if apart == 0 { interval } else { apart };
    let (segments, count) = if gap <= FED_US { (FED_SEGMENTS, 40) } else { (SEGMENTS, 500) };
    let mut moves = Vec::new();
    for axis in 0..axes {
        host.configure(axis, &brake)?;
        let even = Segment { count, interval, add: 0, frac: 0 };
        let first = Segment { count: 1, interval: interval + apart * u64::from(axis), ..even };
        moves.push(Move::new(axis, std::iter::once(first).chain(std::iter::repeat_n(even, segments)))?);
    }
    let sum_hz = f64::from(axes) * 1e6 / interval as f64;
    let name = if port == USB { ", over USB" } else { "" };
    println!("{axes} axes every {interval} us, {apart} us apart, {sum_hz:.0} steps/s in all{name}:");
    make(&mut host, &moves)
}

/// Returns the shortest interval of four axes whose even steps are `sum_hz` at most, us.
fn even_interval(sum_hz: u32) -> u64 {
    4_000_000_u64.div_ceil(u64::from(sum_hz))
}

/// Makes even steps with one axis and with four, at one tick and evenly spread, up to the largest rate that the board
/// accepts. The board refuses more.
pub(crate) fn evens(firmware: &Path) -> Result<(), Box<dyn Error>> {
    for interval in [1_000, 108, 25, FED_US, 12] {
        even(firmware, UART, 1, interval, 0)?;
    }
    even(firmware, UART, 4, 1_000, 0)?;
    for apart in [250, 27, FED_US, 12] {
        even(firmware, UART, 4, 4 * apart, apart)?;
    }
    // One axis at the shortest interval that the board accepts, and four.
    let allowed = Host::new(firmware, 500)?.identity.max_step_hz;
    let interval = even_interval(allowed);
    for port in [UART, USB] {
        even(firmware, port, 1, 1_000_000_u64.div_ceil(u64::from(allowed)), 0)?;
        even(firmware, port, 4, interval, 0)?;
        even(firmware, port, 4, interval, interval / 4)?;
    }
    refused(firmware)
}

/// Refuses a fourth move whose steps would be more than the board makes.
fn refused(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut host = Host::new(firmware, 500)?;
    let allowed = host.identity.max_step_hz;
    let brake = built_in("three-roller").ok_or("no such pump")?.limits().motor.brake(TICK_RATE)?;
    for axis in 0..4 {
        host.configure(axis, &brake)?;
        let interval = even_interval(allowed) - if axis == 3 { 2 } else { 0 };
        let made = Move::new(axis, [Segment { count: 100, interval, add: 0, frac: 0 }])?;
        match (axis, host.prepare(1, &made)?) {
            (0..3, Answer::Accepted { .. }) => {}
            (3, Answer::Refused(Refusal::StepRate { sum_hz, allowed_hz })) => {
                println!("{sum_hz} steps/s of four axes are refused; {allowed_hz} are allowed");
                check(sum_hz > allowed && allowed_hz == allowed, "the refused rate")?;
            }
            (axis, answer) => return Err(format!("axis {axis}: {answer:?}").into()),
        }
    }
    Ok(())
}

/// Makes moves, and holds each rise against its time.
fn make(host: &mut Host, moves: &[Move]) -> Result<(), Box<dyn Error>> {
    host.emulator.take_edges();
    let before = host.emulator.counts()?;
    let (_, states) = host.make(1, moves)?;
    let counts = host.emulator.counts()?;
    let complete = states.iter().all(|state| *state == AxisState::Ended(End::Complete));
    if !complete {
        return Err(format!("the moves ended so: {states:?}").into());
    }
    hold(moves, &host.emulator.take_edges(), before, counts)
}

/// Holds moves that began at one tick against the edges.
pub(crate) fn hold(
    moves: &[Move],
    edges: &[Edge],
    before: Counts,
    counts: Counts,
) -> Result<(), Box<dyn Error>> {
    let times: Vec<Vec<f64>> = moves.iter().map(Move::times).collect();
    let rose: Vec<Vec<f64>> =
        moves.iter().map(|made| rises(edges, made.axis).iter().map(|ns| 1e-3 * ns).collect()).collect();
    let counted = times.iter().zip(&rose).all(|(times, rose)| times.len() == rose.len());
    check(counted, "one rise for each step")?;
    let near = |at: f64| {
        let due = |times: &&Vec<f64>| {
            let from = times.partition_point(|time| *time < at - TOGETHER_US);
            times.get(from).is_some_and(|time| *time <= at + TOGETHER_US)
        };
        times.iter().filter(due).count()
    };
    let mut off: Vec<(f64, usize)> = times
        .iter()
        .zip(&rose)
        .flat_map(|(times, rose)| times.iter().zip(rose))
        .map(|(due, rose)| (rose - due, near(*due)))
        .collect();
    off.sort_by(|one, other| one.0.total_cmp(&other.0));
    // The way into the interrupt is constant, and the begin is known to the tick: the middle half is on time.
    let middle = off.get(off.len() / 4).map_or(0.0, |(off, _)| *off)
        + off.get(3 * off.len() / 4).map_or(0.0, |(off, _)| *off);
    let middle = 0.5 * middle;
    for k in 1..=moves.len() {
        let mut of_k: Vec<f64> =
            off.iter().filter(|(_, near)| *near == k).map(|(off, _)| (off - middle).abs()).collect();
        of_k.sort_by(f64::total_cmp);
        let Some(most) = of_k.last() else { continue };
        let within = of_k.get((of_k.len() - 1) * 999 / 1000).unwrap_or(most);
        println!(
            "  {k} due within 10 us: {} rises, 99.9 % within {within:.2} us, all {most:.2} us",
            of_k.len()
        );
        check(*most <= MOST_OFF_US * k as f64, "the allowed distance for each axis that is due")?;
        check(k > 1 || *within <= MOSTLY_OFF_US, "the distance of 99.9 % of the rises that are due alone")?;
    }
    let first: Vec<f64> =
        rose.iter().zip(&times).filter_map(|(rose, due)| Some(rose.first()? - due.first()?)).collect();
    let spread =
        first.iter().fold(f64::MIN, |a, b| a.max(*b)) - first.iter().fold(f64::MAX, |a, b| a.min(*b));
    let mean = (counts.instructions - before.instructions) / off.len() as f64;
    println!(
        "  the begins differ by {spread:.2} us; {mean:.0} instructions a step with waits, {:.0} an interrupt at most, \
         {:.0} with interrupts off at most",
        counts.most, counts.kept_off
    );
    check(spread <= 1.0, "a begin within a tick")?;
    check(mean <= MEAN_INSTRUCTIONS && counts.most <= MOST_INSTRUCTIONS, "the bound of instructions")
}
