//! Claims about calibrations that doses use.

use std::fs;

use serde_json::Value;

use super::table;
use crate::user::{User, number};

#[test]
fn a_calibration_is_used_by_the_next_dose_and_left_by_a_new_tube() {
    let user = User::new();
    let before = user.json(&["25mL", "--dry-run"]);
    assert_eq!((before["volume_basis"].as_str(), &before["calibration"]), (Some("model"), &Value::Null));
    let runs =
        table(&user, "runs.csv", &[(10.0, 1.03), (10.0, 1.03), (60.0, 1.02), (60.0, 1.02), (110.0, 1.01)]);
    let said = user.types(&["calibrate", "run", "--from", &runs, "--tube", "A1"]);
    assert!(
        said.code == 0 && said.out.starts_with("calibration 1 of three-roller (sim): 5 runs"),
        "{}",
        said.err
    );
    let after = user.json(&["25mL", "--speed", "60rpm"]);
    assert_eq!(after["volume_basis"], "calibrated");
    assert_eq!(after["calibration"]["version"], 1);
    assert!((number(&after["calibration"], "displacement_factor") - 1.02).abs() < 1e-6);
    assert!((number(&after, "planned_ml") - 25.0).abs() < 2e-3);
    assert!((number(&after, "delivered_ml") - number(&after, "planned_ml")).abs() < 1e-5);
    assert!(number(&after, "expanded_uncertainty_ml") < 0.3 * number(&before, "expanded_uncertainty_ml"));
    let from_zero = ["--speed", "60rpm", "--start-angle", "0deg", "--dry-run"];
    let steps = |volume: &str| number(&user.json(&[&[volume][..], &from_zero].concat()), "steps");
    let calibrated = steps("25mL");
    // Status and the journal know what was delivered.
    let status = user.types(&["status"]).out;
    assert!(status.contains("tube: 25.0 mL"), "{status}");

    assert!(user.types(&["calibrate", "list"]).out.contains("*   1"));
    let tube = user.types(&["tube", "--new"]).out;
    assert!(tube.contains("calibration 1 is not used any more"), "{tube}");
    assert_eq!(user.json(&["25mL", "--dry-run"])["volume_basis"], "model");
    assert!((steps("24.5098039mL") - calibrated).abs() <= 2.0, "25 mL over 1.02");
    user.types(&["calibrate", "use", "1"]);
    assert_eq!(user.json(&["25mL", "--speed", "60rpm", "--dry-run"])["volume_basis"], "calibrated");
    assert_eq!(user.types(&["calibrate", "use", "none"]).code, 0);
    assert_eq!(user.json(&["25mL", "--dry-run"])["volume_basis"], "model");
    let list = user.json(&["calibrate", "list"]);
    assert_eq!((&list["active"], &list["calibrations"][0]["tube"]), (&Value::Null, &Value::from("A1")));
    assert_eq!(list["calibrations"][0]["runs"].as_array().unwrap().len(), 5);
}

#[test]
fn doses_outside_the_calibrated_speeds_are_refused() {
    let user = User::new();
    let runs = table(&user, "runs.csv", &[(20.0, 1.0), (60.0, 1.0), (100.0, 1.0)]);
    assert_eq!(user.types(&["calibrate", "run", "--from", &runs]).code, 0);
    let message = user.is_refused(&["25mL"]);
    assert!(
        message.contains("holds from 20.0000 to 100.0000 r/min") && message.contains("5 mL/s"),
        "{message}"
    );
    assert_eq!(user.types(&["25mL", "--rate", "10mL/s"]).code, 0);
}

