//! Claims about what is on record while a board moves, and while the line settles.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use pump_bench::notice::Remedy;
use pump_bench::report::Ending;
use pump_bench::{Bench, Delivered, DoseError, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase, PressureLimits};

use crate::rig::start;
use crate::simulated::options::{Defects, Options};
use crate::virtual_time::session::VirtualDrive;

/// Makes a bench with a drive in virtual time. A `soft` line settles for some 30 s.
fn bench(folder: &Path, drive: &VirtualDrive, soft: bool) -> Bench {
    let mut file = built_in("three-roller").unwrap();
    if soft {
        let line = pump_model::Line { compliance_ml_kpa: 30.0, ..pump_model::Line::PUBLISHED };
        file.outlet = line.into();
    }
    let bench = Bench::new(file, None, folder).unwrap();
    bench.driven_by(drive).unwrap().confirming_pump(true)
}

#[test]
fn the_rest_is_on_record_before_the_line_settles_and_the_wait_hears_a_stop() {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, true);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
    assert!(prepared.prediction.settle_s > 10.0, "{}", prepared.prediction.settle_s);
    let began = board.now();
    let mut recorded = None;
    let delivered = session.run(&prepared, |_| {
        let text = std::fs::read_to_string(bench.folder().path().join("journal.jsonl")).unwrap();
        if recorded.is_none() && text.contains(r#""why":"done""#) {
            recorded = Some(board.now());
        }
        // The user has seen enough half a second after the dose is on record.
        match recorded {
            Some(at) if board.now() > at + Duration::from_millis(500) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    let (delivered, took) = (delivered.unwrap(), board.now() - began);
    assert!(recorded.is_some(), "the wait never asked whether to go on");
    assert!(took < Duration::from_secs(6), "{took:?}");
    assert!(delivered.completed);
    assert!(session.state().unwrap().unfinished.is_none());
}

#[test]
fn a_reset_after_the_last_step_is_in_the_report_of_that_dose() {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, true);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
    let mut stands = None;
    let mut reset = false;
    let delivered = session.run(&prepared, |made| {
        if made == prepared.plan.steps().unsigned_abs() && !board.truth().moving {
            let since = board.now() - *stands.get_or_insert(board.now());
            if since > Duration::from_millis(300) && !reset {
                board.send(&[0x18]);
                reset = true;
            }
            if since > Duration::from_secs(1) {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    });
    let report = DoseReport::new(&bench, &prepared, Some(&delivered.unwrap()));
    assert!(reset, "the wait never asked whether to go on");
    assert!(
        report.warnings.iter().any(|warning| warning.text().contains("the device was reset")),
        "{report:?}"
    );
    assert_eq!(session.state().unwrap().disturbances, 1);
}

/// Result of a dose with a slow disk.
struct Slowly {
    delivered: Result<Delivered, DoseError>,
    report: Option<DoseReport>,
    /// Number of times that the motor set out from rest.
    starts: u64,
}

/// Makes a dose of some 2.4 s while each sync takes so long, on the computer's clock too if it `is_real`. No step may
/// be made before it is on disk.
fn dose_slowly(takes: Duration, request: DoseRequest, is_real: bool) -> Slowly {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, false);
    let (disk, announced) = drive.disk(takes, bench.folder().path().join("journal.jsonl"));
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    session.connect().unwrap();
    let prepared = session.prepare(request).unwrap();
    session.store_by(Box::new(if is_real { disk.really() } else { disk }));
    let delivered = session.run(&prepared, |_| {
        let (turned, allowed) = (board.truth().steps.unsigned_abs(), announced.load(Ordering::SeqCst));
        assert!(turned <= allowed, "{turned} steps made and {allowed} announced");
        ControlFlow::Continue(())
    });
    let truth = board.rest();
    let state = session.state().unwrap();
    let made = state.unfinished.map_or(prepared.plan.steps().abs(), |dose| dose.made_least);
    assert_eq!(truth.steps.abs(), made);
    assert!(state.unfinished.is_none_or(|dose| dose.made_most == made));
    let report = delivered.as_ref().ok().map(|delivered| DoseReport::new(&bench, &prepared, Some(delivered)));
    Slowly { delivered, report, starts: truth.starts }
}

#[test]
fn a_disk_that_takes_up_to_300_ms_costs_a_dose_no_pause() {
    for ms in [0, 100, 200, 300] {
        let Slowly { report, starts, .. } =
            dose_slowly(Duration::from_millis(ms), DoseRequest::dose(11.0), false);
        let report = report.unwrap();
        assert_eq!((starts, report.completed), (1, true), "{ms} ms");
        assert!(
            !report.warnings.iter().any(|warning| warning.text().contains("disk")),
            "{ms} ms: {:?}",
            report.warnings
        );
        // The board tells its position every 50 ms.
        let late_s = report.measured_motion_s.unwrap() - report.motion_s;
        assert!(late_s.abs() < 0.1, "{ms} ms: {late_s} s late");
    }
}

#[test]
fn a_disk_that_takes_a_second_makes_the_motor_pause_and_the_report_names_it() {
    let Slowly { report, starts, .. } = dose_slowly(Duration::from_secs(1), DoseRequest::dose(11.0), true);
    let report = report.unwrap();
    assert!(starts > 1 && report.completed, "{starts} starts");
    assert!(report.measured_motion_s.unwrap() > 1.02 * report.motion_s);
    let warning = report.warnings.last().unwrap();
    for word in ["paused", "journal.jsonl"] {
        assert!(warning.text().contains(word), "{word}: {warning}");
    }
    let took = warning.text().split_once("the disk took up to ").unwrap().1;
    let took_s: f64 = took.split_once(' ').unwrap().0.parse().unwrap();
    assert!(took_s >= 1.0, "{warning}");
    assert_eq!(warning.remedies(), [Remedy::FasterDisk]);
}

#[test]
fn a_dose_within_a_time_or_limits_ends_where_a_slow_disk_would_have_it_pause() {
    let within = DoseRequest::dose(11.0).with_cruise(Cruise::Within { time_s: 3.0 });
    let pressures = PressureLimits { max_outlet_kpa: Some(150.0), min_inlet_kpa: None };
    for request in [within, DoseRequest::dose(11.0).with_pressures(pressures)] {
        let Slowly { delivered, starts, .. } = dose_slowly(Duration::from_secs(1), request, false);
        let error = delivered.unwrap_err();
        assert_eq!((starts, error.ending()), (1, Ending::Moved));
        assert!(matches!(error, DoseError::SlowDisk { must_not_pause: true, .. }), "{error}");
        let text = error.to_string();
        for word in ["a dose in a given time", "with pressure limits", "journal.jsonl"] {
            assert!(text.contains(word), "{word}: {text}");
        }
        // The disk is fast enough for the same dose.
        assert!(dose_slowly(Duration::from_millis(100), request, false).delivered.unwrap().completed);
    }
}

/// Makes a dose with a motor that is slower by this part than its settings say. Returns the warnings of its lateness,
/// and the time of its plan.
fn warned_of_lateness(request: DoseRequest, slower: f64) -> (Vec<String>, f64) {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, false);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(request).unwrap();
    board.meddle(|events| events.slower = slower);
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let texts = delivered.warnings.iter().map(|warning| warning.text().to_owned());
    (texts.filter(|text| text.contains("by its plan")).collect(), prepared.plan.profile().duration_s())
}

#[test]
fn a_dose_is_late_beyond_two_percent_and_beyond_the_tenth_of_a_second_that_can_be_measured() {
    let slow = DoseRequest::dose(110.0).with_cruise(Cruise::Flow { ml_s: 1.0 });
    let (none, planned_s) = warned_of_lateness(slow, 0.017);
    assert!((100.0..130.0).contains(&planned_s), "{planned_s}");
    assert_eq!(none, Vec::<String>::new());
    assert_eq!(warned_of_lateness(slow, 0.023).0.len(), 1);
    let short = DoseRequest::dose(11.0);
    let (none, planned_s) = warned_of_lateness(short, 0.01);
    assert!((1.5..3.0).contains(&planned_s), "{planned_s}");
    assert_eq!(none, Vec::<String>::new());
    assert_eq!(warned_of_lateness(short, 0.1).0.len(), 1);
}

#[test]
fn a_dose_within_a_time_that_a_slow_motor_does_not_keep_says_so() {
    let within = DoseRequest::dose(11.0).with_cruise(Cruise::Within { time_s: 3.0 });
    let (warnings, _) = warned_of_lateness(within, 0.5);
    assert!(
        warnings[0].contains("the 3 s that the dose was to be done within were not kept"),
        "{warnings:?}"
    );
}

/// Runs a dose of 11 mL to its fault, while each sync takes `takes` and the drive does not get to run for `stall` after
/// the first 1,000 steps. Returns the disturbances on record, true if the angle is known, and the starts of the motor.
fn fault_after_pauses(options: &Options, takes: Duration, stall: Duration) -> (u64, bool, u64) {
    let folder = tempfile::tempdir().unwrap();
    let board = start(options.clone());
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, false);
    let (disk, _) = drive.disk(takes, bench.folder().path().join("journal.jsonl"));
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(11.0)).unwrap();
    session.store_by(Box::new(disk));
    let mut stalls = Some(stall);
    let watch = |made| {
        if made > 1_000 {
            board.meddle(|events| events.stalls[0] += stalls.take().unwrap_or_default());
        }
        ControlFlow::Continue(())
    };
    session.run(&prepared, watch).unwrap_err();
    let (state, starts) = (session.state().unwrap(), board.rest().starts);
    (u64::from(state.disturbances), state.phase().is_known(bench.model().pitch_rad()), starts)
}

