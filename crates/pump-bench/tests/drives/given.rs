//! Claims about sessions that are given their drive.

use std::error::Error;
use std::fs;
use std::sync::Mutex;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, DriveLimits, Gate, Sim};
use pump_bench::report::Status;
use pump_bench::{Bench, DoseError, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

use super::servo::{Overload, Servo, bench, counting, go};

#[test]
fn a_session_goes_to_another_thread() {
    fn send<T: Send>() {}
    fn sync<T: Sync>() {}
    send::<Session<'_>>();
    send::<Box<dyn Drive>>();
    send::<Bench>();
    sync::<Bench>();
}

#[test]
fn a_given_drive_has_a_record_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let mut servo = Servo::default();
    let report = {
        let mut session = Session::with_drive(&bench, Box::new(&mut servo)).unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(0.2)).unwrap();
        let delivered = session.run(&prepared, go).unwrap();
        assert!(delivered.completed && session.bench() == &bench);
        DoseReport::new(session.bench(), &prepared, Some(&delivered))
    };
    assert_eq!((report.driver.as_str(), report.simulated, report.completed), ("servo", false, true));
    assert_eq!(servo.turned, report.steps);
    assert_eq!((bench.drive_id(), bench.headline()), ("servo", "MOVING three-roller".to_owned()));
    let journal = fs::read_to_string(folder.path().join("three-roller/servo/journal.jsonl")).unwrap();
    assert!(journal.contains("\"intent\"") && journal.contains("\"progress\""), "{journal}");
    assert!(!folder.path().join("three-roller/sim").exists(), "the record of the simulation stays untouched");
}

#[test]
fn a_given_motor_stands_at_an_unknown_angle_until_its_angle_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    assert!(!Status::of(&bench).unwrap().angle_known);
    let (session, set) =
        bench.set_angle_with_drive(Box::new(Servo::default()), Some(Phase::known(0.1))).unwrap();
    assert_eq!((session.state().unwrap().phase(), set.aside), (Phase::known(0.1), None));
}

#[test]
fn a_fault_of_a_given_drive_leaves_its_bounds_its_source_and_a_rest_to_resume() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let mut servo = Servo { fails_at: Some(200), ..Servo::default() };
    let mut session = Session::with_drive(&bench, Box::new(&mut servo)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
    let error = session.run(&prepared, go).unwrap_err();
    let device = error.source().and_then(|of_drive| of_drive.source());
    let overload = device.and_then(|cause| cause.downcast_ref::<Overload>());
    assert_eq!(overload, Some(&Overload { amperes: 7.5 }), "{error:?}");
    let DoseError::Drive { unfinished: true, .. } = error else { panic!("{error}") };
    let dose = session.state().unwrap().unfinished.unwrap();
    assert_eq!((dose.made_least, dose.made_most), (200, 210));
    drop(session);
    // The servo that failed is met anew by the session that still has it, and by the next one.
    servo.fails_at = None;
    let mut session = Session::with_drive(&bench, Box::new(&mut servo)).unwrap();
    assert!(matches!(session.prepare(DoseRequest::dose(0.5)), Err(DoseError::Unfinished { .. })));
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    assert!(session.run(&rest, go).unwrap().completed);
    assert!(session.state().unwrap().unfinished.is_none());
}

#[test]
fn a_given_drive_that_failed_is_met_anew_in_the_same_session() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let servo = Servo { fails_at: Some(200), ..Servo::default() };
    let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
    session.run(&prepared, go).unwrap_err();
    session.discard().unwrap();
    // So short a dose ends before the servo fails.
    let prepared = session.prepare(DoseRequest::dose(0.02)).unwrap();
    assert!(session.run(&prepared, go).unwrap().completed);
}

