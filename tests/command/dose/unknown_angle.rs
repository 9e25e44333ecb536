//! Doses of a rotor that somebody turned by hand.

use crate::user::{User, number};

/// A user whose pump has dosed, and was turned by hand since.
fn turned_by_hand() -> User {
    let user = User::new();
    user.json(&["1mL"]);
    let answer = user.types(&["home", "--unknown"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("stand at an unknown angle"), "{}", answer.out);
    assert!(answer.out.contains("µL is dropped"), "{}", answer.out);
    user
}

#[test]
fn a_dose_from_an_unknown_angle_says_between_which_volumes_it_lies_and_what_would_be_exact() {
    let user = turned_by_hand();
    assert!(user.types(&["status"]).out.contains("rotor at an unknown angle"));
    let dry = user.types(&["25mL", "--dry-run", "-v"]).out;
    for said in [
        "turned by 421.68° from an unknown angle",
        "the volume of the whole dose lies between 23.9477 and 26.0531 mL",
        "7.1062, 14.212, 21.318 mL and so on; nearest to 25 mL: 21.318 and 28.425 mL",
        "`dose home --set 0deg`, or give --start-angle",
    ] {
        assert!(dry.contains(said), "{said} in {dry}");
    }
    let report = user.json(&["25mL"]);
    assert_eq!(report["phase"]["known"], false);
    assert_eq!(report["carry_in_ml"], 0.0);
    let (least, most) = (number(&report, "volume_least_ml"), number(&report, "volume_most_ml"));
    assert!((least - 23.9477).abs() < 1e-4 && (most - 26.0531).abs() < 1e-4, "{report}");
    assert!((number(&report, "planned_ml") - 0.5 * (least + most)).abs() < 1e-12);
    assert!((number(&report, "planned_ml") + number(&report, "carry_ml") - 25.0).abs() < 1e-12);
    // A real motor's report could not say more than the text and the log.
    assert_eq!(number(&report, "delivered_ml"), number(&report, "planned_ml"), "{report}");
    assert!(number(&report, "expanded_uncertainty_ml") > 0.5 * (most - least), "{report}");
    let text = turned_by_hand().types(&["25mL"]).out;
    assert!(
        text.contains(
            ": 25.0 mL \u{b1} 2.1 mL delivered (23.95 to 26.05 mL by the rollers' angle alone), 25 mL requested"
        ),
        "{text}"
    );
    assert!(
        dry.contains("nothing recorded) (23.95 to 26.05 mL by the rollers' angle alone), 25 mL requested"),
        "{dry}"
    );
    let whole = user.types(&["7.1062mL", "--dry-run"]).out;
    assert!(
        whole.contains(": 7.11 mL \u{b1} 0.51 mL planned (dry run, nothing recorded) (7.106 to 7.107 mL by"),
        "{whole}"
    );
    assert!(report["warnings"].to_string().contains("exact at any angle"), "{report}");
}

#[test]
fn a_batch_and_a_run_from_an_unknown_angle_tell_the_volumes_that_the_log_has() {
    let user = turned_by_hand();
    let batch = user.types(&["5mL", "--repeat", "3"]).out;
    let of_log = |from: u64| -> f64 {
        let doses = user.types(&["log", "--format", "json"]).out;
        let rows = doses.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
        rows.filter(|row| row["number"].as_u64().unwrap() >= from)
            .map(|row| number(&row, "delivered_ml"))
            .sum()
    };
    let sum = format!(": 3 doses, {:.3} mL delivered in all, ", of_log(2));
    assert!(batch.contains(&sum), "{sum} in {batch}");
    let user = turned_by_hand();
    let run = user.json(&["run", "--rate", "60mL/min", "--volume", "5mL"]);
    let (delivered, seconds) = (number(&run, "delivered_ml"), number(&run, "measured_motion_s"));
    assert!((number(&run["run"], "mean_flow_ml_s") * seconds - delivered).abs() < 1e-9, "{run}");
    assert_eq!(delivered, number(&run, "planned_ml"));
}

#[test]
fn the_interval_of_a_later_dose_from_an_unknown_angle_holds_its_range() {
    let user = turned_by_hand();
    user.json(&["25mL"]);
    // Planned for the sum of both doses, so its own volume lies elsewhere than 1 mL.
    let report = user.json(&["1mL", "--dry-run"]);
    let (least, most) = (number(&report, "volume_least_ml"), number(&report, "volume_most_ml"));
    let unsure = number(&report, "expanded_uncertainty_ml");
    let planned = number(&report, "planned_ml");
    assert!((0.5 * (least + most) - planned).abs() > 0.1, "{report}");
    assert!(planned - unsure <= least && planned + unsure >= most, "{report}");
    let text = user.types(&["1mL", "--dry-run"]).out;
    assert!(text.contains(&format!(": {planned:.2} mL \u{b1} {unsure:.2} mL planned")), "{text}");
    assert!(!text.contains("nearest to 1 mL: 0.000"), "{text}");
}

#[test]
fn report_and_log_tell_one_volume_with_one_interval_of_a_dose_from_an_unknown_angle() {
    let user = turned_by_hand();
    user.json(&["25mL"]);
    let planned = user.json(&["1mL", "--dry-run"]);
    let text = user.types(&["1mL"]).out;
    let log = user.types(&["log", "--format", "json"]).out;
    let logged: serde_json::Value = serde_json::from_str(log.lines().last().unwrap()).unwrap();
    let [ml, unsure_ml] = ["delivered_ml", "expanded_uncertainty_ml"].map(|key| number(&logged, key));
    assert!((ml - number(&planned, "planned_ml")).abs() < 1e-12, "{logged} {planned}");
    assert!((unsure_ml - number(&planned, "expanded_uncertainty_ml")).abs() < 1e-12, "{logged} {planned}");
    assert!(text.contains(&format!(": {ml:.2} mL \u{b1} {unsure_ml:.2} mL delivered (")), "{text}");
}

#[test]
fn the_angle_stays_unknown_until_somebody_says_it() {
    let user = turned_by_hand();
    user.json(&["5mL"]);
    assert_eq!(user.json(&["status"])["angle_known"], false);
    let given = user.json(&["5mL", "--start-angle", "30deg+-0deg"]);
    assert_eq!(given["phase"]["known"], true);
    assert_eq!(given["warnings"].as_array().unwrap().len(), 0, "{given}");
    assert_eq!(given["volume_least_ml"], given["planned_ml"]);
    assert_eq!(given["volume_most_ml"], given["planned_ml"]);
    assert_eq!(user.json(&["status"])["angle_known"], true);

    let user = turned_by_hand();
    assert_eq!(user.types(&["home", "--set", "30deg"]).code, 0);
    assert_eq!(user.json(&["5mL"])["phase"]["known"], true);
}

#[test]
fn whole_pitches_lie_within_a_step_of_what_was_asked_at_any_angle() {
    let user = turned_by_hand();
    for volume in ["7.1062mL", "14.212mL", "-21.318mL"] {
        let report = user.json(&[volume, "--dry-run"]);
        let width = number(&report, "volume_most_ml") - number(&report, "volume_least_ml");
        assert!(width < 2.2e-3, "{report}");
    }
    let small = user.types(&["-0.5mL", "--dry-run"]).out;
    assert!(small.contains("nearest to -0.5 mL: -7.1062 mL;"), "{small}");
}

#[test]
fn an_angle_and_that_it_is_unknown_exclude_each_other() {
    for words in [&["home"][..], &["home", "--unknown", "--set", "3deg"]] {
        let message = User::new().is_refused(words);
        assert!(message.contains("--set") && message.contains("--unknown"), "{message}");
    }
}