#[test]
fn a_fault_after_pauses_counts_each_rest_of_a_motor_that_its_board_lets_go() {
    let reset = Defects { resets: Some(5_000), ..Defects::default() };
    let refused = Defects { refuses: Some((25, 15)), ..Defects::default() };
    // The disk is late, or this program.
    let late =
        [(1_000, 0), (0, 700), (1_000, 700)].map(|case| <[u64; 2]>::from(case).map(Duration::from_millis));
    for (defects, is_reset) in [(reset, true), (refused, false)] {
        for [takes, stall] in late {
            let settings = |idle_ms| vec![(1, idle_ms)];
            let holds = Options { settings: settings(255.0), defects: defects.clone(), ..Options::default() };
            let (disturbances, is_known, starts) = fault_after_pauses(&holds, takes, stall);
            assert!(starts > 1, "the motor never paused");
            assert_eq!((disturbances, is_known), (u64::from(is_reset), true), "{takes:?} {stall:?}");
            let lets_go = Options { settings: settings(25.0), ..holds };
            let (disturbances, is_known, starts) = fault_after_pauses(&lets_go, takes, stall);
            assert!(starts > 1, "the motor never paused");
            assert!(disturbances >= starts && !is_known, "{takes:?} {stall:?}: {disturbances} of {starts}");
        }
    }
}

#[test]
fn a_board_that_turns_slower_than_its_settings_say_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options { time_scale: 0.5, ..Options::default() });
    let mut drive = VirtualDrive::new(&board);
    let bench = bench(folder.path(), &drive, false);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(3.0)).unwrap();
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let warning = delivered.warnings.last().unwrap();
    assert!(warning.text().contains("the board was slower"), "{warning}");
    assert!((delivered.measured_s / prepared.plan.profile().duration_s() - 2.0).abs() < 0.4, "{warning}");
}
