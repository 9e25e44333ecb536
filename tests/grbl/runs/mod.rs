//! Claims about runs of continuous flow on a board.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use pump_bench::dosing::RunEnd;
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseReport, DoseRequest, built_in};
use pump_ctl::plan::{Cruise, Phase};

use crate::rig::plug;
use crate::simulated::Simulated;
use crate::simulated::options::Options;

/// Makes a bench with this board.
fn bench(folder: &Path, board: &Simulated) -> Bench {
    let mut file = built_in("three-roller").unwrap();
    file.drive = Some(DriveTable::of(DriverName::Grbl));
    file.motor.confirmed = None;
    Bench::new(file, None, folder).unwrap().at_port(Some(board.path().to_owned()))
}

/// Returns a run at 5 mL/s that ends with `end`.
fn run(end: RunEnd) -> DoseRequest {
    DoseRequest::new(Purpose::Run, 1.0).with_cruise(Cruise::Flow { ml_s: 5.0 }).with_end(end)
}

#[test]
fn a_board_runs_for_the_time_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(run(RunEnd::Time { time_s: 4.0 })).unwrap();
    let began = Instant::now();
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let took_s = began.elapsed().as_secs_f64();
    assert!(delivered.completed && !delivered.unfinished);
    assert!((prepared.plan.profile().duration_s() - 4.0).abs() < 0.001);
    // A board takes its 4 s, and a computer that is late sees the end later.
    assert!(delivered.measured_s > 3.8 && delivered.measured_s < took_s, "{} {took_s}", delivered.measured_s);
    assert_eq!(board.rest().steps, prepared.plan.steps());
}

#[test]
fn a_run_until_it_is_stopped_decelerates_on_a_board_and_its_record_has_every_step() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(run(RunEnd::Stop)).unwrap();
    // The board counts to some million steps exactly, and the run ends before.
    assert!((1_000_000..4_194_304).contains(&prepared.plan.steps()), "{}", prepared.plan.steps());
    assert!(prepared.warnings.iter().any(|warning| warning.text().contains("counts its steps exactly")));
    let began = Instant::now();
    let delivered = session
        .run(&prepared, |_| {
            if began.elapsed().as_secs_f64() > 2.5 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
    assert!(!delivered.completed && !delivered.unfinished);
    // The board's own count says how far the rotor turned.
    assert_eq!(board.rest().steps, delivered.made as i64);
    let state = *session.state().unwrap();
    assert!(state.unfinished.is_none() && state.half_width_rad == 0.0, "{state:?}");
    assert!((state.wear.volume_ml - delivered.volume_ml).abs() < 1e-9);
    let report = DoseReport::new(&bench, &prepared, Some(&delivered));
    assert!(report.completed && report.run.unwrap().was_stopped == Some(true));
    let flow_ml_s = report.run.unwrap().mean_flow_ml_s.unwrap();
    assert!((flow_ml_s - delivered.volume_ml / delivered.measured_s).abs() < 1e-9, "{flow_ml_s}");
    // The next dose begins from there.
    drop(session);
    let mut session = bench.session().unwrap();
    let next = session.prepare(DoseRequest::dose(0.5)).unwrap();
    assert!(session.run(&next, |_| ControlFlow::Continue(())).unwrap().completed);
    assert_eq!(board.rest().steps, delivered.made as i64 + next.plan.steps());
}
