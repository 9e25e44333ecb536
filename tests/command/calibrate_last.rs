//! `dose calibrate last`, as a person at the bench uses it.

use crate::user::{User, number};

/// Volume of 1 g of water of 25 °C on a balance in air of 85.7 kPa, mL. From Z of ISO 8655-6 with the density of Kell
/// (1975), 997.047 kg/m³, and air of 1.001 kg/m³ at 50 % humidity.
const Z_ML_G: f64 = 1.003_84;

#[test]
fn the_weight_of_the_last_dose_calibrates_the_next() {
    let user = User::new();
    let before = user.json(&["10mL"]);
    let found = user.json(&["calibrate", "last", "10.20g"]);
    let factor = number(&found["displacement"], "factor");
    let expected = 10.2 * Z_ML_G / number(&before, "planned_ml");
    assert!((factor - expected).abs() < 2e-5, "{factor} {expected}");
    assert_eq!(found["source"], "last");
    let after = user.json(&["10mL"]);
    assert_eq!(after["volume_basis"], "calibrated");
    assert!(number(&after, "expanded_uncertainty_ml") < number(&before, "expanded_uncertainty_ml"));
    // A second dose joins the first, at the speed that its rate takes now.
    let said = user.types(&["calibrate", "last", "9.98g"]);
    assert!(said.code == 0 && said.out.contains("2 runs at"), "{}{}", said.out, said.err);
    assert_eq!(user.types(&["10mL"]).code, 0, "the default rate is still covered");
}

#[test]
fn a_coarser_scale_says_so_by_its_last_digit() {
    let user = User::new();
    user.json(&["10mL"]);
    let standard = |reading: &str| {
        let found = user.json(&["calibrate", "last", reading, "--anew", "--dry-run"]);
        number(&found["displacement"], "reading")
    };
    // Two readings, each known to a step over the square root of 12.
    let step = (2.0_f64 / 12.0).sqrt() / 9.97;
    assert!((standard("10.0g") / (0.1 * step) - 1.0).abs() < 0.01);
    assert!((standard("10.00g") / (0.01 * step) - 1.0).abs() < 0.01);
    assert!((standard("10g") / step - 1.0).abs() < 0.01);
}

#[test]
fn what_cannot_be_the_weight_of_the_last_dose_is_refused_and_nothing_is_kept() {
    let user = User::new();
    let refused = user.is_refused(&["calibrate", "last", "10g"]);
    assert!(refused.contains("no dose is on record") && refused.contains("dose calibrate last"), "{refused}");
    user.json(&["10mL"]);
    for (reading, part) in [("100g", "more than twice"), ("10", "has no unit"), ("-10g", "without sign")] {
        let refused = user.is_refused(&["calibrate", "last", reading]);
        assert!(refused.contains(part), "{reading}: {refused}");
    }
    let said = user.types(&["calibrate", "last", "10.1g", "--dry-run"]);
    assert!(said.code == 0 && said.out.contains("nothing is kept"), "{}", said.err);
    assert!(user.types(&["calibrate", "list"]).out.contains("is not calibrated"));
    user.json(&["prime", "5mL"]);
    assert!(user.is_refused(&["calibrate", "last", "5g"]).contains("primed"));
}

#[test]
fn a_calibration_by_runs_is_not_replaced_by_one_dose_unless_that_is_asked_for() {
    let user = User::new();
    let table = "speed_rpm,revolutions,volume_ml\n10,3,64.6\n10,3,64.7\n60,3,64.5\n60,3,64.6\n";
    std::fs::write(user.path("runs.csv"), table).unwrap();
    user.json(&["calibrate", "run", "--from", "runs.csv"]);
    user.json(&["10mL"]);
    let refused = user.is_refused(&["calibrate", "last", "10.1g"]);
    assert!(refused.contains("rests on 4 runs") && refused.contains("--add"), "{refused}");
    let added = user.json(&["calibrate", "last", "10.1g", "--add"]);
    assert_eq!(added["runs"].as_array().unwrap().len(), 5);
    let alone = user.json(&["calibrate", "last", "10.1g", "--anew"]);
    assert_eq!(alone["runs"].as_array().unwrap().len(), 1);
}
