//! Claims about sessions that are given their drive.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, DriveLimits, Gate, Leave, Sim};
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::report::Status;
use pump_bench::{Bench, DoseError, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

/// Error of the servo's own protocol.
#[derive(Debug, PartialEq)]
struct Overload {
    amperes: f64,
}

impl Display for Overload {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        write!(to, "the servo draws {} A", self.amperes)
    }
}

impl Error for Overload {}

/// Servo of another program. It makes ten steps at a time.
#[derive(Debug, Default)]
struct Servo {
    name: Option<&'static str>,
    /// Step at which the servo fails.
    fails_at: Option<u64>,
    /// Net steps made so far.
    turned: i64,
    limits: Option<DriveLimits>,
    /// Steps before which the servo waits for 1.5 s.
    waits_at: Option<u64>,
    /// True if the servo holds only while it moves.
    lets_go: bool,
    /// True if the servo tells its count.
    counts: bool,
    /// Steps by which the servo is found elsewhere once it is connected again.
    strays: i64,
    /// True once the servo was connected.
    is_connected: bool,
    /// Times that the servo was let go, if it can be.
    released: Option<u32>,
}

impl Drive for Servo {
    fn id(&self) -> &str {
        self.name.unwrap_or("servo")
    }

    fn abilities(&self) -> Abilities {
        Abilities::new()
            .with_step_times(true)
            .with_readback(self.counts)
            .with_release(self.released.is_some())
    }

    fn connect(&mut self) -> Result<(), DriveError> {
        if std::mem::replace(&mut self.is_connected, true) {
            self.turned += self.strays;
        }
        Ok(())
    }

    fn count(&self) -> Option<i64> {
        self.counts.then_some(self.turned)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        self.released = self.released.map(|times| times + 1);
        Ok(())
    }

    fn limits(&self) -> Option<DriveLimits> {
        self.limits
    }

    fn holds_at_rest(&self) -> bool {
        !self.lets_go
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let (all, sign) = (plan.each_step().count() as u64, i64::from(plan.direction().sign()));
        let mut made = 0;
        while made < all {
            if self.fails_at.is_some_and(|fails_at| made >= fails_at) {
                let error = DriveError::device(Overload { amperes: 7.5 });
                return Err(DriveFault::between(made as i64, made as i64 + 10, error));
            }
            let next = (made + 10).min(all);
            match gate(made, next) {
                Leave::Go => {
                    if self.waits_at == Some(made) {
                        std::thread::sleep(Duration::from_millis(1500));
                    }
                    self.turned += sign * (next - made) as i64;
                    made = next;
                }
                Leave::Wait => {}
                Leave::Stop => break,
            }
        }
        Ok(made)
    }
}

fn go(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn bench(folder: &Path) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    bench.driven_by(&Servo::default()).unwrap().confirming_pump(true)
}

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

/// Bench of a servo that tells its count.
fn counting(folder: &Path) -> (Bench, Servo) {
    let servo = Servo { counts: true, turned: 7, ..Servo::default() };
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    (bench.driven_by(&servo).unwrap().confirming_pump(true), servo)
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

/// The drive `sim`, which fails in its first motion.
#[derive(Debug)]
struct FailsOnce<'a> {
    sim: Sim<'a>,
    /// Motions that were begun.
    motions: &'a Mutex<u32>,
}

impl Drive for FailsOnce<'_> {
    fn id(&self) -> &str {
        self.sim.id()
    }

    fn is_simulated(&self) -> bool {
        self.sim.is_simulated()
    }

    fn abilities(&self) -> Abilities {
        self.sim.abilities()
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        *self.motions.lock().unwrap() += 1;
        if *self.motions.lock().unwrap() == 1 {
            return Err(DriveFault::at(0, DriveError::device(Overload { amperes: 7.5 })));
        }
        self.sim.run(plan, gate)
    }
}

#[test]
fn a_session_that_was_given_the_drive_of_a_pump_file_goes_on_with_it_after_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let plain = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let model = built_in("three-roller").unwrap().model().unwrap();
    let motions = Mutex::new(0);
    let drive = FailsOnce { sim: Sim::new(&model), motions: &motions };
    let mut session = Session::with_drive(&plain, Box::new(drive)).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
    session.run(&prepared, go).unwrap_err();
    session.discard().unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
    assert!(session.run(&prepared, go).unwrap().completed);
    assert_eq!(*motions.lock().unwrap(), 2, "the drive that was given has moved");
}

#[test]
fn a_motor_whose_drive_failed_is_not_let_go_of_until_it_was_met_anew() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = built_in("three-roller").unwrap();
    file.drive = Some(DriveTable::of(DriverName::Sim).with_hold_timeout_s(0.0));
    file.motor.confirmed = None;
    let mut servo = Servo { released: Some(0), fails_at: Some(200), ..Servo::default() };
    let bench = Bench::new(file, None, folder.path()).unwrap().driven_by(&servo).unwrap();
    {
        let mut session = Session::with_drive(&bench, Box::new(&mut servo)).unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
        session.run(&prepared, go).unwrap_err();
        let failed = *session.state().unwrap();
        session.release_when_due().unwrap();
        assert_eq!(*session.state().unwrap(), failed, "the record still says that the motor holds");
        // Once it was met anew, the release is on record before the motor is let go of.
        session.connect().unwrap();
        session.release_when_due().unwrap();
        let state = session.state().unwrap();
        assert!(state.released && state.unfinished.is_some() && state.half_width_rad > failed.half_width_rad);
    }
    assert_eq!(servo.released, Some(1));
}
