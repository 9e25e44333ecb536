//! Stops at random instants: the deceleration begins within 1 ms of the end of the frame.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use pump_bench::built_in;
use pump_bench::drives::wire::Wire;
use pump_ctl::step::Segment;
use pump_link::message::{AXES, AxisState, PROMPT_PACKED, Request};
use pump_link::packing::{Codec, Grain};

use crate::board::host::{Host, Move, TICK_RATE};
use crate::board::motor::rises;
use crate::board::random::Random;
use crate::check;

/// Interval of the steps, us.
const INTERVAL: u64 = 200;

/// Longest time from the end of a stop's frame to the first slower step, us.
const MOST_US: f64 = 1_000.0;

/// Time of a byte on the line, us.
const BYTE_US: f64 = 1e7 / 460_800.0;

/// Longest time for which a stop and a configuration may keep interrupts off, in ns. Steps of other axes wait for it.
const MOST_STOP_OFF_NS: f64 = 25e3;
const MOST_CONFIGURED_OFF_NS: f64 = 20e3;

/// Stops moves of one axis, and of four of which the last gets a frame of segments just before.
pub(crate) fn stops(firmware: &Path, number: u32) -> Result<(), Box<dyn Error>> {
    let mut host = Host::new(firmware, 500)?;
    let brake = built_in("three-roller").ok_or("no such pump")?.limits().motor.brake(TICK_RATE)?;
    host.emulator.extremes()?;
    host.configure(0, &brake)?;
    let configured_ns = host.emulator.extremes()?.off_ns;
    println!("interrupts are off for {:.0} us at most while an axis is configured", 1e-3 * configured_ns);
    check(
        configured_ns > 0.0 && configured_ns <= MOST_CONFIGURED_OFF_NS,
        "the time for which a configuration keeps interrupts off",
    )?;
    for axis in 1..AXES as u8 {
        host.configure(axis, &brake)?;
    }
    let mut random = Random(0x0bad_cafe_1234_5671);
    for axes in [1, AXES as u8] {
        let (mut latest_us, mut off_ns): (f64, f64) = (0.0, 0.0);
        for case in 1..=number {
            let case = case + if axes > 1 { number } else { 0 };
            let (late_us, kept_off_ns) = stop(&mut host, case, axes, &mut random)?;
            (latest_us, off_ns) = (latest_us.max(late_us), off_ns.max(kept_off_ns));
        }
        println!(
            "{number} stops of {axes} at 5,000 steps/s each: slower {:.2} ms after the end of the frame, at most; \
             interrupts are off for {:.0} us",
            1e-3 * latest_us,
            1e-3 * off_ns
        );
        check(latest_us < MOST_US, "a stop within 1 ms of its frame")?;
        check(off_ns > 0.0 && off_ns <= MOST_STOP_OFF_NS, "the time for which a stop keeps interrupts off")?;
    }
    Ok(())
}

/// Moves so many axes and stops them. Returns the time from the end of the stop's frame to the first slower step, in
/// us, and the time for which interrupts were off, in ns.
fn stop(host: &mut Host, case: u32, axes: u8, random: &mut Random) -> Result<(f64, f64), Box<dyn Error>> {
    let even = Segment { count: 400, interval: INTERVAL, add: 0, frac: 0 };
    let mut moves = [0; AXES];
    let fed = Move::new(axes - 1, short_segments())?;
    for axis in 0..axes {
        let even = Move::new(axis, [even; 10])?;
        let made = if axes > 1 && axis == axes - 1 { &fed } else { &even };
        check(host.begin(case, made, made.segments.len().min(HELD))?, "that a move begins")?;
        moves[usize::from(axis)] = case;
    }
    host.emulator.sleep(Duration::from_micros(50_000 + random.below(200_000)));
    let mut frames = if axes > 1 { next_segments(host, case, &fed)? } else { Vec::new() };
    host.emulator.take_edges();
    host.emulator.extremes()?;
    frames.extend(host.frame(&Request::Stop { moves })?);
    let ends_us = 1e6 * host.emulator.now().as_secs_f64() + frames.len() as f64 * BYTE_US;
    host.emulator.write(&frames)?;
    host.emulator.sleep(Duration::from_millis(100));
    let off_ns = host.emulator.extremes()?.off_ns;
    let edges = host.emulator.take_edges();
    let mut latest_us: f64 = 0.0;
    // A step by which a motor is slower, beyond what the steps of other axes and segments delay its own.
    let slower_us = if axes > 1 { 6.0 } else { 2.0 };
    // The axis that is fed makes no even steps.
    for axis in 0..axes.min(AXES as u8 - 1) {
        let rises: Vec<f64> = rises(&edges, axis).iter().map(|ns| 1e-3 * ns).collect();
        let slower = rises.windows(2).find(|pair| pair[1] - pair[0] > INTERVAL as f64 + slower_us);
        let Some(slower) = slower else { return Err("a stop did nothing".into()) };
        latest_us = latest_us.max(slower[1] - ends_us);
    }
    for axis in 0..axes {
        while !matches!(host.status(axis)?.state, AxisState::Ended(_)) {}
    }
    Ok((latest_us, off_ns))
}

/// Most segments that a host holds.
const HELD: usize = 256;

/// Returns short segments, two frames and more, each unlike the one before.
fn short_segments() -> Vec<Segment> {
    let segment =
        |k: u64| Segment { count: 20 + (k % 7) as i32, interval: INTERVAL + 13 * k % 17, add: 0, frac: 0 };
    (0..HELD as u64).map(segment).collect()
}

/// Returns a frame of the segments that come next, as full as those of the drive.
fn next_segments(host: &mut Host, case: u32, made: &Move) -> Result<Vec<u8>, Box<dyn Error>> {
    let first = host.status(made.axis)?.next_segment;
    let mut packed = [0; PROMPT_PACKED];
    let mut room = &mut packed[..];
    let mut codec = Codec::new(Grain::Fine);
    let left = made.segments.get(first as usize..).unwrap_or_default();
    let written = left.iter().take_while(|segment| codec.write(segment, &mut room).is_ok()).count();
    let used = PROMPT_PACKED - room.len();
    check(written < left.len() && used > PROMPT_PACKED - 8, "that the frame is full")?;
    let packed = packed.get(..used).unwrap_or_default();
    host.frame(&Request::Segments { axis: made.axis, move_number: case, first, packed })
}
