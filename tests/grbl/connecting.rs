//! Claims about the search for a board, and the boards that are refused.

use std::ops::ControlFlow;
use std::time::Duration;

use pump_bench::drives::GrblError;
use pump_bench::drives::{Disturbance, Drive, DriveError, Grbl, Opening};
use pump_bench::notice::Remedy;
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::report::Explain;

use crate::rig::{
    defective, dose, grbl_error, motor, open, open_port, plug, port, refusal, run, start, table,
};
use crate::simulated::options::{Defects, Firmware, Options};

#[test]
fn a_line_that_never_settles_is_not_waited_for() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let began = board.now();
    for settle_s in [f64::INFINITY, f64::NAN, -1.0, 1e19] {
        assert!(grbl.settle(settle_s, &mut || ControlFlow::Break(())).unwrap().is_none());
    }
    for settle_s in [f64::INFINITY, f64::NAN] {
        assert!(grbl.settle(settle_s, &mut || ControlFlow::Continue(())).unwrap().is_none());
    }
    assert!(board.now() - began < Duration::from_secs(1));
    let began = board.now();
    grbl.settle(0.3, &mut || ControlFlow::Continue(())).unwrap();
    assert!(board.now() - began >= Duration::from_millis(300));
}

#[test]
fn a_board_that_resets_on_open_is_waited_for_unlocked_and_the_reset_told_once() {
    let board = plug(Options {
        resets_on_open: true,
        boot: Duration::from_millis(700),
        settings: vec![(22, 1.0)],
        ..Options::default()
    });
    let mut grbl = open_port(&board);
    assert_eq!(grbl.disturbed(), Some(Disturbance::Reset));
    assert_eq!(grbl.disturbed(), None);
    let plan = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
}

#[test]
fn a_board_that_was_opened_once_is_not_reset_again() {
    let board = plug(Options { resets_on_open: true, ..Options::default() });
    let mut grbl = open_port(&board);
    let plan = dose(&grbl, 0.5, 5.0);
    run(&mut grbl, &board, &plan).0.unwrap();
    drop(grbl);
    let mut again = open_port(&board);
    assert_eq!((again.count(), again.disturbed()), (Some(plan.steps()), None));
    assert_eq!(board.truth().resets, 1);
}

#[test]
fn a_second_driver_is_told_who_has_the_port() {
    let board = plug(Options::default());
    let _grbl = open_port(&board);
    let error = Grbl::open(&port(&board), &motor(), &Opening::default()).unwrap_err();
    let DriveError::Busy { holder, .. } = &error else { panic!("{error}") };
    assert!(holder.contains(&std::process::id().to_string()), "{error}");
}

#[test]
fn a_port_that_is_not_named_or_not_there_is_an_error_that_says_so() {
    let nowhere = DriveTable::of(DriverName::Grbl);
    let error = Grbl::open(&nowhere, &motor(), &Opening::default()).unwrap_err();
    assert_eq!(error.remedies(), [Remedy::NamePort], "{error}");
    let missing = DriveTable::of(DriverName::Grbl).with_port("/dev/ttyNOTHERE");
    let error =
        pump_bench::report::with_sources(&Grbl::open(&missing, &motor(), &Opening::default()).unwrap_err());
    assert!(error.contains("ttyNOTHERE"), "{error}");
}

#[test]
fn firmwares_of_the_family_are_driven_and_older_ones_refused() {
    for firmware in [Firmware::GrblHal, Firmware::FluidNc] {
        let board = start(Options { firmware, ..Options::default() });
        let mut grbl = open(&board);
        assert!(grbl.notes().is_empty());
        let plan = dose(&grbl, 0.5, 5.0);
        assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64, "{firmware:?}");
    }
    let old = refusal(Options { firmware: Firmware::Grbl09, ..Options::default() });
    assert!(matches!(grbl_error(old), GrblError::Old { .. }));
}

#[test]
fn an_axis_that_the_board_does_not_report_is_refused_at_once_with_those_that_it_does() {
    let cases = [
        (3, Axis::A, "the board reports the axes X, Y and Z, and [drive] axis is A"),
        (2, Axis::Z, "the board reports the axes X and Y, and [drive] axis is Z"),
        (1, Axis::Y, "the board reports the axis X alone, and [drive] axis is Y"),
    ];
    for firmware in [Firmware::Grbl, Firmware::GrblHal, Firmware::FluidNc] {
        for (axes, axis, said) in cases {
            let board = start(Options { axes, firmware, ..Options::default() });
            let refused = board.open(&table().with_axis(axis), &Opening::default()).unwrap_err();
            let error = pump_bench::report::with_sources(&refused);
            assert!(error.contains(said), "{error}");
            assert!(board.now() < Duration::from_secs(1), "{:?}", board.now());
            assert_eq!(board.truth().steps, 0);
        }
    }
}

