//! Doses by a bench, with its journal: finished, killed and resumed.

use std::fs;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pump_bench::drives::{Drive, Node, Opening};
use pump_bench::pump_file::{DriverFault, PinsTable};
use pump_bench::record::{LogEnd, LogEntry, LogLine};
use pump_bench::report::Status;
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase, PlanError};

use crate::rig::Rig;
use crate::world::{Event, Hardware};

fn request() -> DoseRequest {
    DoseRequest::dose(4.0).with_cruise(Some(Cruise::Flow { ml_s: 4.0 })).with_smooth(true)
}

fn bench(folder: &std::path::Path, drive: &Node) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    bench.driven_by(drive).unwrap().confirming_pump(true)
}

#[test]
fn a_dose_that_was_killed_is_counted_to_the_step_and_resumed() {
    let rig = Rig::new();
    let folder = tempfile::tempdir().unwrap();
    let mut drive = rig.open();
    let bench = bench(folder.path(), &drive);
    let killed = catch_unwind(AssertUnwindSafe(|| {
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        session.set_angle(Some(Phase::known(0.0))).unwrap();
        let prepared = session.prepare(request()).unwrap();
        session.run(&prepared, |made| {
            assert!(made < 800, "killed");
            ControlFlow::Continue(())
        })
    }));
    assert!(killed.is_err());
    drop(drive);
    // The board heard no more of the process that was killed, and stopped.
    rig.world.pass(1500);
    let count = rig.world.count();
    assert!(count >= 800);
    // By the record alone the angle is unknown, and the board is asked before the rest.
    let planned = bench.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    let told = |text: &str| planned.warnings.iter().any(|warning| warning.text().contains(text));
    assert!(
        planned.plan.is_smooth() && told("first asks the board") && told("after a reset the rest is refused")
    );
    let mut drive = rig.open();
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    let part = session.state().unwrap().unfinished.unwrap();
    assert_eq!((part.made_least, part.made_most), (count, count));
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    assert!(session.run(&rest, |_| ControlFlow::Continue(())).unwrap().completed);
    assert_eq!(rig.world.count(), count + rest.plan.steps());
    assert!(session.state().unwrap().unfinished.is_none());
}

