//! The life of a tube, and its replacement.

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::user::{User, number};

#[test]
fn a_tube_is_warned_of_from_nine_tenths_on_and_refused_at_its_end() {
    let user = User::new();
    let limit = ["--tube-limit", "100mL"];
    let dose = |volume| user.json(&[&[volume][..], &limit].concat());
    assert_eq!(dose("40mL")["warnings"], serde_json::json!([]));
    assert_eq!(dose("-45mL")["warnings"], serde_json::json!([]), "85 mL either way");
    let report = dose("6mL");
    let warning = report["warnings"][0].as_str().unwrap();
    assert!(warning.contains("91.0 mL of its life of 100 mL; 9.0 mL are left"), "{warning}");
    for arguments in [&["10mL"][..], &["prime", "10mL"], &["10mL", "--dry-run"]] {
        let message = user.is_refused(&[arguments, &limit].concat());
        assert!(
            message.contains("has pumped 91.0 mL") && message.contains("its life of 100 mL"),
            "{message}"
        );
        assert!(message.contains("replace the tube and run `dose tube --new`"), "{message}");
    }
    let status = user.types(&["status", "--tube-limit", "100mL"]).out;
    assert!(status.contains("tube: 91.0 mL of 100 mL in"), "{status}");
    user.json(&["10mL"]);
}

#[test]
fn a_batch_ends_where_the_tube_does_also_in_its_rehearsal() {
    let user = User::new();
    let arguments = ["10mL", "--repeat", "9", "--tube-limit", "35mL", "--format", "json"];
    let rehearsed = user.types(&[&arguments[..], &["--dry-run"]].concat());
    let made = user.types(&arguments);
    for (answer, verb, code) in [(rehearsed, "planned", 2), (made, "done", 1)] {
        assert_eq!((answer.code, answer.out.lines().count()), (code, 3), "{}", answer.err);
        let count = format!("`dose tube --new`; 3 of 9 doses of the batch were {verb}");
        assert!(answer.err.contains(&count), "{}", answer.err);
    }
}

#[test]
fn the_pump_file_says_how_long_a_tube_lasts_and_the_option_overrides_it() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    assert!(!three.contains("life_ml"), "nobody knows it for the built-in pumps");
    let write = |life: &str| {
        let text =
            three.replace("outer_radius_mm = 7.0\n", &format!("outer_radius_mm = 7.0\nlife_ml = {life}\n"));
        fs::write(user.path("my.toml"), text).unwrap();
    };
    write("5.0");
    assert!(user.types(&["pumps", "show", "my.toml"]).out.contains("life_ml = 5.0"));
    assert!(user.is_refused(&["10mL", "--pump", "my.toml"]).contains("its life of 5 mL"));
    user.json(&["10mL", "--pump", "my.toml", "--tube-limit", "1L"]);
    for life in ["0.0", "-1.0", "nan", "inf"] {
        write(life);
        let message = user.is_refused(&["10mL", "--pump", "my.toml"]);
        assert!(
            message.contains("[tube] life_ml is ") && message.contains("allowed: more than 0"),
            "{message}"
        );
    }
    assert!(user.is_refused(&["1mL", "--tube-limit", "0L"]).contains("is zero"));
    assert!(user.is_refused(&["1mL", "--tube-limit", "5kg"]).contains("which is a mass unit"));
}

