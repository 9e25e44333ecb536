//! Claims about racks that are stopped, and about faults.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pump_bench::Bench;
use pump_bench::drives::{Drive, StopRequest};
use pump_bench::pump_file::Pace;
use pump_bench::rack::{Rack, RackEnd, RackFile};
use pump_bench::record::{LogEnd, LogEntry, LogLine};
use pump_bench::report::Ending;
use pump_bench::{DoseRequest, built_in};

use crate::rig::{Desk, Failing, HEAD, PUMPS, Panicking};

const LONG: &str = "[[step]]\nratio = { acid = 2, base = 1, salt = 1 }\nvolume = \"40mL\"\nrate = \"8mL/s\"\n[[step]]\n\
                    pump \
                    = \"salt\"\nvolume = \"1mL\"\n";

#[test]
fn a_stop_stops_all_and_each_rest_is_made_afterwards() {
    let desk = Desk::new();
    let asked = Arc::new(AtomicBool::new(false));
    let hears = asked.clone();
    let rack = desk.rack(LONG).unwrap();
    let rack = rack.stopping_on(StopRequest::new(move || hears.load(Ordering::SeqCst)));
    let report = rack.run(|progress| {
        if progress.pump == "base" && progress.made > 3000 {
            asked.store(true, Ordering::SeqCst);
        }
    });
    let report = report.unwrap();
    assert_eq!((report.end, report.completed), (RackEnd::Stopped, false));
    for row in &report.pumps {
        // Every pump has run for as long as the others, to 20 ms and its ramp.
        let dose = &row.doses[0].dose;
        let base_s = report.pumps[1].doses[0].dose.measured_motion_s.unwrap();
        assert!((dose.measured_motion_s.unwrap() - base_s).abs() < 0.05, "{}: {dose:?}", row.name);
        assert!(row.unfinished && row.steps_completed == 0, "{}", row.name);
        // The report tells what is on record, and not what was planned.
        let state = desk.state(&row.name).unwrap();
        let logged = last_logged(&rack, PUMPS.iter().position(|(name, _)| *name == row.name).unwrap());
        assert_eq!((row.carry_ml, dose.carry_ml), (Some(state.carry_ml), logged.carry_ml), "{}", row.name);
        let turned_deg = dose.end_angle_deg - state.angle_rad.to_degrees();
        assert!((turned_deg / 360.0 - (turned_deg / 360.0).round()).abs() < 1e-9, "{}: {dose:?}", row.name);
        let asked_ml = dose.requested_ml;
        let bench = desk.bench(&row.name);
        let mut session = bench.session().unwrap();
        let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
        let made = session.run(&rest, |_| std::ops::ControlFlow::Continue(())).unwrap();
        assert!((row.delivered_ml + made.volume_ml - asked_ml).abs() < 0.002, "{}", row.name);
    }
    assert_eq!(report.pumps[2].doses.len(), 1, "the second step was not begun");
    let ended_s =
        report.pumps.iter().map(|row| row.doses[0].dose.measured_motion_s.unwrap()).fold(0.0, f64::max);
    assert_eq!(report.ended_s, Some(ended_s));
    let times = format!("2 steps in {ended_s:.3} of {:.3} s, stopped", report.planned_s);
    assert!(report.text().contains(&times), "{}", report.text());
}

#[test]
fn a_stop_before_the_begin_moves_nothing() {
    let desk = Desk::new();
    let rack = desk.rack(LONG).unwrap().stopping_on(StopRequest::new(|| true));
    let error = rack.run(|_| {}).unwrap_err();
    assert_eq!(pump_bench::report::Explain::ending(&error), Ending::Stopped);
    assert!(desk.is_untouched());
}

#[test]
fn a_fault_of_one_pump_stops_all_others_and_is_told() {
    let desk = Desk::new();
    let file = RackFile::parse(&format!("{HEAD}{LONG}"), "mix.toml".as_ref()).unwrap();
    let benches = PUMPS.map(|(name, pump)| {
        let bench = Bench::new(built_in(pump).unwrap(), None, desk.path()).unwrap();
        if name == "base" { bench.driven_by(&Failing::default()).unwrap() } else { bench }
    });
    let rack = Rack::new(file, benches.into()).unwrap().paced(Pace::Fast);
    let failing: Box<dyn Drive> = Box::new(Failing { after: 4000, unsure: 500 });
    let report = rack.run_with(vec![None, Some(failing), None], |_| {}).unwrap();
    assert_eq!(report.end, RackEnd::Fault);
    assert_eq!(report.fault.as_ref().map(|fault| fault.pump.as_str()), Some("base"));
    let [acid, base, salt] = &report.pumps[..] else { panic!("{}", report.json()) };
    let part_ml = 10.0 * 3750.0 / base_steps(&rack);
    assert!(base.error.is_some() && base.unfinished && (base.delivered_ml - part_ml).abs() < 1.5, "{base:?}");
    for row in [acid, salt] {
        assert!(row.error.is_none() && row.unfinished && !row.completed, "{row:?}");
        assert!(row.delivered_ml > 0.0 && row.delivered_ml < 0.9 * row.requested_ml, "{row:?}");
        assert!(desk.state(&row.name).unwrap().unfinished.is_some());
    }
    assert!(report.json().contains("\"fault\":\"base\""));
    // Half the range of the unknown steps comes on top of the uncertainty of the part that was made, as in the log.
    let range_ml = base.delivered_most_ml - base.delivered_least_ml;
    let entry = last_logged(&rack, 1);
    let known_ml = entry.expanded_uncertainty_ml.unwrap();
    assert!(range_ml > 0.5 && (base.expanded_uncertainty_ml - known_ml).abs() < 1e-9, "{base:?} {entry:?}");
    assert!(base.expanded_uncertainty_ml > 0.5 * range_ml + 0.1, "{base:?}");
    let total = &report.total;
    assert!(total.expanded_uncertainty_ml > base.expanded_uncertainty_ml, "{total:?}");
    assert!((total.delivered_most_ml - total.delivered_least_ml - range_ml).abs() < 1e-9, "{total:?}");
    let text = report.text();
    let line = text.lines().find(|line| line.starts_with("base")).unwrap();
    assert!(
        line.contains(" mL, between ") && line.contains(" by the steps and the angle, 10 mL requested"),
        "{text}"
    );
    assert!(!text.contains("-0"), "{text}");
}