#[test]
fn limits_and_abilities_of_a_given_drive_hold_for_its_plans() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let limits = DriveLimits::new(2.0, 40.0).with_min_speed(0.5);
    let servo = Servo { limits: Some(limits), ..Servo::default() };
    let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let smooth = session.prepare(DoseRequest::dose(1.0).with_smooth(true)).unwrap_err();
    assert!(smooth.to_string().contains("the servo driver has no speed that follows"), "{smooth}");
    let prepared = session.prepare(DoseRequest::dose(5.0)).unwrap();
    assert_eq!(session.speed_range_rad_s(), (0.5, 2.0));
    assert_eq!(prepared.plan.profile().acceleration_rad_s2(), 40.0);
}

/// Runs a short dose of a servo that waits once before it makes the step after these. Returns the time that it took,
/// the time on record, in s, and the notes.
fn waited(waits_at: u64) -> (f64, f64, String) {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let servo = Servo { waits_at: Some(waits_at), ..Servo::default() };
    let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.1)).unwrap();
    let delivered = session.run(&prepared, go).unwrap();
    assert!(delivered.completed);
    let notes: Vec<String> = session.notes().iter().map(ToString::to_string).collect();
    let told: Vec<String> = delivered.warnings.iter().map(ToString::to_string).chain(notes).collect();
    (delivered.measured_s, session.state().unwrap().wear.motion_s, told.join("; "))
}

#[test]
fn a_motion_takes_the_time_from_its_begin_and_not_from_its_leave() {
    let (took_s, recorded_s, told) = waited(0);
    assert!(took_s < 1.0 && recorded_s < 1.0, "{took_s} s, {recorded_s} s on record");
    assert!(!told.contains("the motion took"), "{told}");
}

#[test]
fn a_late_motion_of_a_drive_without_ramps_of_its_own_blames_no_settings() {
    let (took_s, _, told) = waited(10);
    assert!(took_s > 1.4, "{took_s} s");
    assert!(told.contains("the motion took") && told.contains("or its line to the motor was late"), "{told}");
    assert!(!told.contains("settings"), "{told}");
}

#[test]
fn a_bench_takes_its_own_drive_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let plain = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let said = |bench: &Bench, drive: Servo| {
        Session::with_drive(bench, Box::new(drive)).map(drop).unwrap_err().to_string()
    };
    let other = said(&plain, Servo::default());
    assert!(other.contains("record of the drive `sim`") && other.contains("`servo`"), "{other}");
    // A motor that calls itself a simulation would spoil the record of the simulation.
    for name in ["sim", "grbl", "", "../sim", "Servo"] {
        let refused = plain.clone().driven_by(&Servo { name: Some(name), ..Servo::default() }).unwrap_err();
        assert!(refused.to_string().starts_with(&format!("the drive is named `{name}`")), "{refused}");
    }
    let given = bench(folder.path());
    let not_given = given.session().unwrap().connect().unwrap_err().to_string();
    assert!(not_given.contains("Session::with_drive"), "{not_given}");
    // The drive of a pump file may be given too.
    let model = built_in("three-roller").unwrap().model().unwrap();
    let mut session = Session::with_drive(&plain, Box::new(Sim::new(&model))).unwrap();
    session.connect().unwrap();
}

#[test]
fn a_drive_that_cannot_let_go_holds_on_and_keeps_the_angle() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let mut session = Session::with_drive(&bench, Box::new(Servo::default())).unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    for _ in 0..3 {
        let refused = session.release().unwrap_err().to_string();
        assert!(refused.contains("way to let go"), "{refused}");
    }
    let state = *session.state().unwrap();
    assert_eq!((state.phase(), state.disturbances, state.released), (Phase::known(0.3), 0, false));
}

#[test]
fn a_drive_that_lets_go_after_each_motion_knows_its_angle_less_well() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    for (lets_go, disturbances) in [(false, 0), (true, 1)] {
        let servo = Servo { lets_go, ..Servo::default() };
        let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
        assert!(session.run(&prepared, go).unwrap().completed);
        let state = session.state().unwrap();
        assert_eq!(state.disturbances, disturbances);
        assert_eq!(state.phase().half_width_rad() > 0.0, lets_go, "{state:?}");
    }
}

