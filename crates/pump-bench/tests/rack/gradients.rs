//! Claims about gradients: the volume of each pump is that of the flow that was asked for, at every instant.

use std::path::Path;
use std::sync::{Arc, Mutex};

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, Gate, Leave};
use pump_bench::pump_file::Pace;
use pump_bench::rack::{Rack, RackFile};
use pump_bench::report::with_sources;
use pump_bench::{Bench, built_in};
use pump_ctl::plan::{FlowMotion, Plan};
use pump_model::Pump;

use crate::rig::Desk;

/// Instants at which the volumes are compared.
const INSTANTS: u32 = 1000;

const PUMPS: [&str; 3] = ["three-roller", "three-roller-published", "three-roller-as-built"];
const GRADIENT: &str = r#"
schema = "rack/1"
[pumps]
acid = "three-roller"
base = "three-roller-published"
salt = "three-roller-as-built"
[[step]]
gradient = { acid = [2, 0], base = [1, 1], salt = [0, 2] }
rate = "3mL/s"
for = "20s"
ramp = "2s"
"#;

/// Simulated drive that writes down the time of every step.
#[derive(Debug, Clone, Default)]
struct Scribe {
    times_s: Arc<Mutex<Vec<f64>>>,
}

impl Drive for Scribe {
    fn id(&self) -> &str {
        "scribe"
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn abilities(&self) -> Abilities {
        Abilities::new().with_step_times(true).with_flow_over_time(true)
    }

    fn run(&mut self, _plan: &Plan, _gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        unreachable!("a gradient is a flow over time")
    }

    fn check_flow(&mut self, _flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        Ok(())
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let mut made = 0;
        for step in flow.each_step() {
            loop {
                match gate(made, step.number) {
                    Leave::Go => break,
                    Leave::Wait => {}
                    Leave::Stop => return Ok(made),
                }
            }
            made = step.number;
            self.times_s.lock().unwrap().push(step.time_s);
        }
        Ok(made)
    }
}

/// Volume that was asked of a pump whose share of 3 mL/s goes from `first` to `last` in 20 s, with ramps of 2 s: by the
/// trapezoid rule on 20,000 parts of the time.
fn asked_ml(first: f64, last: f64, until_s: f64) -> f64 {
    let share = |t: f64| first + (last - first) * t / 20.0;
    let flow = |t: f64| {
        if t < 2.0 {
            3.0 * share(2.0) * t / 2.0
        } else if t > 18.0 {
            3.0 * share(18.0) * (20.0 - t) / 2.0
        } else {
            3.0 * share(t)
        }
    };
    let parts = 20_000;
    let part_s = until_s / f64::from(parts);
    (0..parts).map(|part| part_s * flow(part_s * (f64::from(part) + 0.5))).sum()
}

/// Volumes that the rollers have pushed after each step, in mL: by the midpoint rule on the flow per radian.
fn pushed_ml(pump: &Pump, start_rad: f64, step_rad: f64, steps: usize) -> Vec<f64> {
    const PARTS: u32 = 8;
    let mut pushed_ml = vec![0.0];
    for step in 0..steps {
        let part_rad = step_rad / f64::from(PARTS);
        let at = |part: u32| start_rad + step as f64 * step_rad + part_rad * (f64::from(part) + 0.5);
        let flow = |part| pump.outlet_curve().flow_ml_rad(at(part));
        let step_ml: f64 = (0..PARTS).map(|part| part_rad * flow(part)).sum();
        pushed_ml.push(pushed_ml.last().unwrap() + step_ml);
    }
    pushed_ml
}

fn benches(desk: &Desk, scribes: &[Scribe]) -> Vec<Bench> {
    let bench = |(pump, scribe): (&&str, &Scribe)| {
        Bench::new(built_in(pump).unwrap(), None, desk.path()).unwrap().driven_by(scribe).unwrap()
    };
    PUMPS.iter().zip(scribes).map(bench).collect()
}

#[test]
fn each_pump_of_a_gradient_is_within_a_motor_step_of_its_flow_at_a_thousand_instants() {
    // Each scribe has a book of its own.
    let (desk, scribes) = (Desk::new(), PUMPS.map(|_| Scribe::default()));
    let file = RackFile::parse(GRADIENT, Path::new("gradient.toml")).unwrap();
    let rack = Rack::new(file, benches(&desk, &scribes)).unwrap().paced(Pace::Fast);
    let drives = scribes.iter().map(|scribe| Some(Box::new(scribe.clone()) as Box<dyn Drive>)).collect();
    let report = rack.run_with(drives, |_| {}).unwrap();
    assert!(report.completed, "{}", report.json());
    assert_eq!(report.total.requested_ml.round(), 54.0);
    let shares = [(2.0 / 3.0, 0.0), (1.0 / 3.0, 1.0 / 3.0), (0.0, 2.0 / 3.0)];
    for ((member, scribe), ((first, last), row)) in
        rack.members().iter().zip(&scribes).zip(shares.into_iter().zip(&report.pumps))
    {
        let (model, times_s) = (member.bench.model(), scribe.times_s.lock().unwrap());
        let step_rad = std::f64::consts::TAU / 12_800.0;
        let pushed_ml = pushed_ml(model, 0.0, step_rad, times_s.len());
        let most_ml_rad = (0..10_000)
            .map(|part| model.outlet_curve().flow_ml_rad(std::f64::consts::TAU * f64::from(part) / 10_000.0))
            .fold(0.0, f64::max);
        let step_ml = most_ml_rad * step_rad;
        for instant in 0..=INSTANTS {
            let time_s = 20.0 * f64::from(instant) / f64::from(INSTANTS);
            let made = times_s.partition_point(|made_s| *made_s <= time_s);
            let off_ml = pushed_ml[made] - asked_ml(first, last, time_s);
            assert!(
                off_ml.abs() <= 1.001 * step_ml,
                "{}: {off_ml} mL off at {time_s} s, and a step is {step_ml} mL",
                member.name
            );
        }
        assert!((row.delivered_ml - asked_ml(first, last, 20.0)).abs() < step_ml, "{}", row.delivered_ml);
    }
}

#[test]
fn a_gradient_that_is_stopped_leaves_no_rest_and_the_volumes_on_record() {
    let desk = Desk::new();
    let asked = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let hears = asked.clone();
    let steps = "[[step]]\ngradient = { acid = [1, 0], salt = [0, 1] }\nrate = \"2mL/s\"\nfor = \"30s\"\n";
    let stop = pump_bench::drives::StopRequest::new(move || hears.load(std::sync::atomic::Ordering::SeqCst));
    let rack = desk.rack(steps).unwrap().stopping_on(stop);
    let report = rack.run(|progress| {
        asked.fetch_or(progress.made > 10_000, std::sync::atomic::Ordering::SeqCst);
    });
    let report = report.unwrap();
    assert_eq!(report.end, pump_bench::rack::RackEnd::Stopped);
    for (name, row) in [("acid", &report.pumps[0]), ("salt", &report.pumps[2])] {
        assert!(!row.unfinished && row.delivered_ml > 0.0 && row.delivered_ml < row.requested_ml, "{name}");
        let state = desk.state(name).unwrap();
        assert!(state.unfinished.is_none() && (state.wear.volume_ml - row.delivered_ml).abs() < 0.01);
    }
}

#[test]
fn a_gradient_that_a_motor_or_a_drive_cannot_follow_is_refused_before_any_pump_moves() {
    let desk = Desk::new();
    let gradient = |rate: &str| {
        format!("[[step]]\ngradient = {{ acid = [1, 0], salt = [0, 1] }}\nrate = \"{rate}\"\nfor = \"30s\"\n")
    };
    let fast = with_sources(&desk.rack(&gradient("200mL/s")).unwrap().run(|_| {}).unwrap_err());
    // Both pumps refuse it, and the one that is planned first tells.
    let told = ["acid", "salt"].map(|pump| format!("pump `{pump}` of the rack, step 1: "));
    assert!(told.iter().any(|told| fast.starts_with(told)), "{fast}");
    let failing = crate::rig::Failing::default();
    let file = RackFile::parse(GRADIENT, Path::new("gradient.toml")).unwrap();
    let benches = PUMPS.map(|pump| {
        Bench::new(built_in(pump).unwrap(), None, desk.path()).unwrap().driven_by(&failing).unwrap()
    });
    let rack = Rack::new(file, benches.into()).unwrap().paced(Pace::Fast);
    let drives = PUMPS.map(|_| Some(Box::new(crate::rig::Failing::default()) as Box<dyn Drive>)).into();
    let unable = with_sources(&rack.run_with(drives, |_| {}).unwrap_err());
    assert!(unable.contains("the failing driver has no"), "{unable}");
    assert!(desk.is_untouched());
}