/// Returns the dose in the log.
fn logged(bench: &Bench) -> LogEntry {
    match bench.log().unwrap().next().unwrap().unwrap() {
        LogLine::Dose(entry) => entry,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_part_that_a_killed_process_made_is_logged_as_sure_as_one_that_was_stopped() {
    for request in [request(), DoseRequest::dose(40.0)] {
        let rig = Rig::new();
        let folder = tempfile::tempdir().unwrap();
        let mut drive = rig.open();
        let bench = bench(folder.path(), &drive);
        {
            let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
            session.connect().unwrap();
            session.set_angle(Some(Phase::known(0.0))).unwrap();
            let prepared = session.prepare(request).unwrap();
            let stop = |made| if made < 800 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
            assert!(!session.run(&prepared, stop).unwrap().completed);
        }
        let stopped = logged(&bench);
        assert_eq!(stopped.end, LogEnd::Stopped);
        // A process that was killed leaves no rest and no entry, and the board still has the count.
        let journal = bench.folder().path().join("journal.jsonl");
        let text = fs::read_to_string(&journal).unwrap();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let announced = lines.iter().rposition(|line| line.contains("\"progress\"")).unwrap();
        fs::write(&journal, lines[..=announced].concat()).unwrap();
        fs::remove_file(bench.folder().path().join("log.jsonl")).unwrap();
        drop(drive);
        let mut drive = rig.open();
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        session.discard().unwrap();
        let killed = logged(&bench);
        assert_eq!((killed.end, killed.steps), (LogEnd::CutOff, stopped.steps));
        assert!((killed.delivered_ml - stopped.delivered_ml).abs() < 1e-9, "{killed:?}");
        let [killed_ml, stopped_ml] = [killed, stopped].map(|dose| dose.expanded_uncertainty_ml.unwrap());
        assert!((killed_ml - stopped_ml).abs() < 1e-9, "{killed_ml} {stopped_ml}");
    }
}

#[test]
fn a_board_that_was_out_of_reach_tells_its_steps_to_the_log_and_one_that_was_reset_promises_none() {
    for (event, tells) in [(Event::Cut, true), (Event::Reset, false)] {
        let rig = Rig::new();
        let folder = tempfile::tempdir().unwrap();
        let mut drive = rig.open();
        let bench = bench(folder.path(), &drive);
        {
            let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
            session.connect().unwrap();
            session.set_angle(Some(Phase::known(0.0))).unwrap();
            let prepared = session.prepare(request()).unwrap();
            rig.world.plan(700, event);
            session.run(&prepared, |_| ControlFlow::Continue(())).unwrap_err();
        }
        drop(drive);
        let first = logged(&bench);
        assert!(first.end == LogEnd::Fault && first.delivered_range_ml.is_some(), "{first:?}");
        let told = |text: &str| {
            let status = Status::of(&bench).unwrap();
            status.text(|_| "").contains(text)
        };
        assert_eq!(told("a board that was not reset since knows the exact steps"), tells);
        assert!(told(&format!("; ended by a fault ({})", first.cause.as_deref().unwrap())), "{first:?}");
        // A reset is on record with its fault, and the next meeting counts it no more.
        let disturbances = u8::from(!tells);
        assert_eq!(Status::of(&bench).unwrap().disturbances, disturbances);
        // By the record of a reset board the angle is unknown, and no plan pretends that the board knows better.
        let planned = bench.prepare_rest(DoseRequest::dose(0.0));
        assert_eq!(planned.is_ok(), tells, "{planned:?}");
        rig.world.pass(1500);
        rig.world.plan(0, Event::Mend);
        rig.world.pass(10);
        let mut drive = rig.open();
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        assert_eq!(session.state().unwrap().disturbances, disturbances);
        let now = logged(&bench);
        assert_eq!((now.end, now.number, &now.cause), (LogEnd::Fault, first.number, &first.cause));
        if !tells {
            assert_eq!(now, first);
            continue;
        }
        let (least_ml, most_ml) = first.delivered_range_ml.unwrap();
        assert_eq!((now.steps, now.delivered_range_ml), (Some(rig.world.count()), None));
        assert!((least_ml..=most_ml).contains(&now.delivered_ml), "{now:?}");
        assert_eq!(bench.delivered_since(0, 0).unwrap(), (now.delivered_ml, now.delivered_ml));
        // A log that lacks the second entry, or both, is mended to the last byte.
        let log = bench.folder().path().join("log.jsonl");
        let whole = fs::read_to_string(&log).unwrap();
        drop(session);
        for kept in 0..2 {
            let part: String = whole.split_inclusive('\n').take(kept).collect();
            fs::write(&log, part).unwrap();
            assert_eq!(logged(&bench), now);
            drop(bench.session().unwrap());
            assert_eq!(fs::read_to_string(&log).unwrap(), whole);
        }
        // The rest has the next number.
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
        assert!(session.run(&rest, |_| ControlFlow::Continue(())).unwrap().completed);
        let numbers: Vec<_> = bench.log().unwrap().map(|line| line.unwrap()).collect();
        assert!(matches!(numbers[..], [LogLine::Dose(_), LogLine::Dose(ref dose)] if dose.number == 2));
    }
}

#[test]
fn an_angle_that_one_reset_makes_unknown_was_not_disturbed_twice() {
    let (rig, folder) = (Rig::new(), tempfile::tempdir().unwrap());
    let mut drive = rig.open();
    let bench = bench(folder.path(), &drive);
    {
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        // The pitch is 120 deg, and two full steps are 3.6 deg.
        session.set_angle(Some(Phase::within(0.0, 58_f64.to_radians()))).unwrap();
    }
    drop(drive);
    rig.world.plan(0, Event::Reset);
    rig.world.pass(10);
    let mut drive = rig.open();
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    assert_eq!(session.state().unwrap().disturbances, 1);
    let notes = session.notes();
    let said = |text: &str| notes.iter().any(|note| note.text().contains(text));
    assert!(said("two full steps of the motor more") && !said("second time"), "{notes:?}");
}

#[test]
fn a_fault_that_stays_is_one_disturbance_and_an_emergency_stop_at_rest_makes_the_angle_unknown() {
    let (rig, folder) = (Rig::new(), tempfile::tempdir().unwrap());
    let mut pins = PinsTable::default();
    pins.driver_fault = Some(DriverFault::Low);
    let open = || rig.open_by(&Rig::table().with_pins(pins), &rig.opening()).unwrap();
    let bench = bench(folder.path(), &open());
    let hand = |change: fn(&mut Hardware)| {
        rig.world.hardware(change);
        rig.world.pass(10);
    };
    let set = |angle_rad| {
        let mut session = Session::with_drive(&bench, Box::new(open())).unwrap();
        session.connect().unwrap();
        session.set_angle(Some(Phase::known(angle_rad))).unwrap();
    };
    // Each command opens the drive anew.
    let dose = |smooth| {
        let mut session = Session::with_drive(&bench, Box::new(open())).unwrap();
        session.connect().unwrap();
        rig.world.pass(10);
        let request = DoseRequest::dose(1.0).with_smooth(smooth);
        let made =
            session.prepare(request).and_then(|plan| session.run(&plan, |_| ControlFlow::Continue(())));
        let state = *session.state().unwrap();
        (made, state, session.notes())
    };
    set(0.0);
    hand(|hardware| hardware.has_driver_fault = true);
    for _ in 0..3 {
        let (made, state, _) = dose(false);
        let said = pump_bench::report::with_sources(&made.unwrap_err());
        assert!(said.contains("the stepper driver reported a fault"), "{said}");
        assert_eq!((state.disturbances, state.unfinished), (1, None));
        assert!(state.half_width_rad > 0.0 && state.half_width_rad < 0.1, "{state:?}");
    }
    hand(|hardware| hardware.has_driver_fault = false);
    let (made, state, _) = dose(true);
    assert!(made.unwrap().completed && state.disturbances == 1);
    // The stop is released before the next command, which says it before anything moves.
    set(0.0);
    hand(|hardware| hardware.estop = true);
    hand(|hardware| hardware.estop = false);
    let (made, state, notes) = dose(true);
    assert!(matches!(made, Err(DoseError::Plan(PlanError::SmoothWithoutAngle { .. }))), "{made:?}");
    assert!(
        state.half_width_rad > 3.0 && notes.iter().any(|note| note.text().contains("emergency stop was"))
    );
    set(0.0);
    assert!(dose(true).0.unwrap().completed);
}

#[test]
fn a_stop_that_a_refused_command_has_seen_is_kept_and_one_that_a_dose_has_told_is_not_told_again() {
    let rig = Rig::new();
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), &rig.open());
    let press = |is_pressed: bool| {
        rig.world.hardware(|hardware| hardware.estop = is_pressed);
        rig.world.pass(10);
    };
    let home = || {
        let mut drive = rig.open();
        Session::with_drive(&bench, Box::new(&mut drive))
            .unwrap()
            .set_angle(Some(Phase::known(0.5)))
            .unwrap();
    };
    let is_known = || Status::of(&bench).unwrap().angle_known;
    home();
    let mut drive = rig.open();
    press(true);
    drive.check(&crate::rig::dose(0.2, 1.0, false)).unwrap_err();
    assert!(drive.disturbed().is_some(), "a drive that a command opens anew has not seen it");
    Session::with_drive(&bench, Box::new(&mut drive)).unwrap().connect().unwrap_err();
    drop(drive);
    assert!(!is_known(), "the refused command has seen the stop");
    press(false);
    rig.world.plan(0, Event::Reset);
    rig.world.pass(10);
    let mut drive = rig.open();
    {
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        assert!(!is_known(), "the board has forgotten it");
    }
    // A stop in motion is told by the dose.
    home();
    {
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        let prepared = session.prepare(request()).unwrap();
        rig.world.plan(700, Event::Estop);
        session.run(&prepared, |_| ControlFlow::Continue(())).unwrap_err();
    }
    drop(drive);
    press(false);
    let mut drive = rig.open();
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    let notes = session.notes();
    assert!(!notes.iter().any(|note| note.text().contains("counted faults")), "{notes:?}");
    assert!(session.state().unwrap().unfinished.is_some() && !is_known());
}

