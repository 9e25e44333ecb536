//! Clocks that drift, wander and jump, behind delays that are never equal.

use std::f64::consts::TAU;
use std::time::Duration;

use super::board_clock::{BoardClock, ClockBounds};
use super::error::ClockError;
use super::sample::Reading;

/// Random numbers from 0 to 1 (Steele, Lea and Flood, SplitMix64, 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Board whose clock is computed from the computer's.
#[derive(Clone, Copy)]
struct Board {
    hz: u32,
    start: f64,
    drift: f64,
    /// Amplitude of a drift that swings once in 600 s.
    swing: f64,
    /// Longest delay of a question, and of an answer, s. Either is drawn from 0.1 of it to all of it.
    delays: [f64; 2],
}

const PERIOD_S: f64 = 600.0;

impl Board {
    /// Returns the ticks at a time, with their fraction.
    fn ticks(&self, time_s: f64) -> f64 {
        let swung = self.swing * PERIOD_S / TAU * (1.0 - (TAU * time_s / PERIOD_S).cos());
        self.start + f64::from(self.hz) * (time_s * (1.0 + self.drift) + swung)
    }

    fn read(&self, asked_s: f64, random: &mut Random) -> Reading<u64> {
        let delay = |most: f64, random: &mut Random| most * (0.1 + 0.9 * random.next());
        let read_s = asked_s + delay(self.delays[0], random);
        let to_s = read_s + delay(self.delays[1], random);
        let (from, to) = (Duration::from_secs_f64(asked_s), Duration::from_secs_f64(to_s));
        Reading { from, to, ticks: self.ticks(read_s) as u64 }
    }
}

fn low(reading: Reading<u64>) -> Reading {
    Reading { from: reading.from, to: reading.to, ticks: reading.ticks as u32 }
}

/// Board number `seed`: rates of real boards, any drift to 100 ppm either way, delays to 5 ms one way.
fn board(seed: u64, random: &mut Random) -> Board {
    let hz = [12_000_000, 16_000_000, 64_000_000, 72_000_000, 180_000_000, 520_000_000][seed as usize % 6];
    let start = random.next() * 2_f64.powi(34);
    let drift = 200e-6 * (random.next() - 0.5);
    let mut delays = [0.2e-3 + 4.8e-3 * random.next(), 0.2e-3 + 0.5e-3 * random.next()];
    if random.next() < 0.5 {
        delays.reverse();
    }
    Board { hz, start, drift, swing: 0.0, delays }
}

/// Follows a board for `minutes`, and checks each prediction up to 2 s ahead and back. Returns the widest uncertainty
/// of the clock in the last half, s.
fn follow(board: Board, bounds: ClockBounds, minutes: f64, random: &mut Random) -> f64 {
    let mut now_s = random.next();
    let mut clock = BoardClock::new(board.hz, bounds, board.read(now_s, random)).unwrap();
    let mut widest = 0.0_f64;
    while now_s < 60.0 * minutes {
        now_s += 0.2 + 1.6 * random.next();
        let reading = board.read(now_s, random);
        assert_eq!(clock.take(low(reading)), Ok(reading.ticks), "the clock was counted into another turn");
        for ahead_s in [-2.0, -0.5, 0.0, 0.1, 0.25, 1.0, 2.0] {
            let time_s = (now_s + ahead_s).max(0.0);
            let time = Duration::from_secs_f64(time_s);
            let (at, truth) = (clock.at(time), board.ticks(time.as_secs_f64()));
            assert!((at.value as f64 - truth).abs() <= at.within, "{at:?} {truth} at {ahead_s}");
            let back = clock.time_of(truth as u64);
            // The whole tick came up to a tick before.
            let wrong_s = (back.value.as_secs_f64() - time.as_secs_f64()).abs();
            assert!(wrong_s <= back.within + 2e-9, "{back:?} {wrong_s} at {ahead_s}");
            if now_s > 30.0 * minutes && ahead_s == 0.25 {
                widest = widest.max(at.within / f64::from(board.hz));
            }
        }
        let drift = clock.drift();
        let truth = board.drift + board.swing * (TAU * now_s / PERIOD_S).sin();
        assert!((drift.value - truth).abs() <= drift.within + 2.0 * bounds.wander_per_s, "{drift:?} {truth}");
    }
    widest
}

#[test]
fn predictions_stay_within_their_uncertainty_at_any_drift_and_delay() {
    for seed in 0..60 {
        let mut random = Random(seed);
        let board = board(seed, &mut random);
        let widest = follow(board, ClockBounds::default(), 4.0, &mut random);
        // Some answers come after the shortest delays, a tenth of the longest.
        let delays_s = board.delays[0] + board.delays[1];
        assert!(widest < 0.4 * delays_s + 50e-6, "{seed}: {widest} s of {delays_s} s");
    }
}

#[test]
fn a_drift_that_changes_within_its_bounds_is_followed() {
    for seed in 0..12 {
        let mut random = Random(1000 + seed);
        // 90 ppm in a period of 600 s change by 0.94 ppm in a second at most.
        let board = Board { drift: 5e-6, swing: 90e-6, ..board(seed, &mut random) };
        follow(board, ClockBounds::default(), 12.0, &mut random);
    }
}

