//! Claims about motors that pause or are late.

use std::time::Duration;

use pump_bench::drives::{Drive, GrblError, Leave};

use crate::rig::{dose, grbl_error, open, start};
use crate::simulated::options::Options;

/// Byte of a jog cancel.
const CANCEL: u8 = 0x85;

#[test]
fn a_motor_that_pauses_for_minutes_is_not_late() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 3.0, 5.0);
    let mut paused = None;
    let made = grbl.run(&plan, &mut |made, about_to| {
        let now = board.now();
        let waits = about_to > 1_000 && now - *paused.get_or_insert(now) < Duration::from_secs(300);
        if about_to > 1_000 && waits && about_to > made { Leave::Wait } else { Leave::Go }
    });
    assert_eq!(made.unwrap(), plan.steps() as u64);
    assert_eq!(board.truth().steps, plan.steps());
}

#[test]
fn a_board_that_has_made_all_steps_and_never_rests_is_late() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.0, 5.0);
    let fault = grbl
        .run(&plan, &mut |_, _| {
            board.meddle(|events| events.never_rests = true);
            assert!(board.now() < Duration::from_secs(200), "a motion without an end");
            Leave::Go
        })
        .unwrap_err();
    assert!((fault.made_least..=fault.made_most).contains(&plan.steps()), "{fault:?}");
    assert!(matches!(grbl_error(fault.error), GrblError::Late { .. }));
}

#[test]
fn a_motor_that_was_slow_before_a_pause_is_stopped_at_a_known_step_after_it() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 6.0, 5.0);
    // Half the speed makes the motor look behind, as by a counter that jumped back.
    board.meddle(|events| events.slower = 1.0);
    let (mut paused, mut resumed) = (None, false);
    let fault = grbl
        .run(&plan, &mut |made, about_to| {
            if about_to > 1_500 && !resumed {
                let since = *paused.get_or_insert(board.now());
                if board.now() - since < Duration::from_secs(10) {
                    return Leave::Wait;
                }
                resumed = true;
                board.meddle(|events| events.slower = 0.0);
            }
            if made > 2_200 && paused.take().is_some() {
                board.meddle(|events| events.pressed = Some(CANCEL));
            }
            Leave::Go
        })
        .unwrap_err();
    let steps = board.truth().steps;
    assert!(steps < plan.steps() - 500, "{steps} of {}", plan.steps());
    assert_eq!((fault.made_least, fault.made_most, fault.lost), (steps, steps, false), "{fault:?}");
    assert!(matches!(grbl_error(fault.error), GrblError::StoppedElsewhere { .. }));
}

#[test]
fn each_rest_of_a_motor_whose_drive_did_not_get_to_run_is_counted() {
    let mut rested = 0;
    for stall in [0, 100, 300, 400, 430, 450, 470, 500, 600, 2_000].map(Duration::from_millis) {
        for which in [0, 1] {
            let board = start(Options::default());
            let mut grbl = open(&board);
            let plan = dose(&grbl, 8.0, 5.0);
            let mut places = [300, 1_100, 1_900, 3_500].into_iter().peekable();
            let made = grbl.run(&plan, &mut |made, _| {
                if places.next_if(|place| made >= *place).is_some() {
                    board.meddle(|events| events.stalls[which] = stall);
                }
                Leave::Go
            });
            assert_eq!(made.unwrap() as i64, plan.steps());
            assert!(places.peek().is_none());
            let (counted, rests) = (u64::from(grbl.rests()), board.truth().starts - 1);
            // Some 0.44 s of steps are sent ahead. A motor that has but a few of them left may rest.
            let is_close = (350..600).contains(&stall.as_millis());
            assert!(counted == rests || is_close && counted > rests, "{stall:?}: {counted} of {rests}");
            rested += rests;
        }
    }
    assert!(rested >= 16, "{rested} rests");
}
