//! Claims about the wait for the line after a motion.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, Gate, Leave, Watch};
use pump_bench::{Bench, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase, Plan};
use pump_model::Pump;

/// Motor that decelerates by its fastest ramp, and notes how long each wait for the line is to be.
#[derive(Debug)]
struct Waiting {
    pump: Pump,
    waits_s: Arc<Mutex<Vec<f64>>>,
}

impl Drive for Waiting {
    fn id(&self) -> &str {
        "waiting"
    }

    fn abilities(&self) -> Abilities {
        Abilities::new().with_step_times(true)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let (mut made, all) = (0, plan.steps().unsigned_abs());
        while made < all {
            match gate(made, (made + 10).min(all)) {
                Leave::Go => made = (made + 10).min(all),
                Leave::Wait => {}
                Leave::Stop => {
                    made += plan.stop(&self.pump, made).map_or(0, |stop| stop.steps().unsigned_abs());
                    break;
                }
            }
        }
        Ok(made)
    }

    fn settle(&mut self, settle_s: f64, _: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        self.waits_s.lock().unwrap().push(settle_s);
        Ok(None)
    }
}

#[test]
fn the_wait_after_a_stop_is_that_of_the_stop_and_after_a_dose_that_of_its_plan() {
    let folder = tempfile::tempdir().unwrap();
    let file = built_in("three-roller").unwrap();
    let (pump, waits_s) = (file.model().unwrap(), Arc::default());
    let motor = || Waiting { pump, waits_s: Arc::clone(&waits_s) };
    let bench = Bench::new(file, None, folder.path()).unwrap().driven_by(&motor()).unwrap();
    let bench = bench.confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(motor())).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let request = DoseRequest::dose(25.0).with_cruise(Cruise::Flow { ml_s: 5.0 });
    let prepared = session.prepare(request).unwrap();
    let whole = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let whole_s = DoseReport::new(&bench, &prepared, Some(&whole)).settle_s.unwrap();
    let prepared = session.prepare(request).unwrap();
    let half = prepared.plan.steps().unsigned_abs() / 2;
    let stopped = session
        .run(&prepared, |made| if made < half { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        .unwrap();
    assert!(!stopped.completed && stopped.made > half, "{stopped:?}");
    let stop_s = DoseReport::new(&bench, &prepared, Some(&stopped)).settle_s.unwrap();
    assert_eq!(*waits_s.lock().unwrap(), [whole_s, stop_s]);
    // The fastest ramp leaves the published line with a swing of a few 10 uL, which decays at 13.19 /s to 1 uL; the
    // plan's own ramp leaves it nearly at rest.
    let swing_s = |volume_ml: f64| (volume_ml / 1e-3).ln() / 13.19;
    assert!((swing_s(0.01)..swing_s(0.1)).contains(&stop_s) && stop_s > whole_s + 0.05, "{stop_s} {whole_s}");
}
