//! Doses from an angle that is as well known as its source.

use serde_json::Value;

use crate::user::{User, number};

/// The standard uncertainty of a share of a report's budget, mL.
fn share_ml(report: &Value, source: &str) -> f64 {
    let shares = report["uncertainty_budget"].as_array().unwrap();
    number(shares.iter().find(|share| share["source"] == source).unwrap(), "standard_ml")
}

#[test]
fn a_tolerance_widens_the_uncertainty_and_not_the_plan() {
    let user = User::new();
    let dry = |angle: &str| user.json(&["1mL", "--start-angle", angle, "--dry-run"]);
    let exact = dry("30deg+-0deg");
    assert_eq!(share_ml(&exact, "angle"), 0.0);
    assert_eq!(exact["volume_least_ml"], exact["planned_ml"]);
    for angle in ["30deg+-1deg", "30deg\u{b1}1deg", "30 deg +/- 1 deg"] {
        let stated = dry(angle);
        for same in ["steps", "planned_ml", "carry_ml", "start_angle_deg", "end_angle_deg", "motion_s"] {
            assert_eq!(stated[same], exact[same], "{same}");
        }
        assert!((number(&stated["phase"], "half_width_deg") - 1.0).abs() < 1e-12);
        assert_eq!(stated["warnings"].as_array().unwrap().len(), 0, "{stated}");
        // From 30 deg the first millilitre ends where the flow is another: its range over the tolerance is the
        // difference of the volume curve, and the share is less than half of it.
        let width_ml = number(&stated, "volume_most_ml") - number(&stated, "volume_least_ml");
        assert!(width_ml > 0.01, "{stated}");
        assert!((0.25..0.5).contains(&(share_ml(&stated, "angle") / width_ml)), "{stated}");
        assert!(number(&stated, "expanded_uncertainty_ml") > number(&exact, "expanded_uncertainty_ml"));
    }
    // A wide tolerance is no statement: the worst case counts.
    let wide = dry("30deg+-5deg");
    assert_eq!(share_ml(&wide, "angle"), 0.0);
    assert!(share_ml(&wide, "phase") > 0.0);
}

#[test]
fn a_bare_angle_is_taken_to_a_degree_and_the_command_says_so_once() {
    let user = User::new();
    let report = user.json(&["1mL", "--start-angle", "30deg", "--dry-run"]);
    assert!((number(&report["phase"], "half_width_deg") - 1.0).abs() < 1e-12);
    let said = "the start angle has no tolerance: 1 deg either way is assumed; 30deg+-0deg is exact";
    assert_eq!(report["warnings"], serde_json::json!([said]));
    let text = user.types(&["1mL", "--start-angle", "30deg"]).out;
    assert_eq!(text.matches("1 deg either way is assumed").count(), 1, "{text}");
    // The second dose of a batch goes on from the record.
    let batch = user.types(&["1mL", "--repeat", "2", "--start-angle", "30deg"]).out;
    assert_eq!(batch.matches("1 deg either way is assumed").count(), 1, "{batch}");
    assert!((number(&user.json(&["status"]), "half_width_deg") - 1.0).abs() < 1e-9);
}

#[test]
fn a_bare_angle_of_a_head_without_a_drawing_is_taken_to_eleven_degrees() {
    let user = User::new();
    let file = user.path("acid.toml").display().to_string();
    let new = ["pumps", "new", "--ml-per-rev", "0.5mL", "--rollers", "4", "--steps-per-rev", "3200", &file];
    assert_eq!(user.types(&new).code, 0);
    let pump = ["--pump", &file];
    let out = user.types(&[&["home", "--set", "30deg"], &pump[..]].concat()).out;
    assert!(out.contains("11 deg either way is assumed; --tolerance 0deg is exact"), "{out}");
    let report = user.json(&[&["1mL", "--start-angle", "30deg", "--dry-run"], &pump[..]].concat());
    assert!((number(&report["phase"], "half_width_deg") - 11.0).abs() < 1e-9, "{report}");
    assert!(report["warnings"].to_string().contains("11 deg either way is assumed; 30deg+-0deg is exact"));
}

#[test]
fn the_tolerance_of_a_set_angle_stays_on_record_until_the_rotor_is_homed_anew() {
    let user = User::new();
    let home = |words: &[&str]| {
        let answer = user.types(&[&["home"], words].concat());
        assert_eq!(answer.code, 0, "{}", answer.err);
        answer.out
    };
    let half_width_deg = || number(&user.json(&["status"]), "half_width_deg");
    for (words, deg) in [
        (&["--set", "30deg", "--tolerance", "0.5deg"][..], 0.5),
        (&["--set", "30deg+-0.25deg"], 0.25),
        (&["--set", "30deg", "--mark-tolerance", "1.5deg"], 1.5),
        (&["--set", "30deg+-0deg"], 0.0),
    ] {
        let out = home(words);
        assert!(!out.contains("assumed"), "{out}");
        assert!((half_width_deg() - deg).abs() < 1e-9, "{words:?}");
    }
    let out = home(&["--set", "30deg"]);
    assert!(out.contains("the rollers stand at 30.00\u{b0} \u{b1} 1.00\u{b0}\n"), "{out}");
    assert!(
        out.contains("no tolerance was stated: 1 deg either way is assumed; --tolerance 0deg is exact\n"),
        "{out}"
    );
    // Steps are counted exactly, so the width stays, and each dose has its share.
    for volume in ["1mL", "2.5mL", "-1mL", "0.5mL"] {
        let report = user.json(&[volume]);
        assert!((number(&report["phase"], "half_width_deg") - 1.0).abs() < 1e-9, "{report}");
        let width_ml = number(&report, "volume_most_ml") - number(&report, "volume_least_ml");
        assert_eq!(share_ml(&report, "angle") > 1e-9, width_ml > 1e-8, "{report}");
        // The tolerance is in each dose's own volume, so it makes no carry unsure.
        assert!(
            share_ml(&report, "carry") < 1e-4 && number(&report, "carry_half_width_ml") > 0.0,
            "{report}"
        );
        assert!(!report["warnings"].to_string().contains("carry unsure"), "{report}");
        assert!((half_width_deg() - 1.0).abs() < 1e-9);
    }
    // A dose from a given angle replaces it.
    user.json(&["1mL", "--start-angle", "10deg+-0.5deg"]);
    assert!((half_width_deg() - 0.5).abs() < 1e-9);
}

#[test]
fn a_tolerance_that_is_none_is_refused_with_the_range() {
    let user = User::new();
    for words in [
        &["1mL", "--start-angle", "30deg+-200deg"][..],
        &["home", "--set", "30deg+-200deg"],
        &["home", "--set", "30deg", "--tolerance", "200deg"],
    ] {
        let message = user.is_refused(words);
        assert!(message.contains("200 deg; allowed: 0 to 180 deg"), "{message}");
    }
    let message = user.is_refused(&["home", "--set", "30deg+-1deg", "--tolerance", "1deg"]);
    assert!(message.contains("give one of them"), "{message}");
    let message = user.is_refused(&["home", "--unknown", "--tolerance", "1deg"]);
    assert!(message.contains("--tolerance") && message.contains("--unknown"), "{message}");
    assert_eq!(user.json(&["status"])["recorded"], false);
}
