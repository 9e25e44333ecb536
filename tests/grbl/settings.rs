//! Claims about a board's settings: refusals, notes, and the settings that are written on request.

use pump_bench::drives::GrblError;
use pump_bench::drives::{Disturbance, Drive, Opening};
use pump_bench::notice::{Notice, Remedy};
use pump_bench::report::Explain;
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::Cruise;

use crate::rig::{defective, dose, each, grbl_error, motor, open, refusal, run, start, table, turn_at};
use crate::simulated::options::{Defects, Firmware, Options};
use crate::virtual_time::session::VirtualDrive;

fn with(settings: &[(u16, f32)]) -> Options {
    Options { settings: settings.to_vec(), ..Options::default() }
}

/// Leave to write the settings that do not fit.
fn configuring() -> Opening {
    Opening { configure: true, ..Opening::default() }
}

#[test]
fn limits_are_the_boards_own() {
    let board = start(with(&[(100, 200.0), (110, 3000.0), (120, 100.0)]));
    let limits = open(&board).limits().unwrap();
    let step_rad = std::f64::consts::TAU / 12_800.0;
    assert!((limits.max_speed_rad_s / step_rad - 10_000.0).abs() < 1e-6);
    assert!((limits.acceleration_rad_s2.unwrap() / step_rad - 20_000.0).abs() < 1e-6);
    assert!((limits.min_speed_rad_s / step_rad - 30.517_578_125).abs() < 1e-9);
}

#[test]
fn settings_that_cannot_dose_exactly_are_refused_with_what_to_do() {
    let coarse = grbl_error(refusal(with(&[(100, 900.0)])));
    assert!(matches!(coarse, GrblError::Coarse { .. }), "{coarse}");
    let inches = grbl_error(refusal(with(&[(100, 400.0), (13, 1.0)])));
    assert!(matches!(inches, GrblError::Coarse { .. }), "{inches}");
    let steep = refusal(with(&[(120, 100_000.0)]));
    assert_eq!(steep.remedies(), [Remedy::ConfigureOrRaise]);
    let steep = grbl_error(steep);
    assert!(matches!(steep, GrblError::Steep { .. }), "{steep}");
    let soft = refusal(with(&[(22, 0.0), (20, 1.0)]));
    assert_eq!(soft.remedies(), [Remedy::Configure]);
    assert!(matches!(grbl_error(soft), GrblError::SoftLimits));
}

#[test]
fn speeds_out_of_reach_are_refused_before_anything_moves() {
    let board = start(with(&[(110, 600.0)]));
    let mut grbl = open(&board);
    for (ml_s, slow) in [(0.01, true), (5.0, false)] {
        let plan = dose(&grbl, 1.0, ml_s);
        let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
        assert_eq!((fault.made_least, fault.made_most, fault.lost), (0, 0, false));
        let error = grbl_error(fault.error);
        assert!(matches!(&error, GrblError::Slow { .. }) == slow, "{error}");
        assert!(slow || matches!(error, GrblError::Fast { number: 110, .. }));
    }
    assert_eq!(board.truth().lines.iter().filter(|line| line.starts_with("$J")).count(), 0);
}

#[test]
fn a_dose_that_is_too_slow_for_the_board_is_advised_the_finer_microsteps_that_make_it() {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let bench = bench.driven_by(&drive).unwrap().confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    let slow = DoseRequest::dose(0.5).with_cruise(Some(Cruise::Flow { ml_s: 0.02 }));
    let error = session.prepare(slow).unwrap_err();
    let DoseError::TooSlow { speed_rpm, least_rpm, .. } = error else { panic!("{error}") };
    // The slowest head makes the fewest steps a second, so eight times the steps a revolution are an eighth of it.
    let of_steps = |steps_per_rev: u32| 60.0 * 30.517_578_125 / f64::from(steps_per_rev);
    assert!((least_rpm - of_steps(motor().steps_per_rev)).abs() < 1.1e-4, "{least_rpm}");
    assert!(of_steps(8 * motor().steps_per_rev) < speed_rpm && speed_rpm < least_rpm, "{speed_rpm}");
    let said = error.to_string();
    assert!(said.ends_with("ask for that rate or more, or use finer microsteps"), "{said}");
}

