//! Suck-back, and what doses owe each other over many of them.

use pump_bench::Rehearsal;
use pump_bench::{Bench, DoseRequest, built_in};

use crate::user::{User, number, rows};

/// A step of the built-in pump delivers this at most, mL.
const STEP_ML: f64 = 4.3982297 * std::f64::consts::TAU / 12_800.0;

#[test]
fn what_is_sucked_back_is_repaid_by_the_next_dose() {
    let user = User::new();
    let first = user.json(&["5mL", "--retract", "200uL"]);
    assert!((number(&first, "delivered_ml") - 5.0).abs() < STEP_ML);
    let back_ml = number(&first, "retraction_ml");
    assert!((back_ml - 0.2).abs() < STEP_ML);
    let owed_ml = number(&first, "carry_ml");
    assert!((owed_ml - (5.0 - number(&first, "planned_ml") + back_ml)).abs() < 1e-12);

    let second = user.json(&["5mL"]);
    assert_eq!(number(&second, "carry_in_ml"), owed_ml);
    assert!((number(&second, "delivered_ml") - 5.0 - owed_ml).abs() < STEP_ML);
    assert!(number(&second, "carry_ml").abs() < STEP_ML);
    assert!(second["retraction_ml"].is_null());
}

#[test]
fn a_planned_retraction_counts_in_angle_pressures_and_limits() {
    let user = User::new();
    let plain = user.json(&["5mL", "--dry-run"]);
    let back = user.json(&["5mL", "--retract", "1mL", "--dry-run"]);
    assert!(number(&back, "end_angle_deg") < number(&plain, "end_angle_deg") - 5.0);
    assert_eq!(number(&back, "steps"), number(&plain, "steps"));
    // Turning back, the outlet sucks.
    assert!(number(&back, "outlet_min_kpa") < number(&plain, "outlet_min_kpa") - 0.5);
    // From 90 deg a millilitre sucks at the inlet down to 88.33 kPa. A millilitre back sucks at the outlet down to
    // 86.26, and a motor step takes another 0.06.
    let limited = ["1mL", "--start-angle", "90deg", "--min-inlet-pressure", "87kPaa", "--ramps", "fastest"];
    assert_eq!(user.types(&[&limited[..], &["--dry-run"]].concat()).code, 0);
    let refused = user.is_refused(&[&limited[..], &["--retract", "1mL"]].concat());
    assert!(refused.contains("86.20 kPa"), "{refused}");
}

#[test]
fn a_retraction_without_a_dose_toward_the_outlet_is_refused() {
    let user = User::new();
    for arguments in [&["-5mL", "--retract", "1mL"][..], &["5mL", "--reverse", "--retract", "1mL"]] {
        let message = user.is_refused(arguments);
        assert!(message.contains("dose in mL before a retraction is -5"), "{message}");
    }
    assert!(
        user.is_refused(&["prime", "5mL", "--retract", "1mL"]).contains("`dose prime` takes no --retract")
    );
    assert!(user.is_refused(&["5mL", "--retract", "1"]).contains("unit"));
}

#[test]
fn ten_thousand_small_doses_add_up_to_a_litre_within_a_step_whatever_lies_between_them() {
    let state = tempfile::tempdir().unwrap();
    let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path()).unwrap();
    let mut rehearsal = Rehearsal::new(&bench).unwrap();
    let (mut planned_ml, mut owes_ml) = (0.0, 0.0);
    for n in 0..10_000 {
        // Every hundredth dose is sucked back after, every thousandth is followed by one in reverse.
        let retract_ml = (n % 100 == 99).then_some(0.05);
        let prepared = rehearsal.prepare(DoseRequest::dose(0.1).with_retraction(retract_ml)).unwrap();
        planned_ml += prepared.plan.planned_ml();
        planned_ml += prepared.retraction.as_ref().map_or(0.0, |back| back.plan.planned_ml());
        owes_ml = prepared.owes_ml();
        if n % 1000 == 500 {
            for volume_ml in [-0.7, 0.7] {
                let there_and_back = rehearsal.prepare(DoseRequest::dose(volume_ml)).unwrap();
                planned_ml += there_and_back.plan.planned_ml();
            }
        }
    }
    let last_retraction_ml = 0.05;
    assert!((owes_ml - last_retraction_ml).abs() < STEP_ML, "{owes_ml}");
    assert!((planned_ml + owes_ml - 1000.0).abs() < 1e-6, "{planned_ml} {owes_ml}");
}

#[test]
fn the_files_of_a_dose_hold_its_retraction() {
    let user = User::new();
    // A row of steps has number, time, direction and angle; a row of the trace ends with the volume delivered.
    let files = ["--steps", "steps.csv", "--trace", "trace.csv", "--dt", "10ms"];
    let report = user.json(&[&["5mL", "--retract", "200uL", "--dry-run"][..], &files].concat());
    let (steps, back) = (number(&report, "steps"), number(&report, "retract_steps"));
    assert!(steps > 0.0 && back < 0.0, "{report}");

    let made = rows(&user.path("steps.csv")).1;
    assert_eq!(made.len() as f64, steps - back);
    let (forward, reverse) = made.split_at(steps as usize);
    assert!(forward.iter().all(|row| row[2] == 1.0) && reverse.iter().all(|row| row[2] == -1.0));
    assert!(made.windows(2).all(|rows| rows[1][0] == rows[0][0] + 1.0 && rows[1][1] > rows[0][1]));
    let end_rad = number(&report, "end_angle_deg").to_radians();
    assert!((made.last().unwrap()[3] - end_rad).abs() < 1e-9);
    // The retraction waits until the line has settled.
    let waited_s = reverse[0][1] - forward.last().unwrap()[1];
    assert!(waited_s > number(&report, "settle_s"), "{waited_s}");

    // Once the line has settled again, the vessel has the dose less what was sucked back.
    let trace = rows(&user.path("trace.csv")).1;
    let last = trace.last().unwrap();
    let left_ml = number(&report, "planned_ml") - number(&report, "retraction_ml");
    assert!((last[7] - left_ml).abs() < 0.002, "{} and {left_ml}", last[7]);
    assert!((last[1] - end_rad).abs() < 1e-9);
    // A dose that was made tells the same count, and a dose without a retraction tells none.
    let run = user.json(&["5mL", "--retract", "200uL"]);
    assert_eq!(number(&run, "retract_steps"), back);
    assert!(user.json(&["5mL"])["retract_steps"].is_null());
}
