//! Boards that go on, or that are met again, after the process has died.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

use pump_bench::record::Purpose;
use pump_bench::{DoseRequest, Session};
use pump_ctl::plan::Phase;

use crate::bench::{Lab, file, warning};
use crate::plant::{Board, Dice, Fate, Plant};

struct Rig {
    lab: Lab,
    plant: Arc<Mutex<Plant>>,
}

impl Rig {
    fn new() -> Self {
        Self::counting(1000, false)
    }

    /// Returns a rig whose board counts `count`, and tells its resets or not.
    fn counting(count: i64, tells_resets: bool) -> Self {
        let plant = Plant {
            pump: file().model().unwrap(),
            factor: 1.0,
            angle_rad: 0.0,
            count,
            has_count: true,
            tells_resets,
            is_reachable: true,
            lets_go: false,
            fall_rad: 0.0,
            event: None,
            fate: Fate::Completes,
            motions: Vec::new(),
            died_in: None,
            dice: Dice(1),
        };
        let plant = Arc::new(Mutex::new(plant));
        let mut lab = Lab::new();
        lab.bench = lab.bench.driven_by(&Board(Arc::clone(&plant))).unwrap();
        Self { lab, plant }
    }

    fn session(&self) -> Session<'_> {
        let board = Board(Arc::clone(&self.plant));
        let mut session = Session::with_drive(&self.lab.bench, Box::new(board)).unwrap();
        session.connect().unwrap();
        session
    }

    /// Doses until the process dies. The board makes `made` of the steps.
    fn dies(&self, request: DoseRequest, made: impl FnOnce(u64) -> u64) {
        self.plant.lock().unwrap().fate = Fate::Dies(1);
        let steps = RefCell::new(0);
        let died = catch_unwind(AssertUnwindSafe(|| {
            let mut session = self.session();
            let prepared = session.prepare(request).unwrap();
            *steps.borrow_mut() = prepared.plan.steps().unsigned_abs();
            session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        }));
        assert!(died.is_err());
        let mut plant = self.plant.lock().unwrap();
        plant.dead_after(made(steps.into_inner()));
        plant.fate = Fate::Completes;
    }
}

#[test]
fn a_suck_back_is_made_by_resume_if_the_board_finished_the_dose_by_itself() {
    let rig = Rig::new();
    rig.session().set_angle(Some(Phase::known(0.0))).unwrap();
    rig.dies(DoseRequest::dose(0.2).with_retraction(0.1), |all| all);
    let mut session = rig.session();
    assert!(session.state().unwrap().unfinished.is_none(), "the board's count tells it");
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    warning(&rest, "the volume to suck back is left to make");
    assert!((rest.plan.planned_ml() + 0.1).abs() < 2e-3 && rest.request.purpose == Purpose::Retract);
    session.run(&rest, |_| ControlFlow::Continue(())).unwrap();
    assert!((session.owed_ml() - 0.1).abs() < 3e-3, "{}", session.owed_ml());
    // It is made once.
    assert!(session.prepare_rest(DoseRequest::dose(0.0)).is_err());
}

#[test]
fn a_count_of_zero_is_exact_if_the_board_tells_its_resets_and_proves_nothing_otherwise() {
    for tells_resets in [true, false] {
        let rig = Rig::counting(-60, tells_resets);
        rig.session().set_angle(Some(Phase::known(0.0))).unwrap();
        rig.dies(DoseRequest::dose(0.2), |_| 60);
        assert_eq!(rig.plant.lock().unwrap().count, 0);
        let session = rig.session();
        let state = session.state().unwrap();
        let cut = state.unfinished.unwrap();
        assert_eq!(cut.made_least == 60 && cut.made_most == 60, tells_resets, "{cut:?}");
        assert_eq!(state.phase().half_width_rad() == 0.0, tells_resets, "{state:?}");
    }
}

#[test]
fn a_new_tube_after_a_calibration_run_that_was_killed_leaves_the_angle_known() {
    let rig = Rig::new();
    rig.session().set_angle(Some(Phase::known(0.0))).unwrap();
    rig.dies(DoseRequest::new(Purpose::Calibrate, 7.0), |_| 60);
    {
        // The tube is recorded before the board is asked.
        let mut session = rig.lab.bench.session().unwrap();
        session.new_tube().unwrap();
    }
    let mut session = rig.session();
    let pitch_rad = rig.lab.bench.model().pitch_rad();
    assert!(session.state().unwrap().phase().is_known(pitch_rad), "{:?}", session.notes());
}

#[test]
fn an_angle_is_found_while_a_dose_is_unfinished_if_that_is_asked_for() {
    let lab = Lab::new();
    lab.home(None);
    lab.stopped(DoseRequest::dose(5.0), 0.3);
    let refused = lab.bench.set_angle(Some(Phase::known(0.2))).unwrap_err().to_string();
    assert!(refused.contains("unfinished"), "{refused}");
    let homing = lab.bench.clone().homing_unfinished(true);
    let (session, set) = homing.set_angle(Some(Phase::known(0.2))).unwrap();
    drop(session);
    assert_eq!((set.state.phase(), set.owed_ml), (Phase::known(0.2), 0.0));
    let rest = lab.rest(DoseRequest::dose(0.0).with_smooth(true));
    assert!(rest.plan.is_smooth() && (rest.plan.start().half_width_rad() - 0.0).abs() < 1e-12);
    let refused = homing.set_angle(Some(Phase::known(0.3))).unwrap_err().to_string();
    assert!(refused.contains("known exactly"), "{refused}");
}
