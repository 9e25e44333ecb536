//! Cuts of the link and kills of the host at random instants: the board's count is that of its pin's edges.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use pump_bench::built_in;
use pump_bench::drives::wire::Wire;
use pump_ctl::step::Segment;
use pump_link::message::{AXES, Answer, AxisState, AxisStatus, Request};

use crate::board::host::{Host, Move, TICK_RATE};
use crate::board::motor::Motor;
use crate::board::noise::Noise;
use crate::board::random::Random;
use crate::check;

/// Dead-man time, ms: the shortest that a host may set.
const DEAD_MAN_MS: u16 = 100;

/// Longest silence of a host, ms. About half of them are longer than the dead-man time.
const LONGEST_SILENCE_MS: u64 = 250;

/// Cuts the link of so many moves, and holds the board's count against the edges each time. In every second one single
/// bytes change on the line, in both directions.
pub(crate) fn cuts(firmware: &Path, number: u32) -> Result<(), Box<dyn Error>> {
    let mut host = Host::new(firmware, DEAD_MAN_MS)?;
    let brake = built_in("three-roller").ok_or("no such pump")?.limits().motor.brake(TICK_RATE)?;
    host.configure(0, &brake)?;
    let (mut random, mut motor) = (Random(0x1234_5678_9abc_def1), Motor::default());
    motor.turn(&host.emulator.take_edges());
    motor.count = 0;
    let (mut cut_short, mut complete, mut unbegun) = (0, 0, 0);
    let mut noise = Some(Noise::new(0x5eed_0f0f_1357_9bd1));
    for case in 1..=number {
        std::mem::swap(&mut host.noise, &mut noise);
        let from = host.status(0)?.position;
        let sign = if random.below(2) == 0 { 1 } else { -1 };
        let count = sign * (20 + random.below(60) as i32);
        let even = Segment { count, interval: 250 + random.below(800), add: 0, frac: 0 };
        let made = Move::new(0, vec![even; 1 + random.below(6) as usize])?;
        // Bytes that changed may have silenced the host for the dead-man time before the begin.
        let begins = host.begin(case, &made, 1 + random.below(6) as usize)?;
        check(begins || host.noise.is_some(), "that a move begins")?;
        // The host talks for a while, and then no more. Half of the cuts come within a frame.
        for _ in 0..random.below(12) {
            host.status(0)?;
            host.emulator.sleep(Duration::from_micros(random.below(20_000)));
        }
        if random.below(2) == 0 {
            let frame = host.frame(&Request::Stop { moves: [case, 0, 0, 0] })?;
            let bytes = frame.get(..random.below(frame.len() as u64 - 1) as usize).unwrap_or_default();
            host.emulator.write(bytes)?;
        }
        host.emulator.sleep(Duration::from_millis(random.below(LONGEST_SILENCE_MS)));
        let status = stopped(&mut host, case)?;
        motor.turn(&host.emulator.take_edges());
        let way = (status.position - from) * i64::from(sign);
        let all = made.steps().abs();
        if motor.count != status.position || !(0..=all).contains(&way) {
            let why = format!("cut {case}: {} counted, {} made, of {all}", status.position, motor.count);
            return Err(why.into());
        }
        match way {
            _ if !begins => unbegun += 1,
            _ if way < all => cut_short += 1,
            _ => complete += 1,
        }
    }
    let [to, from] = noise.or(host.noise).map_or([0; 2], |noise| noise.changed);
    println!(
        "{number} cuts of the link: the count is exact after each; {cut_short} moves were cut short, {complete} were \
         complete, {unbegun} did not begin"
    );
    println!(
        "  of {} on a line that changed bytes: {to} on the way to the board, {from} back",
        number.div_ceil(2)
    );
    check(cut_short > number / 10, "some moves are cut short")?;
    check(to > number / 2 && from > number / 2, "that bytes change in both directions")
}

/// Stops a move as a new process does, which has the session of the record. Returns the axis at rest.
fn stopped(host: &mut Host, case: u32) -> Result<AxisStatus, Box<dyn Error>> {
    host.adopt(DEAD_MAN_MS)?;
    let mut moves = [0; AXES];
    moves[0] = case;
    let stopped = host.ask(&Request::Stop { moves })?;
    check(matches!(stopped, Answer::Stopped { .. }), "the stop of a cut move")?;
    loop {
        let status = host.status(0)?;
        if matches!(status.state, AxisState::Ended(_)) {
            return Ok(status);
        }
    }
}
