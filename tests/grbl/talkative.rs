//! Claims about boards that never fall silent: they report or send messages by themselves, without end.

use std::ops::ControlFlow;
use std::time::Duration;

use pump_bench::drives::{Drive, DriveError, Leave, Opening, StopRequest};

use crate::rig::{dose, each, open, run, run_until, start, table};
use crate::simulated::options::{Defects, Firmware, Options};
use crate::virtual_time::board::Board;

/// Longest time from a request to stop to the end of a wait at rest.
const ANSWERS: Duration = Duration::from_millis(200);

/// Returns the ways in which a board talks without end.
fn talkative() -> [Options; 4] {
    let every = |ms| Some(Duration::from_millis(ms));
    let hal = Options { firmware: Firmware::GrblHal, ..Options::default() };
    [
        Options { auto_report: every(100), ..hal.clone() },
        Options { auto_report: every(10), ..hal.clone() },
        Options { chatters: true, ..hal.clone() },
        Options { auto_report: every(10), chatters: true, ..hal },
    ]
}

/// Returns a request to stop that is made at this time on the board's clock.
fn stop_at(board: &Board, time: Duration) -> StopRequest {
    let board = board.clone();
    StopRequest::new(move || board.now() >= time)
}

#[test]
fn a_board_that_never_falls_silent_doses_exactly() {
    each(talkative(), |options| {
        let board = start(options);
        let mut grbl = open(&board);
        let plan = dose(&grbl, 1.5, 5.0);
        assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
        assert_eq!(grbl.disturbed(), None);
        let started = board.now();
        grbl.settle(0.3, &mut || ControlFlow::Continue(())).unwrap();
        assert!((Duration::from_millis(290)..Duration::from_secs(1)).contains(&(board.now() - started)));
        let made = run_until(&mut grbl, &board, &plan, |made, _| made > 500).0.unwrap();
        assert!(made > 500 && made < plan.steps() as u64);
        assert_eq!(board.rest().steps, plan.steps() + made as i64);
        assert_eq!(grbl.count(), Some(plan.steps() + made as i64));
    });
}

#[test]
fn a_board_that_sends_messages_and_no_report_is_out_of_reach_in_bounded_time() {
    let board = start(Options {
        chatters: true,
        defects: Defects { deaf: Some(700), ..Defects::default() },
        ..Options::default()
    });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 3.0, 5.0);
    let started = board.now();
    let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
    assert!(board.now() - started < Duration::from_secs(15), "{fault}");
    let made = board.rest().steps;
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {fault:?}");
}

#[test]
fn a_request_to_stop_ends_every_wait_at_rest() {
    each(talkative(), |options| {
        // The first answer is waited for.
        let silent = Options { defects: Defects { deaf: Some(0), ..Defects::default() }, ..options.clone() };
        // A motion that somebody else began is waited for.
        let moves =
            Options { defects: Defects { foreign: Some((0, 1000.0)), ..Defects::default() }, ..options };
        for options in [silent, moves] {
            let board = start(options);
            let asked = Duration::from_millis(700);
            let started = board.now();
            let opening = Opening { stop: stop_at(&board, asked), ..Opening::default() };
            let refused = board.open(&table(), &opening).unwrap_err();
            let waited = board.now() - started;
            assert!(matches!(refused, DriveError::Interrupted), "{refused}");
            assert!(waited < asked + ANSWERS, "{waited:?}");
        }
    });
}

#[test]
fn a_board_that_is_reset_again_and_again_is_out_of_reach_in_bounded_time() {
    for every_ms in [100, 500, 1_900] {
        let reboots = Some(Duration::from_millis(every_ms));
        let board = start(Options::default());
        board.meddle(|events| events.reboots = reboots);
        let refused = board.open(&table(), &Opening::default()).unwrap_err();
        assert!(board.now() < Duration::from_secs(20), "{every_ms} ms: {refused} after {:?}", board.now());

        let board = start(Options::default());
        let mut grbl = open(&board);
        let plan = dose(&grbl, 1.5, 5.0);
        board.meddle(|events| events.reboots = reboots);
        let started = board.now();
        assert!(grbl.check(&plan).is_err());
        let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
        assert!(board.now() - started < Duration::from_secs(15), "{every_ms} ms: {fault}");
        assert_eq!((fault.made_least, fault.made_most, board.truth().steps), (0, 0, 0));

        let board = start(Options::default());
        let mut grbl = open(&board);
        let plan = dose(&grbl, 5.0, 5.0);
        let mut begins = true;
        let fault = run_until(&mut grbl, &board, &plan, |made, _| {
            if made > 500 && std::mem::take(&mut begins) {
                board.meddle(|events| events.reboots = reboots);
            }
            false
        });
        let fault = fault.0.unwrap_err();
        let made = board.rest().steps;
        assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {fault:?}");
        assert!(board.now() - started < Duration::from_secs(30), "{every_ms} ms: {fault}");
    }
}