#[test]
fn versions_are_never_overwritten_and_other_drivers_and_pumps_have_their_own() {
    let user = User::new();
    let runs = table(&user, "runs.csv", &[(14.0, 1.01)]);
    for _ in 0..2 {
        assert_eq!(user.types(&["calibrate", "run", "--from", &runs]).code, 0);
    }
    let folder = user.path("state/three-roller/sim/calibrations");
    let first = fs::read_to_string(folder.join("1.json")).unwrap();
    assert!(first.contains("\"volume_ml\": 64.5") && folder.join("2.json").exists());
    assert_eq!(fs::read_to_string(folder.join("active")).unwrap(), "2\n");
    let other = user.json(&["25mL", "--pump", "two-roller", "--dry-run"]);
    assert_eq!(other["volume_basis"], "model");
    assert!(user.types(&["calibrate", "list", "--driver", "grbl"]).out.contains("is not calibrated"));
}

#[test]
fn a_bad_table_is_refused_with_its_line_and_changes_nothing() {
    let user = User::new();
    for (text, part) in [
        ("speed_rpm,revolutions,volume_ml\n60,3,640\n", "run 1 gave 640.0000 mL"),
        ("speed_rpm,revolutions,volume_ml\n60,3\n", "runs.csv: line 2: 2 cells"),
        ("speed_rpm,turned_deg,volume_ml\n60,50,3\n", "from an unknown angle"),
        ("speed_rpm,revolutions,volume_ml\n", "0 runs"),
    ] {
        fs::write(user.path("runs.csv"), text).unwrap();
        let message = user.is_refused(&["calibrate", "run", "--from", "runs.csv"]);
        assert!(message.contains(part), "{message}");
    }
    assert!(user.is_refused(&["calibrate", "run", "--from", "none.csv"]).contains("none.csv"));
    assert!(user.is_refused(&["calibrate", "use", "7"]).contains("there is no calibration 7"));
    assert!(user.is_refused(&["calibrate", "use", "last"]).contains("`last` is no calibration"));
    assert!(
        user.is_refused(&["calibrate", "run", "--from", "runs.csv", "--rate", "5mL/s"]).contains("--rate")
    );
    assert!(user.types(&["calibrate", "list"]).out.contains("is not calibrated"));
}

#[test]
fn the_zero_that_short_doses_show_corrects_the_doses() {
    let user = User::new();
    // The doses of a pump whose rollers stand 25 deg further on than the record says.
    let mut text = "start_angle_deg,turned_deg,volume_ml\n".to_owned();
    for start in (0..120).step_by(8) {
        let from = format!("{}deg", start + 25);
        // The volume of 24 deg from there: by bisection over what a dose of that volume turns.
        let (mut low, mut high) = (0.05, 3.0);
        for _ in 0..14 {
            let middle = 0.5 * (low + high);
            let volume = format!("{middle}mL");
            let dose = user.json(&[&volume, "--start-angle", &from, "--dry-run", "--speed", "10rpm"]);
            let turned = number(&dose, "end_angle_deg") - number(&dose, "start_angle_deg");
            if turned < 24.0 { low = middle } else { high = middle }
        }
        text.push_str(&format!("{start},24,{}\n", 0.5 * (low + high)));
    }
    fs::write(user.path("short.csv"), text).unwrap();
    let found = user.json(&["calibrate", "phase", "--from", "short.csv", "--use"]);
    assert!((number(&found["found"]["zero_deg"], "value") - 25.0).abs() < 0.1, "{found}");
    assert!((number(&found["found"]["roller_volume_ml"], "value") - 2.1055).abs() < 0.01, "{found}");
    assert!(user.types(&["status"]).out.contains("doses use calibration 1 of"));
    let status = user.json(&["status"]);
    assert!((number(&status["calibration"], "roller_volume_ml") - 2.1055).abs() < 0.01, "{status}");
    let corrected = user.json(&["1mL", "--start-angle", "10deg"]);
    assert!((number(&corrected["calibration"], "roller_volume_ml") - 2.1055).abs() < 0.01, "{corrected}");
    assert_eq!(
        (corrected["volume_basis"].as_str(), corrected["calibration"]["version"].as_u64()),
        (Some("model"), Some(1))
    );
    user.types(&["calibrate", "use", "none"]);
    let there = user.json(&["1mL", "--start-angle", "35deg", "--dry-run"]);
    assert!((number(&there, "steps") - number(&corrected, "steps")).abs() <= 2.0);
    assert!((number(&corrected, "delivered_ml") - 1.0).abs() < 2e-3);
}

