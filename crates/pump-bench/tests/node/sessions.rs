//! Doses by a bench, with its journal: finished, killed and resumed.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pump_bench::drives::Node;
use pump_bench::{Bench, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase};

use crate::rig::Rig;

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