#[test]
fn a_request_to_stop_is_heard_while_a_line_is_not_acknowledged() {
    each(talkative(), |options| {
        for line in ["$$", "$I"] {
            let board = start(options.clone());
            board.meddle(|events| events.ignored = Some(line));
            let asked = Duration::from_secs(2);
            let opening = Opening { stop: stop_at(&board, asked), ..Opening::default() };
            let refused = board.open(&table(), &opening).unwrap_err();
            assert!(matches!(refused, DriveError::Interrupted), "{line}: {refused}");
            assert!((asked..asked + ANSWERS).contains(&board.now()), "{line}: {:?}", board.now());
        }
    });
}

#[test]
fn a_request_to_stop_is_heard_between_the_check_of_a_motion_and_its_first_step() {
    for searches in [false, true] {
        let board = start(Options::default());
        let asked = board.now() + Duration::from_secs(3);
        let opening = Opening { stop: stop_at(&board, asked), ..Opening::default() };
        let mut grbl = board.open(&table(), &opening).unwrap();
        let plan = dose(&grbl, 1.5, 5.0);
        grbl.check(&plan).unwrap();
        // Somebody else begins a long motion just now.
        board.send(b"$J=G91X100F100\n");
        board.pass(Duration::from_millis(50));
        let moved = if searches {
            grbl.seek(&plan, &mut |_, _| Leave::Go).unwrap().made
        } else {
            grbl.run(&plan, &mut |_, _| Leave::Go).unwrap()
        };
        assert_eq!(moved, 0);
        assert!((asked..asked + ANSWERS).contains(&board.now()), "{:?}", board.now());
    }
}

#[test]
fn a_request_to_stop_is_heard_while_a_search_asks_for_the_modes() {
    let board = start(Options::default());
    let asked = board.now() + Duration::from_secs(3);
    let opening = Opening { stop: stop_at(&board, asked), ..Opening::default() };
    let mut grbl = board.open(&table(), &opening).unwrap();
    let plan = dose(&grbl, 1.5, 5.0);
    board.meddle(|events| events.ignored = Some("$G"));
    assert_eq!(grbl.seek(&plan, &mut |_, _| Leave::Go).unwrap().made, 0);
    assert!((asked..asked + ANSWERS).contains(&board.now()), "{:?}", board.now());
    assert_eq!(board.rest().steps, 0);
}

#[test]
fn a_stop_in_motion_reaches_a_talkative_board_within_a_fifth_of_a_second() {
    each(talkative(), |options| {
        let board = start(options);
        let mut grbl = open(&board);
        let plan = dose(&grbl, 20.0, 5.0);
        let ask_at = board.now() + Duration::from_secs(1);
        let mut asked_at = None;
        run_until(&mut grbl, &board, &plan, |_, _| {
            let asks = board.now() >= ask_at;
            if asks {
                asked_at.get_or_insert(board.now());
            }
            asks
        })
        .0
        .unwrap();
        // The gate is asked at least as often as that, and the cancel follows.
        assert!(asked_at.unwrap() < ask_at + ANSWERS / 2, "{asked_at:?}");
        let cancelled = board.first_cancel().unwrap();
        assert!((ask_at..ask_at + ANSWERS).contains(&cancelled), "{cancelled:?}");
    });
}

#[test]
fn a_request_to_stop_ends_the_settling_of_a_dose_that_is_made() {
    let board = start(Options { auto_report: Some(Duration::from_millis(10)), ..Options::default() });
    let opening = Opening { stop: stop_at(&board, Duration::from_secs(2)), ..Opening::default() };
    let mut grbl = board.open(&table(), &opening).unwrap();
    let plan = dose(&grbl, 0.5, 5.0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
    let started = board.now();
    grbl.settle(20.0, &mut || ControlFlow::Continue(())).unwrap();
    assert!(board.now() < Duration::from_secs(2) + ANSWERS);
    assert!(board.now() > started);
    assert_eq!((grbl.disturbed(), grbl.count()), (None, Some(plan.steps())));
}