#[test]
fn a_tube_may_last_for_hours_or_revolutions_and_the_first_that_is_reached_counts() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let write = |lives: &str| {
        let text = three.replace("outer_radius_mm = 7.0\n", &format!("outer_radius_mm = 7.0\n{lives}\n"));
        fs::write(user.path("my.toml"), text).unwrap();
    };
    // 25 mL are 1.2 revolutions in some 5 s.
    write("life_ml = 1000.0\nlife_rev = 2.0\nlife_h = 1.0");
    user.json(&["25mL", "--pump", "my.toml"]);
    let refused = user.is_refused(&["25mL", "--pump", "my.toml"]);
    assert!(
        refused.contains("has turned 1.2 revolutions") && refused.contains("its life of 2 revolutions"),
        "{refused}"
    );
    let tube = user.json(&["tube", "--pump", "my.toml"]);
    assert!((number(&tube, "used_part") - number(&tube, "revolutions") / 2.0).abs() < 1e-12, "{tube}");
    write("life_ml = 1000.0\nlife_h = 0.002");
    let refused = user.is_refused(&["25mL", "--pump", "my.toml"]);
    assert!(refused.contains("would exceed its life of 0.002 h"), "{refused}");
    for (limit, words) in [("2rev", "its life of 2 revolutions"), ("7s", "h"), ("30mL", "30 mL")] {
        let refused = user.is_refused(&["25mL", "--tube-limit", limit]);
        assert!(refused.contains(words), "{limit}: {refused}");
    }
    let status = user.json(&["status", "--tube-limit", "500h"]);
    assert_eq!((number(&status, "tube_life_h"), &status["tube_life_ml"]), (500.0, &serde_json::Value::Null));
    // A run until it is stopped ends before the tube does.
    let run = user.json(&["run", "--rate", "5mL/s", "--dry-run", "--tube-limit", "1h"]);
    assert!((number(&run, "motion_s") / 3600.0 - 0.98).abs() < 0.02, "{run}");
    for key in ["life_h", "life_rev"] {
        write(&format!("{key} = 0.0"));
        let message = user.is_refused(&["10mL", "--pump", "my.toml"]);
        assert!(message.contains(&format!("[tube] {key} is ")), "{message}");
    }
}

