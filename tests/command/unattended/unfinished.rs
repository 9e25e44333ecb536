//! An interrupted dose on record, by policy.

use std::fs;
use std::process::Stdio;

use serde_json::Value;

use crate::unattended::clock::with_room;
use crate::user::{User, number};

/// Leaves a dose of 3 L that was killed on its way.
fn killed(user: &User) {
    killed_with(user, &[]);
}

/// Leaves a dose of 3 L with these options that was killed on its way.
fn killed_with(user: &User, options: &[&str]) {
    let mut child = user
        .command(&[&["3L"][..], options].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    user.until_moved("three-roller");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!user.json(&["status"])["unfinished"].is_null());
}

fn reports(out: &str) -> Vec<Value> {
    out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_person_is_asked_unless_the_policy_says_otherwise() {
    let user = User::new();
    killed(&user);
    for ask in [&["1mL"][..], &["1mL", "--unfinished", "ask"], &["run", "--rate", "1mL/s", "--for", "2s"]] {
        assert_eq!(user.types(ask).code, 4, "{ask:?}");
    }
}

#[test]
fn an_interrupted_dose_is_resumed_first_and_reported_as_what_it_is() {
    let user = User::new();
    killed(&user);
    let answer = user.types(&["1mL", "--unfinished", "resume", "--format", "json"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let [rest, dose] = &reports(&answer.out)[..] else { panic!("{}", answer.out) };
    assert!((number(rest, "requested_ml") - 3000.0).abs() < 3000.0 && rest["completed"] == true);
    assert!(rest["warnings"].to_string().contains("the rest of an interrupted dose"), "{rest}");
    assert!((number(dose, "requested_ml") - 1.0).abs() < 1e-12);
    let logged = user.types(&["log", "--format", "json"]);
    let logged = reports(&logged.out);
    let ends: Vec<_> =
        logged.iter().map(|dose| (dose["end"].as_str().unwrap(), dose["resumed"] == true)).collect();
    assert_eq!(ends, [("cut-off", false), ("done", true), ("done", false)]);
    let sum: f64 = logged.iter().map(|dose| number(dose, "delivered_ml")).sum();
    let unsure = &logged[0]["delivered_least_ml"].as_f64().zip(logged[0]["delivered_most_ml"].as_f64());
    let half_ml = unsure.map_or(0.0, |(least, most)| 0.5 * (most - least));
    assert!((sum - 3001.0).abs() <= half_ml + 0.01, "{sum} within {half_ml}");
    assert!(user.json(&["status"])["unfinished"].is_null());
}

#[test]
fn an_interrupted_dose_is_accepted_and_the_report_says_so() {
    let user = User::new();
    killed(&user);
    let answer =
        user.types(&["run", "--rate", "2mL/s", "--for", "2s", "--unfinished", "accept", "--format", "json"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let [run] = &reports(&answer.out)[..] else { panic!("{}", answer.out) };
    let warnings = run["warnings"].to_string();
    assert!(warnings.contains("an interrupted dose of 3000 mL was accepted as it is"), "{warnings}");
    assert!(user.record().unwrap().contains("\"why\":\"discarded\""));
    assert!(user.json(&["status"])["unfinished"].is_null());
}

#[test]
fn a_dose_that_is_refused_says_that_the_interrupted_one_was_accepted() {
    let user = User::new();
    killed(&user);
    let refused = user.types(&["5mL", "--rate", "900mL/s", "--unfinished", "accept"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    let told = "warning: an interrupted dose of 3000 mL was accepted as it is (--unfinished accept)";
    assert_eq!(refused.err.matches(told).count(), 1, "{}", refused.err);
    assert!(user.json(&["status"])["unfinished"].is_null());
}

#[test]
fn a_rest_without_a_person_obeys_home_once_the_angle_was_disturbed() {
    let user = User::new();
    let pump = user.types(&["pumps", "show", "three-roller"]).out;
    let obeys = |home: &str| {
        fs::write(user.path("pump.toml"), format!("{pump}\n[safety]\nhome = \"{home}\"\n")).unwrap();
    };
    obeys("refuse");
    killed_with(&user, &["--pump", "pump.toml"]);
    assert_eq!(user.types(&["release", "--pump", "pump.toml"]).code, 0);
    let resume = || {
        let mut command = user.command(&["resume", "--pump", "pump.toml", "--format", "json"]);
        command.stdin(Stdio::null()).output().unwrap()
    };
    let stands = || {
        let status = user.json(&["status", "--pump", "pump.toml"]);
        (status["wear"].clone(), status["unfinished"].clone())
    };
    let before = stands();
    let refused = resume();
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let error: Value = serde_json::from_slice(&refused.stderr).unwrap();
    assert_eq!((&error["kind"], &error["moved"]), (&"angle".into(), &false.into()));
    assert_eq!(stands(), before, "nothing moved, and the dose is still unfinished");
    obeys("accept");
    let made = resume();
    assert_eq!(made.status.code(), Some(0), "{made:?}");
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    assert!(report["warnings"].to_string().contains("[safety] home = \\\"accept\\\""), "{report}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_dose_that_a_full_disk_ends_says_that_the_interrupted_one_was_accepted() {
    for words in [&["300mL"][..], &["300mL", "--format", "json"]] {
        let user = User::new();
        killed(&user);
        let journal = user.record().unwrap().len() as u64;
        let words = [words, &["--unfinished", "accept"]].concat();
        let ended = with_room(&user, journal + 4000, &words);
        let err = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{err}");
        let told = "warning: an interrupted dose of 3000 mL was accepted as it is (--unfinished accept)";
        assert_eq!(err.matches(told).count(), 1, "{err}");
    }
}