#[test]
fn a_board_that_was_taken_for_a_node_is_driven_at_once_afterwards() {
    let board = start(Options::default());
    let refused = board.open_as_node().unwrap_err();
    assert!(!matches!(refused, DriveError::Interrupted), "{refused:?}");
    let mut grbl = open(&board);
    assert_eq!((board.truth().steps, grbl.count()), (0, Some(0)));
    let plan = dose(&grbl, 0.3, 5.0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
}

#[test]
fn whatever_another_program_left_in_the_board_moves_nothing() {
    let long = "x".repeat(300);
    let pieces = ["G1X10F100", "$J=G91X10F100", "$", "$$", "(", "G1X10F100(", &long, "\x01\x7f"];
    for piece in pieces {
        let board = start(Options::default());
        board.send(piece.as_bytes());
        let grbl = open(&board);
        assert_eq!((board.rest().steps, grbl.count()), (0, Some(0)), "{piece}");
    }
    // Bytes that grbl takes from the stream at once: cycle start, question, cancel, and the overrides.
    let mut board = start(Options::default());
    board.send(&[b'~', b'?', 0x85]);
    board.send(&(0x86..=0xff).collect::<Vec<u8>>());
    let _grbl = open(&board);
    assert_eq!(board.rest().steps, 0);
    // A hold waits for somebody to end it.
    board = start(Options::default());
    board.send(b"!");
    let held = board.open(&table(), &Opening::default()).unwrap_err();
    assert!(matches!(grbl_error(held), GrblError::Locked { .. }));
    assert_eq!(board.rest().steps, 0);
    // A reset is told as a disturbance.
    board = start(Options::default());
    board.send(&[0x18]);
    assert_eq!(open(&board).disturbed(), Some(Disturbance::Reset));
    assert_eq!(board.rest().steps, 0);
}

#[test]
fn a_motion_that_is_under_way_is_waited_for() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 6.0, 5.0);
    // The port is closed with jogs in the queue, as if this process died.
    let mut sent = 0;
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let _ = grbl.run(&plan, &mut |made, about_to| {
            assert!(made < 500, "dies here");
            sent = about_to;
            pump_bench::drives::Leave::Go
        });
    }));
    assert!(result.is_err());
    drop(grbl);
    assert!(board.truth().moving);
    let again = open(&board);
    let truth = board.truth();
    assert!(!truth.moving);
    assert_eq!(again.count(), Some(truth.steps));
    assert!(truth.steps >= 500 && truth.steps < plan.steps() && truth.steps <= sent as i64);
}

#[test]
fn a_locked_board_is_refused_with_what_to_do() {
    let board = defective(Defects { alarm: Some((300, 1)), ..Defects::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.0, 5.0);
    assert!(run(&mut grbl, &board, &plan).0.is_err());
    let again = run(&mut grbl, &board, &plan).0.unwrap_err();
    assert_eq!((again.made_least, again.made_most), (0, 0));
    assert!(pump_bench::report::with_sources(&again).contains("$X"), "{again}");
    drop(grbl);
    let error = board.open(&table(), &Opening::default()).unwrap_err();
    assert!(matches!(grbl_error(error), GrblError::Locked { .. }));
}

#[test]
fn a_sleeping_board_is_woken_and_that_is_a_reset() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    grbl.release().unwrap();
    assert_eq!(grbl.disturbed(), Some(Disturbance::Disabled));
    drop(grbl);
    let mut again = open(&board);
    assert_eq!(again.disturbed(), Some(Disturbance::Reset));
    let plan = dose(&again, 0.3, 5.0);
    assert_eq!(run(&mut again, &board, &plan).0.unwrap(), plan.steps() as u64);
}

#[test]
fn a_port_where_no_board_answers_is_refused_in_bounded_time() {
    let board = defective(Defects { silent: Some(0), ..Defects::default() });
    let started = board.now();
    let error = board.open(&table(), &Opening::default()).unwrap_err();
    assert!(matches!(grbl_error(error), GrblError::NoGrbl { .. }));
    assert!(board.now() - started < Duration::from_secs(20));
}
