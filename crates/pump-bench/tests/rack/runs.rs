//! Claims about racks that run to their end.

use pump_bench::rack::RackEnd;
use pump_bench::record::LogLine;

use crate::rig::Desk;

#[test]
fn a_ratio_of_three_pumps_delivers_its_shares_together() {
    let desk = Desk::new();
    let steps = "[[step]]\nratio = { acid = 3, base = 2, salt = 1 }\nvolume = \"12mL\"\nrate = \"6mL/s\"\nsmooth = \
                 true\n";
    let report = desk.rack(steps).unwrap().run(|_| {}).unwrap();
    assert_eq!((report.end, report.total.requested_ml), (RackEnd::Completed, 12.0));
    for (row, asked_ml) in report.pumps.iter().zip([6.0, 4.0, 2.0]) {
        assert!((row.delivered_ml - asked_ml).abs() < 0.002, "{}: {}", row.name, row.delivered_ml);
        let dose = &row.doses[0];
        assert_eq!(dose.begin_s, 0.0);
        // Smooth flows take the time of the share, but for their ramps.
        assert!((dose.dose.motion_s - 2.0).abs() < 0.3, "{}: {} s", row.name, dose.dose.motion_s);
        // Each pump has a record of its own.
        let state = desk.state(&row.name).unwrap();
        assert!((state.wear.volume_ml - asked_ml).abs() < 0.002 && state.unfinished.is_none());
    }
    assert!((report.total.delivered_ml - 12.0).abs() < 0.004);
}

#[test]
fn each_dose_of_a_rack_tells_what_was_typed_in_its_report_and_its_log() {
    let desk = Desk::new();
    let steps = "[[step]]\nratio = { acid = 2, base = 1 }\nvolume = \"30mL\"\nrate = \"6 mL/s\"\n[[step]]\npump = \
                 \"acid\"\nrate = \"2mL/s\"\nfor = \"3s\"\nreverse = true\n[[step]]\ngradient = { acid = [1, 0], base \
                 = [0, 1] }\nrate = \"2mL/s\"\nfor = \"10s\"\n";
    let rack = desk.rack(steps).unwrap();
    let report = rack.run(|_| {}).unwrap();
    for (pump, told) in [
        (0, &["30mL, 2 of 3", "-2mL/s for 3s", "2mL/s for 10s, 1 to 0"][..]),
        (1, &["30mL, 1 of 3", "2mL/s for 10s, 0 to 1"]),
    ] {
        let asked = |dose: &pump_bench::rack::RackDose| dose.dose.asked.unwrap().as_str().to_owned();
        let reported: Vec<String> = report.pumps[pump].doses.iter().map(asked).collect();
        assert_eq!(reported, told);
        let logged = rack.members()[pump].bench.log().unwrap().map(|line| match line.unwrap() {
            LogLine::Dose(entry) => entry.asked.unwrap().as_str().to_owned(),
            other => panic!("{other:?}"),
        });
        assert_eq!(logged.collect::<Vec<_>>(), told);
    }
}

#[test]
fn steps_follow_each_other_and_carry_what_the_one_before_left() {
    let desk = Desk::new();
    let steps = "[[step]]\npump = \"acid\"\nvolume = \"3mL\"\n[[step]]\nafter = \"2s\"\npump = \"acid\"\nvolume = \
                 \"1mL\"\nreverse = true\n[[step]]\nat = \"20s\"\nratio = { acid = 1, base = 1 }\nvolume = \
                 \"4mL\"\nfor = \"2s\"\n";
    let rack = desk.rack(steps).unwrap();
    let planned = rack.rehearse().unwrap();
    assert!(desk.is_untouched() && planned.end == RackEnd::Planned && !planned.has_moved());
    let report = rack.run(|_| {}).unwrap();
    assert!(report.completed, "{}", report.json());
    let acid = &report.pumps[0];
    let begins_s: Vec<f64> = acid.doses.iter().map(|dose| dose.begin_s).collect();
    assert!(begins_s[0] == 0.0 && begins_s[1] > 2.0 && begins_s[2] == 20.0, "{begins_s:?}");
    assert!((acid.delivered_ml - 4.0).abs() < 0.004, "{}", acid.delivered_ml);
    assert_eq!(acid.doses[1].dose.carry_in_ml, acid.doses[0].dose.carry_ml);
    // The rehearsal planned what was run.
    for (planned, run) in planned.pumps.iter().zip(&report.pumps) {
        let steps = |row: &pump_bench::rack::RackPumpReport| {
            row.doses.iter().map(|dose| (dose.begin_s, dose.dose.steps)).collect::<Vec<_>>()
        };
        assert_eq!(steps(planned), steps(run), "{}", run.name);
    }
    assert_eq!(report.pumps[2].steps, 0);
    assert!(report.pumps[2].completed && desk.state("salt").is_none_or(|state| state.wear.volume_ml == 0.0));
}