#[test]
fn a_drift_is_known_to_a_few_ppm_after_a_minute_of_short_delays() {
    let mut random = Random(5);
    let board = Board { hz: 12_000_000, start: 7.0, drift: -83e-6, swing: 0.0, delays: [0.2e-3; 2] };
    let mut clock = BoardClock::new(board.hz, ClockBounds::default(), board.read(0.0, &mut random)).unwrap();
    for second in 1..=60 {
        clock.take(low(board.read(f64::from(second), &mut random))).unwrap();
    }
    let drift = clock.drift();
    assert!(drift.within < 25e-6 && (drift.value - board.drift).abs() <= drift.within, "{drift:?}");
}

#[test]
fn a_clock_that_is_read_after_hours_is_still_counted_into_its_turn() {
    let mut random = Random(6);
    let board = Board { hz: 180_000_000, start: 1e12, drift: 40e-6, swing: 0.0, delays: [1e-3; 2] };
    let bounds = ClockBounds { drift: 0.01, wander_per_s: 1e-9 };
    let mut clock = BoardClock::new(board.hz, bounds, board.read(0.0, &mut random)).unwrap();
    for second in 1..=60 {
        clock.take(low(board.read(f64::from(second), &mut random))).unwrap();
    }
    let late = board.read(3600.0, &mut random);
    assert_eq!(clock.take(low(late)), Ok(late.ticks));
}

#[test]
fn a_clock_that_is_read_too_late_is_not_guessed() {
    let mut random = Random(7);
    let board = Board { hz: 180_000_000, start: 0.0, drift: 0.0, swing: 0.0, delays: [1e-3; 2] };
    let mut clock = BoardClock::new(board.hz, ClockBounds::default(), board.read(0.0, &mut random)).unwrap();
    let error = clock.take(low(board.read(3600.0, &mut random))).unwrap_err();
    assert!(matches!(error, ClockError::Stale { .. }), "{error}");
    assert_eq!(
        error.to_string(),
        "the board's clock was last read 3600 s ago and is known to within 42.5 s, too little to count its turns; ask \
         the board how long it has been running"
    );
}

#[test]
fn a_jump_is_told_at_the_next_reading() {
    for seed in 0..40 {
        let mut random = Random(2000 + seed);
        let board = board(seed, &mut random);
        let mut clock =
            BoardClock::new(board.hz, ClockBounds::default(), board.read(0.0, &mut random)).unwrap();
        for second in 1..=90 {
            clock.take(low(board.read(f64::from(second), &mut random))).unwrap();
        }
        let before = clock.clone();
        // The least jump that no delay explains is the longest time that a reading takes, and what the clock is
        // uncertain by.
        let least_s = board.delays[0]
            + board.delays[1]
            + 2.0 * clock.at(Duration::from_secs(91)).within / f64::from(board.hz);
        for jump_s in [least_s, -least_s, 0.05, -0.05, 2.0, -2.0] {
            let jumped = Board { start: board.start + jump_s * f64::from(board.hz), ..board };
            let told = clock.take(low(jumped.read(91.0, &mut random)));
            let Err(ClockError::Jump { by_ms, .. }) = told else { panic!("{seed}: {jump_s} s: {told:?}") };
            assert!(by_ms * jump_s > 0.0 && by_ms.abs() <= 1000.0 * jump_s.abs(), "{by_ms} ms of {jump_s} s");
            assert!(by_ms.abs() > 1000.0 * (jump_s.abs() - least_s) - 1e-3, "{by_ms} ms of {jump_s} s");
        }
        // A reading that was refused has changed nothing.
        let reading = low(board.read(91.0, &mut random));
        let time = Duration::from_secs(92);
        assert_eq!(clock.at(time), before.at(time));
        clock.take(reading).unwrap();
    }
}

#[test]
fn a_jump_is_worded() {
    let later = ClockError::Jump { by_ms: 12.5, within_ms: 0.25 }.to_string();
    assert_eq!(
        later,
        "the clock of the board or of this computer has jumped: the board's is 12.500 ms later than it could be by \
         this computer's; it is read anew before anything moves again"
    );
}

#[test]
fn an_answer_before_its_question_is_refused() {
    let (early, late) = (Duration::from_secs(1), Duration::from_secs(2));
    let wrong = Reading { from: late, to: early, ticks: 1_u64 };
    let error = BoardClock::new(1_000_000, ClockBounds::default(), wrong).unwrap_err();
    assert_eq!(error, ClockError::Order { took_s: -1.0 });
    let first = Reading { from: early, to: early, ticks: 1 };
    let mut clock = BoardClock::new(1_000_000, ClockBounds::default(), first).unwrap();
    assert_eq!(clock.take(low(wrong)), Err(ClockError::Order { took_s: -1.0 }));
}

#[test]
fn no_times_and_ticks_make_a_clock_panic() {
    let times = [Duration::ZERO, Duration::from_secs(1), Duration::from_secs(u64::MAX), Duration::MAX];
    for from in times {
        for to in times {
            for ticks in [0, u64::MAX, 1 << 63] {
                let reading = Reading { from, to, ticks };
                let Ok(mut clock) = BoardClock::new(0, ClockBounds::default(), reading) else { continue };
                for time in times {
                    _ = clock.at(time);
                    _ = clock.time_of(u64::MAX - ticks);
                    _ = clock.take(Reading { from, to: time, ticks: 3 });
                }
            }
        }
    }
}
