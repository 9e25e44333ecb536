//! Claims about the search for the index mark.

use std::time::Duration;

use pump_bench::drives::{Disturbance, Drive, GrblError, Leave};

use crate::rig::{dose, grbl_error, open, run, start};
use crate::simulated::options::{Options, Sensor};
use crate::virtual_time::board::Board;

fn with_sensor(at: i64) -> Board {
    start(Options { sensor: Some(Sensor { at, width: 60, every: 12_800 }), ..Options::default() })
}

#[test]
fn the_mark_is_found_and_how_far_the_motor_went_beyond_it() {
    let board = with_sensor(4_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 14.0, 4.0);
    let sought = grbl.seek(&plan, &mut |_, _| Leave::Go).unwrap();
    let stands = board.rest().steps as u64;
    assert_eq!(sought.made, stands);
    assert_eq!(sought.made - sought.beyond.unwrap(), 4_000);
    // The board's modes are restored, and jogs go on from there.
    let rest = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps() as u64);
    assert!(board.truth().lines.iter().any(|line| line == "G0G21G90G94"), "{:?}", board.truth().lines);
}

#[test]
fn a_mark_that_is_not_there_costs_the_whole_way_and_no_lock() {
    let board = with_sensor(9_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.5, 5.0);
    let sought = grbl.seek(&plan, &mut |_, _| Leave::Go).unwrap();
    assert_eq!((sought.made, sought.beyond), (plan.steps() as u64, None));
    assert_eq!(board.rest().steps, plan.steps());
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
}

#[test]
fn a_search_that_begins_on_the_mark_moves_nothing_and_says_what_to_do() {
    let board = with_sensor(-10);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.5, 5.0);
    let fault = grbl.seek(&plan, &mut |_, _| Leave::Go).unwrap_err();
    assert_eq!((fault.made_least, fault.made_most, fault.lost), (0, 0, false));
    assert!(matches!(grbl_error(fault.error), GrblError::Alarm { code: 4 }));
    assert_eq!(board.truth().steps, 0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
}

#[test]
fn a_board_that_is_reset_while_the_search_waits_gets_no_move() {
    let board = with_sensor(4_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 6.0, 4.0);
    for waits in [true, false] {
        let mut asked = 0;
        let fault = grbl.seek(&plan, &mut |_, _| {
            asked += 1;
            if asked == 1 {
                // The disk takes its time, and somebody else resets the board.
                board.send(&[0x18]);
                board.pass(Duration::from_millis(150));
            }
            if waits && asked < 3 { Leave::Wait } else { Leave::Go }
        });
        let fault = fault.unwrap_err();
        assert_eq!((fault.made_least, fault.made_most, fault.lost), (0, 0, false));
        assert!(matches!(grbl_error(fault.error), GrblError::Reset));
        assert_eq!(grbl.disturbed(), Some(Disturbance::Reset));
    }
    let truth = board.rest();
    assert_eq!(truth.steps, 0);
    assert!(!truth.lines.iter().any(|line| line.contains("G38")), "{:?}", truth.lines);
}

#[test]
fn a_search_that_is_stopped_decelerates_and_keeps_its_count() {
    let board = with_sensor(12_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 12.0, 2.0);
    let sought = grbl
        .seek(&plan, &mut |made, _| {
            if made > 1_500 { Leave::Stop } else { Leave::Go }
        })
        .unwrap();
    assert_eq!(sought.beyond, None);
    assert_eq!(sought.made, board.rest().steps as u64);
    assert!(sought.made > 1_500 && sought.made < plan.steps() as u64);
    let rest = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps() as u64);
}
