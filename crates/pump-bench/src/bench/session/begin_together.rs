//! Tests of sessions whose motions begin at one instant, with motors that fail before it and after it.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use pump_ctl::plan::Plan;

use crate::drives::{
    Abilities, BeginPlace, CommonBegin, Drive, DriveError, DriveFault, Gate, Leave, Met, Together,
};
use crate::record::PumpState;
use crate::{Bench, DoseError, DoseRequest, Session, built_in};

/// Motor that begins with others. It fails before its first step: while it waits, once the instant was chosen, or not.
#[derive(Debug)]
struct Motor {
    fails: Option<Fails>,
    place: Option<BeginPlace>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Fails {
    Waiting,
    Told,
    /// It is stopped before its first step.
    Stopped,
}

impl Motor {
    fn new(fails: Option<Fails>) -> Self {
        Self { fails, place: None }
    }
}

impl Drive for Motor {
    fn id(&self) -> &'static str {
        "motor"
    }

    fn abilities(&self) -> Abilities {
        Abilities::new().with_together(Together::Begin)
    }

    fn begin_with(&mut self, place: BeginPlace) -> Result<(), DriveError> {
        self.place = Some(place);
        Ok(())
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let failed = || DriveFault::at(0, DriveError::device(io::Error::from(io::ErrorKind::BrokenPipe)));
        let mut place = self.place.take().unwrap();
        // The other waits for this one.
        if self.fails == Some(Fails::Waiting) {
            return Err(failed());
        }
        loop {
            match place.meet(Instant::now(), Duration::ZERO) {
                Met::Waits => thread::sleep(Duration::from_millis(1)),
                Met::Failed(error) => return Err(DriveFault::at(0, DriveError::device(error))),
                Met::At(_) if self.fails == Some(Fails::Told) => return Err(failed()),
                Met::At(_) if self.fails == Some(Fails::Stopped) => return Ok(0),
                Met::At(_) => break,
            }
        }
        for step in plan.each_step() {
            while gate(step.number - 1, step.number) != Leave::Go {}
        }
        Ok(plan.steps().unsigned_abs())
    }
}

/// Doses 0.5 mL with a motor that begins with others. Returns the state after it, and the error.
fn doses(
    folder: &Path,
    fails: Option<Fails>,
    place: BeginPlace,
) -> (Option<PumpState>, Result<(), DoseError>) {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    let bench = bench.driven_by(&Motor::new(fails)).unwrap().confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(Motor::new(fails))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
    session.begin_with(place).unwrap();
    let ran = session.run(&prepared, |_steps| ControlFlow::Continue(()));
    (session.state().copied(), ran.map(drop))
}

/// Doses with two motors that begin together, of which the second fails. Returns the end of both.
fn both(fails: Fails) -> [(Option<PumpState>, Result<(), DoseError>); 2] {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let mut places = CommonBegin::places_of_boards(2, Duration::from_secs(10)).into_iter();
    thread::scope(|scope| {
        let mut begin = |folder: &tempfile::TempDir, fails| {
            let (folder, place) = (folder.path().to_owned(), places.next().unwrap());
            scope.spawn(move || doses(&folder, fails, place))
        };
        let [one, other] = [begin(&folders[0], None), begin(&folders[1], Some(fails))];
        [one.join().unwrap(), other.join().unwrap()]
    })
}

#[test]
fn a_motor_that_fails_once_the_others_were_told_to_begin_leaves_its_dose_unfinished() {
    let [(whole, made), (state, failed)] = both(Fails::Told);
    made.unwrap();
    assert_eq!(whole.unwrap().unfinished, None);
    let dose = state.unwrap().unfinished.unwrap();
    assert_eq!((dose.made_least, dose.made_most), (0, 0), "it made no step of what the other made all of");
    assert!(matches!(failed, Err(DoseError::Drive { unfinished: true, .. })), "{failed:?}");
}

#[test]
fn a_motor_that_is_stopped_once_the_others_were_told_to_begin_leaves_its_dose_unfinished() {
    let [(whole, made), (state, stopped)] = both(Fails::Stopped);
    made.unwrap();
    stopped.unwrap();
    assert_eq!(whole.unwrap().unfinished, None);
    let dose = state.unwrap().unfinished.unwrap();
    assert_eq!((dose.made_least, dose.made_most), (0, 0));
}

#[test]
fn a_motor_that_fails_while_they_wait_keeps_the_others_from_beginning_and_nothing_is_unfinished() {
    for (state, failed) in both(Fails::Waiting) {
        assert_eq!(state.unwrap().unfinished, None);
        assert!(matches!(failed, Err(DoseError::Connection(_))), "{failed:?}");
    }
}