#[test]
fn a_new_tube_has_pumped_nothing_and_doses_owe_nothing() {
    let user = User::new();
    let before = user.json(&["10mL"]);
    let owed = number(&before, "carry_ml");
    assert_ne!(owed, 0.0);
    let answer = user.types(&["tube", "--new"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("the one before pumped 10.0 mL"), "{}", answer.out);
    assert!(answer.out.contains(&format!("warning: a carry of {:.2} µL is dropped", 1e3 * owed)));
    assert!(answer.out.contains("volume per revolution: calibrate it"), "{}", answer.out);
    assert!(user.record().unwrap().lines().last().unwrap().contains("\"new_tube\""));
    let status = user.json(&["status"]);
    assert_eq!((number(&status, "carry_ml"), number(&status["wear"], "volume_ml")), (0.0, 0.0));
    assert_eq!(number(&status["wear"], "revolutions"), 0.0);
    assert!((number(&status, "angle_deg") - number(&before, "end_angle_deg").rem_euclid(360.0)).abs() < 1e-9);
    assert!(!user.types(&["tube", "--new"]).out.contains("dropped"));
    assert_eq!(user.types(&["tube"]).code, 0, "nothing is reset by half a command");
    assert!(user.is_refused(&["tube", "--new", "--dry-run"]).contains("`dose tube` takes no --dry-run"));
}

#[test]
fn a_tube_is_not_exchanged_under_an_unfinished_dose_which_may_end_on_it() {
    let user = User::new();
    let mut child = user.command(&["1L"]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    while !user.record().is_some_and(|text| text.contains("progress")) {
        assert!(Instant::now() < deadline, "no progress on record");
        sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let before = user.record();
    let refused = user.types(&["tube", "--new"]);
    assert_eq!(refused.code, 4, "{}", refused.err);
    assert!(
        refused.err.contains("`dose resume`") && refused.err.contains("`dose accept`"),
        "{}",
        refused.err
    );
    assert_eq!(user.record(), before);
    // Whatever the file says by now: the dose was accepted when it began.
    let file =
        user.types(&["pumps", "show", "three-roller"]).out.replace("[rollers]", "life_ml = 1.0\n\n[rollers]");
    fs::write(user.path("my.toml"), file).unwrap();
    let rest = user.json(&["resume", "--pump", "my.toml"]);
    assert!(rest["warnings"][0].as_str().unwrap().contains("0.0 mL are left"), "{rest}");
    assert_eq!(user.types(&["tube", "--new"]).code, 0);
}

#[test]
fn a_dose_that_was_cut_off_wears_the_tube_by_the_most_that_it_may_have_pumped() {
    let user = User::new();
    user.json(&["5mL", "--start-angle", "30deg+-20deg"]);
    let worn_l = || number(&user.json(&["tube"]), "volume_l");
    let before_l = worn_l();
    let mut child = user.command(&["1L", "--pace", "real"]).stdout(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    let moved = || {
        user.json(&["status"])["unfinished"]["delivered_most_ml"]
            .as_f64()
            .is_some_and(|most_ml| most_ml > 0.0)
    };
    while !moved() {
        assert!(Instant::now() < deadline, "nothing has moved");
        sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(user.types(&["accept"]).code, 0);
    let cut = user.types(&["log", "--format", "json"]).out;
    let cut: serde_json::Value = serde_json::from_str(cut.lines().last().unwrap()).unwrap();
    let most_ml =
        number(cut["doses"].as_array().map_or(&cut, |doses| doses.last().unwrap()), "delivered_most_ml");
    let worn_ml = 1e3 * (worn_l() - before_l);
    assert!((worn_ml - most_ml).abs() < 1e-6, "{worn_ml} for {most_ml}");
}

/// The stored calibrations of the simulated pump, oldest first.
fn calibrations(user: &User) -> Vec<std::path::PathBuf> {
    let folder = fs::read_dir(user.path("state/three-roller/sim/calibrations")).unwrap();
    let mut files: Vec<_> = folder.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    files
}

#[test]
fn a_tube_without_a_calibration_has_no_picture_and_a_life_names_its_units() {
    let user = User::new();
    let refused = user.is_refused(&["tube", "--plot", "tube.svg"]);
    assert!(refused.contains("this tube has no calibration on record; calibrate it first"), "{refused}");
    assert!(!user.path("tube.svg").exists());
    for wrong in ["0h", "-5h"] {
        let refused = user.is_refused(&["tube", &format!("--tube-limit={wrong}")]);
        assert!(refused.contains(wrong) && !refused.contains("unknown"), "{refused}");
    }
    let refused = user.is_refused(&["tube", "--tube-limit", "3"]);
    for unit in ["L, mL", "h, d", "rev"] {
        assert!(refused.contains(unit), "{refused}");
    }
}

#[test]
fn a_tube_tells_its_life_its_drift_and_when_to_calibrate_it_again() {
    let user = User::new();
    user.json(&["25mL"]);
    // Equal runs three times, each with 0.5 % less volume than before, thirty days apart.
    for (number, day) in ["2026-01-01", "2026-01-31", "2026-03-02"].into_iter().enumerate() {
        let fresh = user.types(&["tube"]);
        assert!(fresh.out.contains("calibrate again by: unknown, since"), "{}", fresh.out);
        let volumes_ml = [64.0, 64.1, 63.9].map(|volume_ml| volume_ml * (1.0 - 0.005 * number as f64));
        let rows = volumes_ml.map(|volume_ml| format!("40,3,{volume_ml}\n")).concat();
        fs::write(user.path("runs.csv"), format!("speed_rpm,revolutions,volume_ml\n{rows}")).unwrap();
        let made = user.types(&["calibrate", "run", "--from", "runs.csv"]);
        assert_eq!(made.code, 0, "{}", made.err);
        let path = calibrations(&user).pop().unwrap();
        let mut stored: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        stored["date"] = format!("{day}T12:00:00Z").into();
        fs::write(path, stored.to_string()).unwrap();
    }
    let tube = user.json(&["tube", "--tube-limit", "100L"]);
    assert_eq!(
        (&tube["schema"], &tube["tube"], &tube["life_l"]),
        (&"tube/1".into(), &1.into(), &100.0.into())
    );
    assert!((number(&tube, "volume_l") - 0.025).abs() < 1e-4, "{tube}");
    // Three points at equal distances, of nearly equal weight: the slope is that from the first to the last.
    let found: Vec<f64> =
        tube["calibrations"].as_array().unwrap().iter().map(|one| number(one, "factor")).collect();
    let drift = (found[2] - found[0]) / 2.0 / found[2];
    assert!((number(&tube, "drift_per_30_days") / drift - 1.0).abs() < 0.01 && drift < -0.004, "{tube}");
    let by = tube["calibrate_again_by"].as_str().unwrap();
    assert!(("2026-03-03".."2026-06-01").contains(&by), "{by}");
    let text = user.types(&["tube"]).out;
    assert!(
        text.contains(&format!("calibrate again by {by}, which was "))
            && text.contains(" days ago: ")
            && text.contains("in 30 days (k = 2)"),
        "{text}"
    );
    // The picture falls from its left to its right.
    let rows: Vec<&str> = text.lines().filter(|line| line.contains('|') && line.contains('o')).collect();
    assert!(rows.len() == 3 && rows[0].find('o') < rows[2].find('o'), "{text}");
    assert!(text.contains("0 to 60 days"), "{text}");
    assert_eq!(user.types(&["tube", "--plot", "tube.svg"]).code, 0);
    assert!(fs::read_to_string(user.path("tube.svg")).unwrap().contains("days since the first calibration"));
    // A new tube has none of them, though the calibrations came after the last dose of the old one.
    assert_eq!(user.types(&["tube", "--new"]).code, 0);
    let second = user.json(&["tube"]);
    assert_eq!((&second["tube"], &second["calibrations"]), (&2.into(), &serde_json::json!([])), "{second}");
    assert!(second["calibrate_again_by"].is_null() && second["drift_per_30_days"].is_null(), "{second}");
    // One that is made now is its own, whatever the clock says.
    assert_eq!(user.types(&["calibrate", "run", "--from", "runs.csv"]).code, 0);
    let path = calibrations(&user).pop().unwrap();
    let mut stored: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!(stored["tube_number"], 2);
    stored["date"] = "2000-01-01T00:00:00Z".into();
    fs::write(path, stored.to_string()).unwrap();
    assert_eq!(user.json(&["tube"])["calibrations"].as_array().unwrap().len(), 1);
}

#[test]
fn a_reading_that_another_one_replaced_is_no_point_of_the_tubes_course() {
    let user = User::new();
    user.json(&["30mL", "--start-angle", "0deg+-0deg"]);
    for reading in ["29.8g", "29.7g", "29.75g", "29.72g"] {
        assert_eq!(user.types(&["calibrate", "last", reading]).code, 0);
    }
    assert_eq!(calibrations(&user).len(), 4);
    let tube = user.json(&["tube"]);
    let counted = tube["calibrations"].as_array().unwrap();
    assert!(counted.len() == 1 && counted[0]["version"] == 4, "{tube}");
    assert!(tube["drift_per_30_days"].is_null() && tube["calibrate_again_by"].is_null(), "{tube}");
    assert!(user.types(&["tube"]).out.contains("1 of 3 calibrations of this tube are on record"));
}

#[test]
fn calibrations_of_one_time_show_no_drift_and_no_course_and_the_reason_says_so() {
    let user = User::new();
    user.json(&["25mL"]);
    fs::write(user.path("runs.csv"), "speed_rpm,revolutions,volume_ml\n40,3,64.0\n40,3,64.1\n").unwrap();
    for _ in 0..3 {
        assert_eq!(user.types(&["calibrate", "run", "--from", "runs.csv"]).code, 0);
    }
    for path in calibrations(&user) {
        let mut stored: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        stored["date"] = "2026-01-01T12:00:00Z".into();
        fs::write(path, stored.to_string()).unwrap();
    }
    let text = user.types(&["tube"]).out;
    assert!(text.contains("unknown, since the 3 calibrations of this tube lie too close together"), "{text}");
    assert!(!text.contains("0 to 0 s") && !text.contains("3 of 3"), "{text}");
}

#[test]
fn a_calibration_without_the_number_of_its_tube_is_told_by_its_date() {
    let user = User::new();
    user.json(&["25mL"]);
    fs::write(user.path("runs.csv"), "speed_rpm,revolutions,volume_ml\n40,3,64.0\n40,3,64.1\n").unwrap();
    assert_eq!(user.types(&["calibrate", "run", "--from", "runs.csv"]).code, 0);
    assert_eq!(user.types(&["tube", "--new"]).code, 0);
    let path = calibrations(&user).pop().unwrap();
    let mut stored: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    for (date, count) in [("2000-01-01", 0), ("2999-01-01", 1)] {
        stored.as_object_mut().unwrap().remove("tube_number");
        stored["date"] = format!("{date}T12:00:00Z").into();
        fs::write(&path, stored.to_string()).unwrap();
        let tube = user.json(&["tube"]);
        assert_eq!(tube["calibrations"].as_array().unwrap().len(), count, "{date}: {tube}");
    }
}
