//! Claims about sessions whose drive failed and is met anew.

use std::sync::Mutex;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, Gate, Sim};
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::{Bench, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

use super::servo::{Overload, Servo, go};

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
