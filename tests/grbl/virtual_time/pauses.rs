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