#[test]
fn a_rack_of_which_each_motion_has_failed_tells_when_it_began() {
    let desk = Desk::new();
    let rack = "schema = \"rack/1\"\n[pumps]\nbase = \"three-roller\"\n[[step]]\npump = \"base\"\nvolume = \"10mL\"\n";
    let file = RackFile::parse(rack, "one.toml".as_ref()).unwrap();
    let bench = Bench::new(built_in("three-roller").unwrap(), None, desk.path()).unwrap();
    let bench = bench.driven_by(&Failing::default()).unwrap();
    let rack = Rack::new(file, vec![bench]).unwrap().paced(Pace::Fast);
    let failing: Box<dyn Drive> = Box::new(Failing { after: 4000, unsure: 0 });
    let report = rack.run_with(vec![Some(failing)], |_| {}).unwrap();
    assert!(report.end == RackEnd::Fault && report.pumps[0].doses.is_empty(), "{}", report.json());
    let began = report.time.unwrap();
    assert!(report.text().contains(&format!(", began {began}\n")), "{}", report.text());
    assert!(began.unix_s.abs_diff(last_logged(&rack, 0).time.unix_s) <= 1);
}

#[test]
fn a_pump_whose_thread_panics_stops_all_others_and_is_reported_as_failed() {
    let desk = Desk::new();
    let file = RackFile::parse(&format!("{HEAD}{LONG}"), "mix.toml".as_ref()).unwrap();
    let benches = PUMPS.map(|(name, pump)| {
        let bench = Bench::new(built_in(pump).unwrap(), None, desk.path()).unwrap();
        if name == "acid" { bench.driven_by(&Panicking(0)).unwrap() } else { bench }
    });
    let rack = Rack::new(file, benches.into()).unwrap().paced(Pace::Fast);
    let panicking: Box<dyn Drive> = Box::new(Panicking(4000));
    let report = rack.run_with(vec![Some(panicking), None, None], |_| {}).unwrap();
    assert_eq!(
        (report.end, report.fault.as_ref().map(|fault| &fault.pump[..])),
        (RackEnd::Fault, Some("acid"))
    );
    let [acid, base, salt] = &report.pumps[..] else { panic!("{}", report.json()) };
    assert!(acid.name == "acid" && !acid.completed && acid.error.is_some(), "{acid:?}");
    for row in [base, salt] {
        assert!(row.error.is_none() && row.unfinished && !row.completed, "{row:?}");
    }
    // The journal has what the report cannot tell.
    assert!(rack.members()[0].bench.story().unwrap().state.unwrap().unfinished.is_some());
}

/// The last dose in the log of a pump.
fn last_logged(rack: &Rack, pump: usize) -> LogEntry {
    let log = rack.members()[pump].bench.log().unwrap().map(|line| match line.unwrap() {
        LogLine::Dose(entry) => entry,
        other => panic!("{other:?}"),
    });
    log.last().unwrap()
}

#[test]
fn the_log_of_each_pump_names_the_rack_and_who_stopped_it() {
    let desk = Desk::new();
    let file = RackFile::parse(&format!("{HEAD}{LONG}"), "mix.toml".as_ref()).unwrap();
    let benches = PUMPS.map(|(name, pump)| {
        let bench = Bench::new(built_in(pump).unwrap(), None, desk.path()).unwrap();
        if name == "base" { bench.driven_by(&Failing::default()).unwrap() } else { bench }
    });
    let rack = Rack::new(file, benches.into()).unwrap().paced(Pace::Fast);
    let failing: Box<dyn Drive> = Box::new(Failing { after: 4000, unsure: 0 });
    rack.run_with(vec![None, Some(failing), None], |_| {}).unwrap();
    for pump in [0, 2] {
        let entry = last_logged(&rack, pump);
        assert_eq!(entry.end, LogEnd::Stopped);
        assert_eq!(entry.cause.as_deref(), Some("a fault of pump base of the rack"));
        assert_eq!(entry.rack.unwrap().as_str(), "mix");
    }
    let failed = last_logged(&rack, 1);
    let cause = failed.cause.unwrap();
    assert!(failed.end == LogEnd::Fault && cause.contains("broken pipe"), "{cause}");
    // Somebody who stops the rack is named by every pump.
    let desk = Desk::new();
    let asked = Arc::new(AtomicBool::new(false));
    let hears = asked.clone();
    let stop = StopRequest::new(move || hears.load(Ordering::SeqCst)).saying(|| Some("SIGTERM".to_owned()));
    let rack = desk.rack(LONG).unwrap().stopping_on(stop);
    rack.run(|progress| {
        if progress.made > 3000 {
            asked.store(true, Ordering::SeqCst);
        }
    })
    .unwrap();
    for pump in 0..3 {
        assert_eq!(last_logged(&rack, pump).cause.as_deref(), Some("SIGTERM"));
    }
}

/// Motor steps of 10 mL of the pump `base`.
fn base_steps(rack: &Rack) -> f64 {
    let model = rack.members()[1].bench.model();
    10.0 / model.revolution_ml() * 12_800.0
}