#[test]
fn a_board_that_another_program_has_had_tells_no_angle_and_one_that_was_reset_tells_it_less_well() {
    for (is_taken, is_known) in [(true, false), (false, true)] {
        let rig = Rig::new();
        let folder = tempfile::tempdir().unwrap();
        let mut drive = rig.open();
        let bench = bench(folder.path(), &drive);
        {
            let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
            session.connect().unwrap();
            session.set_angle(Some(Phase::known(0.0))).unwrap();
            let prepared = session.prepare(request()).unwrap();
            session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        }
        drop(drive);
        if is_taken {
            let elsewhere = tempfile::tempdir().unwrap();
            let record = Some(elsewhere.path().join("board-settings.json"));
            let opening = Opening { settings_record: record, ..rig.opening() };
            let mut other = rig.open_by(&Rig::table(), &opening).unwrap();
            crate::rig::run(&mut other, &crate::rig::dose(0.5, 2.0, false));
        } else {
            rig.world.plan(0, Event::Reset);
            rig.world.pass(10);
        }
        let mut drive = rig.open();
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        let notes = session.notes();
        let told = if is_taken { "another program has had the board" } else { "the device was reset" };
        assert!(notes.iter().any(|note| note.text().contains(told)), "{notes:?}");
        assert_eq!(Status::of(&bench).unwrap().angle_known, is_known);
    }
}
