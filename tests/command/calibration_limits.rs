//! Limits of weighed runs as typed, and speeds of runs that leave out the default rate.

use std::fs;

use crate::user::User;

/// Volume of a revolution by the model, mL.
const REVOLUTION_ML: f64 = 21.318_486_6;

/// A table of runs of three revolutions at these speeds, each `factor` times the model.
fn table(user: &User, speeds_rpm: &[f64], factor: f64) {
    let mut text = "speed_rpm,revolutions,volume_ml\n".to_owned();
    for rpm in speeds_rpm {
        text.push_str(&format!("{rpm},3,{}\n", 3.0 * REVOLUTION_ML * factor));
    }
    fs::write(user.path("runs.csv"), text).unwrap();
}

#[test]
fn what_is_refused_as_a_dose_is_refused_as_a_weighed_run() {
    let user = User::new();
    // The outlet reaches 108.2 kPa at 100 r/min by the model, and 114.0 with 1.3 times its displacement.
    let file = user.types(&["pumps", "show", "three-roller"]).out + "\n[limits]\nmax_outlet_kpa = 111.0\n";
    fs::write(user.path("limited.toml"), file).unwrap();
    let pump = ["--pump", "limited.toml"];
    let typed = |words: &[&'static str]| [words, &pump].concat();
    table(&user, &[60.0], 1.3);
    assert_eq!(user.types(&typed(&["calibrate", "run", "--from", "runs.csv"])).code, 0);
    for words in [
        &["56mL", "--speed", "100rpm"][..],
        &["prime", "56mL", "--speed", "100rpm"],
        &["purge", "56mL", "--speed", "100rpm"],
        &["calibrate", "run", "--speeds", "100rpm", "--runs", "1"],
        &[
            "calibrate",
            "verify",
            "--volume",
            "56mL",
            "--speed",
            "100rpm",
            "--systematic",
            "1%",
            "--random",
            "1%",
        ],
    ] {
        let refused = user.types(&typed(words));
        assert_eq!(refused.code, 2, "{words:?}: {}{}", refused.out, refused.err);
        assert!(refused.err.contains("limit of 111.00 kPa"), "{words:?}: {}", refused.err);
        assert_eq!(user.record(), None, "{words:?}");
    }
    // Without the calibration the model is the best knowledge.
    assert_eq!(user.types(&typed(&["calibrate", "use", "none"])).code, 0);
    assert_eq!(user.types(&typed(&["56mL", "--speed", "100rpm"])).code, 0);
    let run = user.types(&typed(&["calibrate", "run", "--speeds", "100rpm", "--runs", "1"]));
    assert!(run.code == 1 && run.err.contains("trial run: moving"), "{}", run.err);
}

#[test]
fn the_default_rate_is_among_the_speeds_of_guided_runs_and_a_table_without_it_says_so() {
    let user = User::new();
    let warning = "the default rate of 5 mL/s takes 14.072 r/min, and the runs cover 20 to 60 r/min: doses that \
                   name no other rate will be refused";
    let guided = ["calibrate", "run", "--speeds", "20rpm,60rpm", "--runs", "1", "--pitches", "1"];
    let begun = user.types(&guided);
    let added = "--speeds leaves out the default rate of 5 mL/s, 14.0723 r/min: runs at 11.7269 r/min are added\n\
                 3 runs of 1 pitch,";
    let said = begun.err.find(added).unwrap_or_else(|| panic!("{}", begun.err));
    assert!(said < begun.err.find("moving").unwrap(), "{}", begun.err);
    // A fast one comes besides slow ones, and one speed alone is used at every speed.
    // So does one that leaves no room for a factor which the runs may show, and that of the rate between two far ones.
    let courses = [
        ("5rpm,10rpm", "3 runs of"),
        ("60rpm,20rpm", "3 runs of"),
        ("14rpm,60rpm", "3 runs of"),
        ("8rpm,60rpm", "3 runs of"),
        ("10rpm,60rpm", "3 runs of"),
        ("60rpm", "1 run of"),
    ];
    for (speeds, runs) in courses {
        let dry = user.types(&["calibrate", "run", "--speeds", speeds, "--runs", "1", "--anew", "--dry-run"]);
        assert!(dry.code == 0 && dry.err.contains(runs), "{speeds}: {}", dry.err);
    }
    let run_at = |speeds| user.types(&["calibrate", "run", "--speeds", speeds, "--runs", "1", "--anew"]);
    assert!(!run_at("10rpm,14rpm,60rpm").err.contains("default rate"));
    assert!(run_at("60rpm").err.contains("14.0723 r/min: the factor of the one speed is used there too"));
    assert!(!run_at("14rpm").err.contains("default rate"));

    table(&user, &[20.0, 60.0], 1.0);
    let from = ["calibrate", "run", "--from", "runs.csv"];
    let told = user.types(&from);
    assert!(told.out.contains(&format!("warning: {warning}")), "{}", told.out);
    assert!(user.json(&from)["warnings"].to_string().contains(warning));
    assert!(user.is_refused(&["25mL"]).contains("5 mL/s is beyond"), "what the warning says");
    for covering in [&[10.0, 60.0][..], &[60.0]] {
        table(&user, covering, 1.0);
        assert!(!user.json(&from)["warnings"].to_string().contains("default rate"), "{covering:?}");
        assert_eq!(user.types(&["25mL", "--dry-run"]).code, 0, "{covering:?}");
    }
}
