//! Claims about the search for the index mark.

use std::ops::ControlFlow;

use pump_bench::drives::Drive;
use pump_bench::drives::GrblError;

use crate::rig::{dose, grbl_error, open, run, start};
use crate::simulated::Simulated;
use crate::simulated::options::{Options, Sensor};

fn with_sensor(at: i64) -> Simulated {
    start(Options { sensor: Some(Sensor { at, width: 60, every: 12_800 }), ..Options::default() })
}

#[test]
fn the_mark_is_found_and_how_far_the_motor_went_beyond_it() {
    let board = with_sensor(4_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 14.0, 4.0);
    let sought = grbl.seek(&plan, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let stands = board.rest().steps as u64;
    assert_eq!(sought.made, stands);
    assert_eq!(sought.made - sought.beyond.unwrap(), 4_000);
    // The board's modes are restored, and jogs go on from there.
    let rest = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps as u64);
    assert!(board.truth().lines.iter().any(|line| line == "G0G21G90G94"), "{:?}", board.truth().lines);
}

#[test]
fn a_mark_that_is_not_there_costs_the_whole_way_and_no_lock() {
    let board = with_sensor(9_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.5, 5.0);
    let sought = grbl.seek(&plan, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!((sought.made, sought.beyond), (plan.steps as u64, None));
    assert_eq!(board.rest().steps, plan.steps);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps as u64);
}

#[test]
fn a_search_that_begins_on_the_mark_moves_nothing_and_says_what_to_do() {
    let board = with_sensor(-10);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.5, 5.0);
    let fault = grbl.seek(&plan, &mut |_, _| ControlFlow::Continue(())).unwrap_err();
    assert_eq!((fault.made_least, fault.made_most, fault.lost), (0, 0, false));
    assert!(matches!(grbl_error(fault.error), GrblError::Alarm { code: 4 }));
    assert_eq!(board.truth().steps, 0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps as u64);
}

#[test]
fn a_search_that_is_stopped_decelerates_and_keeps_its_count() {
    let board = with_sensor(12_000);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 12.0, 2.0);
    let sought = grbl
        .seek(&plan, &mut |made, _| {
            if made > 1_500 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    assert_eq!(sought.beyond, None);
    assert_eq!(sought.made, board.rest().steps as u64);
    assert!(sought.made > 1_500 && sought.made < plan.steps as u64);
    let rest = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps as u64);
}