#[test]
fn grblhal_has_no_floor_of_thirty_steps_a_second() {
    let board = start(Options { firmware: Firmware::GrblHal, ..Options::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 0.002, 0.01);
    assert!(plan.profile().peak_rad_s() / plan.step_rad() < 30.0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
    assert_eq!(board.truth().steps, plan.steps());
}

#[test]
fn nothing_is_written_unless_it_is_asked_for() {
    let board = start(with(&[(1, 25.0), (10, 0.0)]));
    let mut grbl = open(&board);
    let plan = dose(&grbl, 0.4, 5.0);
    run(&mut grbl, &board, &plan).0.unwrap();
    let written = |line: &String| line.starts_with('$') && line.contains('=') && !line.starts_with("$J=");
    assert!(!board.truth().lines.iter().any(written), "{:?}", board.truth().lines);
    assert!(grbl.notes().iter().any(|note| note.remedies() == [Remedy::Configure]));
}

#[test]
fn a_board_that_cuts_the_current_disturbs_the_rotor_once_a_motion() {
    let board = start(with(&[(1, 25.0)]));
    let mut grbl = open(&board);
    for _ in 0..2 {
        let plan = dose(&grbl, 0.4, 5.0);
        run(&mut grbl, &board, &plan).0.unwrap();
        assert_eq!(grbl.disturbed(), Some(Disturbance::Disabled));
        assert_eq!(grbl.disturbed(), None);
    }
}

#[test]
fn configuring_writes_what_differs_and_says_what() {
    let board = start(with(&[(1, 25.0), (10, 2.0), (13, 1.0), (20, 1.0), (120, 100_000.0)]));
    let mut grbl = board.open(&table(), &configuring()).unwrap();
    let notes = grbl.notes();
    for number in ["$1 ", "$10 ", "$13 ", "$20 ", "$110 ", "$120 "] {
        assert!(notes.iter().any(|note| note.text().starts_with(number)), "{number}: {notes:?}");
    }
    assert!(grbl.limits().unwrap().acceleration_rad_s2.unwrap() <= motor().max_acceleration_rad_s2);
    let plan = dose(&grbl, 0.4, 5.0);
    assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
    assert_eq!(grbl.disturbed(), None);
    drop(grbl);
    let mut again = board.open(&table(), &configuring()).unwrap();
    assert!(
        !again.notes().iter().any(|note| note.text().contains(" was ")),
        "a second time there is nothing to write"
    );
    assert!(!board.truth().lines.iter().any(|line| line.starts_with("$100=")));
}

#[test]
fn a_setting_that_is_told_with_two_values_is_refused() {
    each([(100, 210.0), (110, 600.0), (120, 40.0), (1, 25.0), (13, 1.0)], |(number, value)| {
        let board = defective(Defects { misreads: Some((1, number, value)), ..Defects::default() });
        let error = grbl_error(board.open(&table(), &Opening::default()).unwrap_err());
        assert!(matches!(error, GrblError::Unsteady { number: told, .. } if told == number), "{error}");
    });
}

#[test]
fn settings_that_have_changed_since_the_last_time_are_refused_until_they_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let record = Some(folder.path().join("board-settings.json"));
    let usual = Opening { settings_record: record, ..Opening::default() };
    let accepting = Opening { accept_settings: true, ..usual.clone() };
    let configuring = Opening { configure: true, ..usual.clone() };
    let opened = |options: Options, opening: &Opening| {
        let board = start(options);
        board.open(&table(), opening).map(|mut grbl| grbl.notes())
    };
    opened(Options::default(), &usual).unwrap();
    opened(Options::default(), &usual).unwrap();
    for (number, value) in [(100, 210.0), (110, 600.0), (120, 40.0), (1, 25.0), (3, 1.0)] {
        let changed = || with(&[(number, value)]);
        let error = opened(changed(), &usual).unwrap_err();
        assert_eq!(error.remedies(), [Remedy::AcceptSettings]);
        let error = grbl_error(error);
        assert!(matches!(error, GrblError::SettingsChanged { .. }), "{error}");
        let said = error.to_string();
        assert!(said.contains("or another board is at this port: "), "{said}");
        assert!(
            said.contains(&format!("${number} was")) && said.contains(&format!("is {value} now")),
            "{said}"
        );
        let notes = opened(changed(), &accepting).unwrap();
        assert!(notes.iter().any(|note| note.text().starts_with(&format!("${number} was"))), "{notes:?}");
        opened(changed(), &usual).unwrap();
        opened(Options::default(), &accepting).unwrap();
    }
    // Settings of other axes, and those without a say in the way of the motor, may change.
    opened(with(&[(101, 80.0), (3, 2.0), (11, 0.02), (130, 300.0)]), &usual).unwrap();
    opened(with(&[(1, 25.0)]), &configuring).unwrap();
    assert!(opened(Options::default(), &usual).is_err(), "configured to other rates");
}

#[test]
fn a_damaged_record_of_settings_is_refused_and_written_anew_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board-settings.json");
    std::fs::write(&path, "{").unwrap();
    let board = start(Options::default());
    let usual = Opening { settings_record: Some(path), ..Opening::default() };
    let error = grbl_error(board.open(&table(), &usual).unwrap_err());
    assert!(matches!(error, GrblError::SettingsRecord { .. }), "{error}");
    let accepting = Opening { accept_settings: true, ..usual.clone() };
    board.open(&table(), &accepting).unwrap();
    board.open(&table(), &usual).unwrap();
}

#[test]
fn grbl_makes_thirty_thousand_steps_a_second_at_most_whatever_its_settings_say() {
    let fast = &[(110, 12_000.0)];
    let board = start(with(fast));
    let mut grbl = open(&board);
    let step_rad = std::f64::consts::TAU / 12_800.0;
    assert!((grbl.limits().unwrap().max_speed_rad_s / step_rad - 30_000.0).abs() < 1e-6);
    let plan = turn_at(&grbl, 36_000.0);
    let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
    assert!(matches!(grbl_error(fault.error), GrblError::FasterThanGrbl { .. }));
    assert_eq!(board.truth().steps, 0);
    let hal = start(Options { firmware: Firmware::GrblHal, ..with(fast) });
    assert!((open(&hal).limits().unwrap().max_speed_rad_s / step_rad - 50_000.0).abs() < 1e-6);
}

#[test]
fn a_setting_that_is_written_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let record = Some(folder.path().join("board-settings.json"));
    let usual = Opening { settings_record: record, ..Opening::default() };
    let configuring = Opening { configure: true, ..usual.clone() };
    let board = start(with(&[(1, 25.0)]));
    drop(board.open(&table(), &usual).unwrap());
    let notes = board.open(&table(), &configuring).unwrap().notes();
    let of_first = notes.iter().filter(|note| note.text().starts_with("$1 was"));
    assert_eq!(of_first.map(Notice::text).collect::<Vec<_>>(), ["$1 was 25 and is 255 now"], "{notes:?}");
}
