//! Claims about the word before a motion.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use pump_bench::drives::{Drive, DriveError, DriveFault, Gate, Leave};
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

/// Belt that turns the pump head, and that refuses its first plans.
#[derive(Debug, Default)]
struct Belt {
    /// Plans to refuse.
    refusals: u32,
    /// Steps made in all.
    turned: u64,
}

impl Drive for Belt {
    fn id(&self) -> &str {
        "belt"
    }

    fn check(&mut self, _plan: &Plan) -> Result<(), DriveError> {
        match self.refusals.checked_sub(1) {
            Some(left) => {
                self.refusals = left;
                Err(DriveError::device(std::io::Error::other("the belt is too slow")))
            }
            None => Ok(()),
        }
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let steps = plan.steps().unsigned_abs();
        while gate(0, steps) == Leave::Wait {}
        self.turned += steps;
        Ok(steps)
    }
}

fn bench(folder: &Path) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    bench.driven_by(&Belt::default()).unwrap().confirming_pump(true)
}

fn go(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn a_motion_is_told_of_once_and_after_every_refusal() {
    let folder = tempfile::tempdir().unwrap();
    let (bench, told) = (bench(folder.path()), AtomicU32::new(0));
    let mut session = Session::with_drive(&bench, Box::new(Belt { refusals: 1, turned: 0 })).unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    for (count, is_refused) in [(0, true), (1, false), (1, false)] {
        let prepared = session.prepare(DoseRequest::dose(0.2)).unwrap();
        if count == told.load(Ordering::Relaxed) && !session.has_moved() {
            session.before_motion(|| {
                told.fetch_add(1, Ordering::Relaxed);
                ControlFlow::Continue(())
            });
        }
        let ended = session.run(&prepared, go);
        assert_eq!((ended.is_err(), told.load(Ordering::Relaxed)), (is_refused, count), "{ended:?}");
    }
}

#[test]
fn a_word_that_calls_the_motion_off_leaves_nothing_moved_and_nothing_unfinished() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path());
    let mut belt = Belt::default();
    let mut session = Session::with_drive(&bench, Box::new(&mut belt)).unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    let stands = *session.state().unwrap();
    let prepared = session.prepare(DoseRequest::dose(0.2)).unwrap();
    session.before_motion(|| ControlFlow::Break(()));
    let ended = session.run(&prepared, go).unwrap_err();
    assert!(matches!(ended, DoseError::Connection(DriveError::Interrupted)), "{ended:?}");
    assert!(!session.has_moved());
    assert_eq!(session.state(), Some(&stands));
    drop(session);
    // Another process finds the pump as it was.
    let mut session = Session::with_drive(&bench, Box::new(&mut belt)).unwrap();
    assert_eq!(session.state(), Some(&stands));
    let prepared = session.prepare(DoseRequest::dose(0.2)).unwrap();
    let steps = prepared.plan.steps().unsigned_abs();
    assert!(session.run(&prepared, go).unwrap().completed);
    drop(session);
    assert_eq!(belt.turned, steps);
}
