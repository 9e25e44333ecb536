//! Doses whose command is killed, and the rest of each. The board goes on until its queue ends, and tells its count, so
//! all steps of a dose are made once.

use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use crate::rig::{Rig, ended};
use crate::simulated_klipper::Character;

/// Kills, and boards at which they are made at once. They mostly wait.
const KILLS: u32 = 20;
const BOARDS: u32 = 4;

/// Returns the number of kills that the environment asks for, or the usual one.
fn kills() -> u32 {
    std::env::var("KLIPPER_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(KILLS)
}

/// Rates of the doses: below the motor's start-stop speed, where a halt costs nothing of the angle, and above it.
const RATES: [&str; 2] = ["2mL/s", "6mL/s"];

#[test]
fn all_steps_of_doses_that_are_killed_are_counted_and_slow_ones_are_resumed_to_the_step() {
    let midway: u32 = scope(|scope| {
        let boards: Vec<_> = (0..BOARDS).map(|board| scope.spawn(move || chain(board))).collect();
        boards.into_iter().map(|board| board.join().unwrap()).sum()
    });
    assert!(midway > kills() / 2, "only {midway} of {} were cut off midway", kills());
}

/// Volume of four full steps of the motor, by which it slips at least, in mL: of 12,800 steps a turn and 21.318 mL.
const SLIP_ML: f64 = 21.318 * 4.0 * 64.0 / 12_800.0;

/// Returns the width of the range of what was delivered, in mL.
fn slip_ml(said: &str) -> f64 {
    let words: Vec<_> = said.split_whitespace().collect();
    let range = words.windows(4).find(|four| four[0] == "between" && four[2] == "and");
    let range = range.unwrap_or_else(|| panic!("it has no range: {said}"));
    let [least, most] = [1, 3].map(|at| range[at].parse::<f64>().unwrap());
    most - least
}

/// Kills doses on a board, and resumes or accepts them. Returns the number of those that were cut off midway.
fn chain(board: u32) -> u32 {
    let rig = Rig::new(Character { drift_ppm: 100.0, ..Character::default() });
    let (mut midway, mut turned) = (0, 0);
    for n in (board..kills()).step_by(BOARDS as usize) {
        let (code, said) = rig.runs(&["home", "--set", "30deg", "--tolerance", "0deg"]);
        assert_eq!(code, Some(0), "{said}");
        let (before, is_slow) = (rig.board.truth().steps[0], (n / BOARDS).is_multiple_of(2));
        let way = if n % 3 == 0 { "-3mL" } else { "3mL" };
        let rate = if is_slow { RATES[0] } else { RATES[1] };
        let mut dose = rig.starts(&[way, "--rate", rate, "--confirm-pump"]);
        let until = Instant::now() + Duration::from_secs(30);
        // From the first steps to nearly the last.
        let from = u64::from(1 + n * 137 % 1700);
        while rig.board.truth().steps[0].abs_diff(before) < from
            && Instant::now() < until
            && dose.try_wait().unwrap().is_none()
        {
            sleep(Duration::from_millis(1));
        }
        dose.kill().unwrap();
        let (_, said) = ended(dose);
        // Some of the next commands meet a motor that still turns.
        if n % 4 != 0 {
            rig.comes_to_rest();
        }
        let cut = rig.state().and_then(|state| state.unfinished);
        if let Some(cut) = cut {
            midway += 1;
            let (code, resumed) = rig.runs(&[if is_slow { "resume" } else { "accept" }]);
            assert_eq!(code, Some(0), "{n}: {said}; {resumed}");
            if is_slow {
                let made = rig.board.truth().steps[0] - before;
                assert_eq!(made, cut.intent.steps, "{n}: {said}; {resumed}");
            } else {
                // A board that has made all steps made the plan's ramp too.
                let is_whole = rig.board.truth().steps[0] - before == cut.intent.steps;
                assert_eq!(resumed.contains("may have slipped"), !is_whole, "{n}: {resumed}");
                if !is_whole {
                    let slip_ml = slip_ml(&resumed);
                    assert!(slip_ml > SLIP_ML, "{n}: {slip_ml} mL, and more may have slipped: {resumed}");
                }
            }
        }
        turned += rig.board.truth().steps[0].abs_diff(before);
        let known = rig.state().unwrap().wear.revolutions * 12_800.0;
        assert!((known - turned as f64).abs() < 1e-3, "{n}: {known} steps on record, {turned} made: {said}");
    }
    let truth = rig.board.truth();
    assert_eq!((truth.stray, truth.shutdown), (0, None));
    midway
}
