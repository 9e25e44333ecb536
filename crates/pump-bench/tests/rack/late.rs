//! Flows over time that run late, and the times that the report of their rack tells.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use pump_bench::dosing::FlowProfile;
use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, Gate, Leave};
use pump_bench::rack::{Rack, RackEnd, RackFile};
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{FlowMotion, Phase, Plan};

/// Time by which a motor hangs, in s.
const HANGS_S: f64 = 1.5;

/// Motor of another program that takes no time for its steps. Its first flow over time hangs once on its way.
#[derive(Debug, Default)]
struct Hanging {
    hangs: bool,
}

impl Drive for Hanging {
    fn id(&self) -> &str {
        "hanging"
    }

    fn abilities(&self) -> Abilities {
        Abilities::new().with_step_times(true).with_flow_over_time(true)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        Ok(self.makes(plan.steps().unsigned_abs(), gate))
    }

    fn check_flow(&mut self, _flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        Ok(())
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        Ok(self.makes(flow.steps().unsigned_abs(), gate))
    }
}

impl Hanging {
    fn makes(&mut self, all: u64, gate: &mut Gate<'_>) -> u64 {
        let mut made = 0;
        while made < all {
            let next = (made + 10).min(all);
            match gate(made, next) {
                Leave::Go => made = next,
                Leave::Wait => {}
                Leave::Stop => break,
            }
            if made > all / 2 && std::mem::take(&mut self.hangs) {
                std::thread::sleep(Duration::from_secs_f64(HANGS_S));
            }
        }
        made
    }
}

/// A pump whose motor is [`Hanging`], with its angle on record.
fn bench(pump: &str, folder: &Path) -> Bench {
    let bench = Bench::new(built_in(pump).unwrap(), None, folder).unwrap();
    let bench = bench.driven_by(&Hanging::default()).unwrap().confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(Hanging::default())).unwrap();
    session.connect().unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    drop(session);
    bench
}

#[test]
fn a_flow_over_time_that_ran_late_says_so_and_claims_its_departure_no_more() {
    for hangs in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let bench = bench("three-roller", folder.path());
        let mut session = Session::with_drive(&bench, Box::new(Hanging { hangs })).unwrap();
        let profile = FlowProfile::parse("short.csv", "time_s,flow_ml_s\n0,0\n0.5,2\n1,0\n").unwrap();
        let prepared = session.prepare_profile(DoseRequest::new(Purpose::Run, 0.0), &profile).unwrap();
        let delivered = session.run_profile(&prepared, |_| ControlFlow::Continue(())).unwrap();
        let report = DoseReport::by_profile(&bench, &prepared, Some(&delivered));
        let departure_ml = report.run.unwrap().profile.unwrap().largest_departure_ml;
        assert_eq!((delivered.completed, departure_ml.is_none()), (true, hangs), "{departure_ml:?}");
        assert_eq!(
            report.summary(None, None).contains("at every moment"),
            !hangs,
            "{}",
            report.summary(None, None)
        );
        let told: Vec<String> = delivered.warnings.iter().map(ToString::to_string).collect();
        let is_told = told.iter().any(|told| {
            told.contains("and 1 s by its plan") && told.contains("the flow was not at every moment")
        });
        assert_eq!(is_told, hangs, "{told:?}");
    }
}

#[test]
fn a_rack_whose_flow_ran_late_tells_it_and_the_times_that_were_made() {
    let text = "schema = \"rack/1\"\n[pumps]\nacid = \"three-roller\"\nbase = \"two-roller\"\n[[step]]\ngradient = { \
                acid = [1, 0], base = [0, 1] }\nrate = \"2mL/s\"\nfor = \"1s\"\nramp = \"300ms\"\n[[step]]\npump = \
                \"acid\"\nvolume = \"0.2mL\"\n";
    let folder = tempfile::tempdir().unwrap();
    let benches = ["three-roller", "two-roller"].map(|pump| bench(pump, folder.path()));
    let file = RackFile::parse(text, Path::new("late.toml")).unwrap();
    let rack = Rack::new(file, benches.into()).unwrap();
    let drives = [true, false].map(|hangs| Some(Box::new(Hanging { hangs }) as Box<dyn Drive>));
    let report = rack.run_with(drives.into(), |_| {}).unwrap();
    assert_eq!(report.end, RackEnd::Completed, "{}", report.json());
    let acid = &report.pumps[0];
    let told = acid.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
    assert!(told.contains("and 1 s by its plan") && told.contains("step 2 began"), "{told}");
    // The second step was to begin after the first second, once the first step had ended. A real motor is given its
    // steps ahead of their time, so its hanging may begin ahead of the rack's clock.
    let begins_s = acid.doses[1].begin_s;
    let (ended_s, planned_s) = (report.ended_s.unwrap(), report.planned_s);
    let is_late = begins_s > HANGS_S - 0.2 && ended_s >= begins_s;
    assert!(is_late, "{begins_s} s, {ended_s} s, {planned_s} s planned");
    let times = format!("2 steps in {ended_s:.3} s, completed");
    assert!(report.text().contains(&times), "{}", report.text());
}