#[test]
fn the_check_of_a_weighed_pump_says_what_was_measured_and_by_how_much() {
    let user = User::new();
    let bought =
        ["pumps", "new", "--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "bought.toml"];
    assert_eq!(user.types(&bought).code, 0);
    let check = ["pumps", "check", "bought.toml"];
    let unweighed = user.types(&check).out;
    assert!(
        unweighed.contains("given     volume of a revolution") && !unweighed.contains("weighed"),
        "{unweighed}"
    );
    let runs = "speed_rpm,revolutions,volume_ml\n60,100,52\n60,100,52.1\n120,100,52\n120,100,52.1\n";
    fs::write(user.path("runs.csv"), runs).unwrap();
    let made = user.types(&["calibrate", "run", "--from", "runs.csv", "--pump", "bought.toml"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let weighed = user.types(&check).out;
    assert!(weighed.contains("  weighed   model volume times 1.04"), "{weighed}");
    assert!(
        weighed.contains("by calibration 1 of ") && weighed.contains("measured  volume of a revolution"),
        "{weighed}"
    );
    // A pump of another volume is none that was weighed.
    let text = fs::read_to_string(user.path("bought.toml")).unwrap();
    fs::write(user.path("bought.toml"), text.replace("ml_per_rev = 0.5", "ml_per_rev = 0.7")).unwrap();
    let other = user.types(&check).out;
    assert!(
        other.contains("calibration 1 is of a pump of 0.5 mL per revolution: doses refuse it"),
        "{other}"
    );
    assert!(other.contains("given     volume of a revolution"), "{other}");
}

#[test]
fn rollers_that_overlap_are_warned_of_by_simulations_and_sizings_too() {
    let user = User::new();
    let eight = user.types(&["pumps", "show", "three-roller"]).out.replace("count = 3", "count = 8");
    fs::write(user.path("eight.toml"), eight).unwrap();
    let of_pump = |words: &[&str]| user.types(&[words, &["--pump", "eight.toml"]].concat());
    let hoses = ["--inlet-hose", "6x10mm,1m", "--outlet-hose", "6x10mm,1m"];
    for words in [
        &["simulate", "--speed", "30rpm", "--duration", "1s"][..],
        &[&["size", "--flow", "20L/h"][..], &hoses].concat(),
    ] {
        let said = of_pump(words);
        assert!((said.out.clone() + &said.err).contains("overlap"), "{words:?}: {}{}", said.out, said.err);
    }
}

#[test]
fn a_calibration_that_is_less_sure_than_the_one_before_names_it() {
    let user = User::new();
    let factors = [(10.0, 1.03), (10.0, 1.031), (60.0, 1.03), (60.0, 1.031), (110.0, 1.03), (110.0, 1.031)];
    let sure = table(&user, "sure.csv", &factors);
    let unsure = table(&user, "unsure.csv", &[(10.0, 1.08), (60.0, 1.0), (110.0, 1.06)]);
    let run =
        |from: &str, more: &[&str]| user.types(&[&["calibrate", "run", "--from", from][..], more].concat());
    let told = |said: &str| {
        said.contains("and calibration 1 knew it to") && said.contains("`dose calibrate use <N>`")
    };
    assert!(!told(&run(&sure, &[]).out));
    let worse = run(&unsure, &["--dry-run"]).out;
    assert!(told(&worse), "{worse}");
    let kept = user.json(&["calibrate", "run", "--from", &unsure]);
    assert!(kept["warnings"].to_string().contains("and calibration 1 knew it to"), "{kept}");
    // One that is surer is told nothing, and so is that of another tube.
    assert!(!run(&sure, &[]).out.contains("knew it to"));
    assert_eq!(user.types(&["tube", "--new"]).code, 0);
    assert_eq!(user.types(&["calibrate", "use", "1"]).code, 0);
    assert!(!run(&unsure, &[]).out.contains("knew it to"));
}