#[test]
fn a_count_that_changed_until_the_drive_was_connected_again_loses_the_angle() {
    for (strays, is_known) in [(0, true), (300, false)] {
        let folder = tempfile::tempdir().unwrap();
        let (bench, servo) = counting(folder.path());
        let servo = Servo { strays, fails_at: Some(200), ..servo };
        let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
        session.run(&prepared, go).unwrap_err();
        session.discard().unwrap();
        let pitch_rad = bench.model().pitch_rad();
        assert_eq!(session.state().unwrap().phase().is_known(pitch_rad), is_known);
        assert_eq!(
            session.notes().iter().any(|note| note.text().contains("something else has moved it")),
            !is_known
        );
    }
}

#[test]
fn a_note_of_the_meeting_names_no_way_to_an_angle_that_was_just_said() {
    for (said, remedies) in [(Some(Phase::known(0.3)), 0), (None, 1)] {
        let folder = tempfile::tempdir().unwrap();
        let (bench, servo) = counting(folder.path());
        let mut session = Session::with_drive(&bench, Box::new(servo)).unwrap();
        session.set_angle(Some(Phase::known(0.0))).unwrap();
        drop(session);
        let moved = Servo { counts: true, turned: 40, ..Servo::default() };
        let mut session = Session::with_drive(&bench, Box::new(moved)).unwrap();
        session.set_angle(said).unwrap();
        let notes = session.notes();
        let moved = notes.iter().find(|note| note.text().contains("something else has moved it")).unwrap();
        assert_eq!(moved.remedies().len(), remedies, "{said:?}");
    }
}

#[test]
fn a_drive_that_cannot_be_connected_is_kept() {
    /// Servo whose bus answers at the second time.
    #[derive(Debug)]
    struct Sleepy {
        servo: Servo,
        asked: u32,
    }

    impl Drive for Sleepy {
        fn id(&self) -> &str {
            self.servo.id()
        }

        fn abilities(&self) -> Abilities {
            self.servo.abilities()
        }

        fn connect(&mut self) -> Result<(), DriveError> {
            self.asked += 1;
            if self.asked < 2 { Err(DriveError::device(Overload { amperes: 0.1 })) } else { Ok(()) }
        }

        fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
            self.servo.run(plan, gate)
        }
    }

    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let sleepy = Sleepy { servo: Servo::default(), asked: 0 };
    let mut session = Session::with_drive(&bench, Box::new(sleepy)).unwrap();
    assert!(matches!(session.connect(), Err(DoseError::Connection(DriveError::Device(_)))));
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.1)).unwrap();
    assert!(session.run(&prepared, go).unwrap().completed);
}

#[test]
fn a_rotor_that_was_moved_while_it_rested_is_not_dosed_with() {
    use std::sync::Arc;

    /// Servo that another program has a hand on.
    #[derive(Debug)]
    struct Shared(Arc<Mutex<Servo>>);

    impl Drive for Shared {
        fn id(&self) -> &str {
            "servo"
        }

        fn abilities(&self) -> Abilities {
            self.0.lock().unwrap().abilities()
        }

        fn count(&self) -> Option<i64> {
            self.0.lock().unwrap().count()
        }

        fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
            self.0.lock().unwrap().run(plan, gate)
        }
    }

    let folder = tempfile::tempdir().unwrap();
    let (bench, servo) = counting(folder.path());
    let shared = Arc::new(Mutex::new(servo));
    let mut session = Session::with_drive(&bench, Box::new(Shared(Arc::clone(&shared)))).unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.1)).unwrap();
    shared.lock().unwrap().turned += 40;
    let stands = shared.lock().unwrap().turned;
    assert!(matches!(session.run(&prepared, go), Err(DoseError::Stale { .. })));
    assert_eq!(shared.lock().unwrap().turned, stands, "nothing moved");
    assert!(!session.state().unwrap().phase().is_known(bench.model().pitch_rad()));
    let again = session.prepare(DoseRequest::dose(0.1)).unwrap();
    assert!(session.run(&again, go).unwrap().completed);
}
