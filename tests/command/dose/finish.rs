//! Doses that end where the flow is low, as typed and reported.

use crate::user::{User, number};

#[test]
fn a_dose_that_ends_at_low_flow_carries_the_difference_and_says_what_would_not() {
    let user = User::new();
    let anywhere = user.json(&["25mL", "--dry-run"]);
    let low = user.json(&["25mL", "--finish", "low-flow"]);
    assert_eq!((&anywhere["finish"], &low["finish"]), (&"any".into(), &"low-flow".into()));
    let (planned, carry) = (number(&low, "planned_ml"), number(&low, "carry_ml"));
    assert!((planned + carry - 25.0).abs() < 1e-9 && carry.abs() > 0.1, "{low}");
    assert!((number(&low, "delivered_ml") - planned).abs() < 1e-6);
    // The next one owes it.
    let status = user.types(&["status"]);
    assert!(status.out.contains(&format!("{:.2} µL", 1e3 * carry.abs())), "{}", status.out);
    let warning = low["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("25 mL requested") && warning.contains(&format!("{:.2} µL", 1e3 * carry.abs())),
        "{warning}"
    );
    let offered = warning.split("carry nothing: ").last().unwrap().replace(" mL", "mL");
    assert_eq!(offered.split(" and ").count(), 2, "{warning}");
    let fresh = User::new();
    for volume in offered.split(" and ") {
        let exact = fresh.json(&[volume, "--finish", "low-flow", "--dry-run"]);
        // As near as the four decimals that were offered.
        assert!(
            number(&exact, "carry_ml").abs() < 1e-3
                && exact["warnings"].as_array().is_some_and(Vec::is_empty),
            "{exact}"
        );
    }
}

#[test]
fn a_low_flow_end_that_cannot_be_known_or_had_is_refused_by_name() {
    let user = User::new();
    let nearest = user.is_refused(&["0.1mL", "--finish", "low-flow"]);
    assert!(nearest.contains("no end at low flow is nearer"), "{nearest}");
    assert!(
        user.is_refused(&["prime", "5mL", "--finish", "low-flow"]).contains("`dose prime` takes no --finish")
    );
    assert!(user.is_refused(&["5mL", "--finish", "dry"]).contains("low-flow"));
    assert!(user.command(&["home", "--unknown"]).status().unwrap().success());
    let unknown = user.is_refused(&["25mL", "--finish", "low-flow"]);
    assert!(unknown.contains("a dose that ends at low flow needs the rollers' angle"), "{unknown}");
    user.json(&["25mL", "--finish", "low-flow", "--start-angle", "10deg", "--dry-run"]);
}

#[test]
fn what_is_carried_never_has_a_dose_run_the_other_way() {
    let user = User::new();
    assert!(user.command(&["home", "--set", "20deg"]).status().unwrap().success());
    let much = user.json(&["25mL", "--finish", "low-flow"]);
    let carry_ml = number(&much, "carry_ml");
    assert!(carry_ml < -3.0, "{much}");
    let refused = user.is_refused(&["1mL"]);
    assert!(refused.contains("would have the pump run the other way, by -2.2"), "{refused}");
    assert!((number(&user.json(&["status"]), "carry_ml") - carry_ml).abs() < 1e-12);
    let more = user.json(&["10mL"]);
    assert!((number(&more, "planned_ml") - 10.0 - carry_ml).abs() < 2e-3, "{more}");
}

#[test]
fn a_batch_of_which_a_dose_finds_no_end_at_low_flow_is_refused_before_its_first_dose() {
    let user = User::new();
    let batch = ["2mL", "--finish", "low-flow", "--repeat", "8"];
    let refused = user.is_refused(&batch);
    assert!(refused.contains("no end at low flow is nearer"), "{refused}");
    assert!(refused.contains("this is dose 2 of 8 of the batch, and none was made"), "{refused}");
    // A rehearsal of the same batch stops there too.
    let rehearsed = user.types(&[&batch[..], &["--dry-run"]].concat());
    assert!(rehearsed.code == 2 && rehearsed.err.contains("1 of 8 doses"), "{}", rehearsed.err);
    let made = user.types(&["6mL", "--finish", "low-flow", "--repeat", "8"]);
    assert!(made.code == 0 && made.out.contains("dose 8 of 8"), "{}", made.err);
}
