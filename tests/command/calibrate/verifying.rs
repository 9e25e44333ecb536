//! Claims about verifications.

use std::fs;

use serde_json::Value;

use super::answers;
use crate::user::{User, number};

#[test]
fn verification_passes_or_fails_against_its_tolerance() {
    let user = User::new();
    fs::write(
        user.path("ten.csv"),
        "volume_ml\n10.02\n10.01\n10.03\n9.99\n10\n10.04\n10.02\n10.01\n10.02\n10.03\n",
    )
    .unwrap();
    let verify = ["calibrate", "verify", "--volume", "10mL", "--from", "ten.csv"];
    let passed = user.types(&verify);
    assert!(passed.code == 0 && passed.out.contains("+0.170 %"), "{}{}", passed.out, passed.err);
    let failed = user.types(&[&verify[..], &["--systematic", "0.1%"]].concat());
    assert_eq!(failed.code, 1);
    assert!(failed.out.starts_with("FAILED") && failed.err.contains("not within their tolerance; calibrate"));
    // No calibration mends a scatter.
    let scattered = user.types(&[&verify[..], &["--random", "0.05%"]].concat());
    assert!(scattered.code == 1 && scattered.err.contains("they scatter"), "{}", scattered.err);
    assert!(!scattered.err.contains("dose calibrate run"), "{}", scattered.err);
    let message = user.is_refused(&["calibrate", "verify", "--volume", "25mL", "--from", "ten.csv"]);
    assert!(message.contains("give --systematic and --random"), "{message}");
    let made = answers(
        &user,
        &[
            "calibrate",
            "verify",
            "--volume",
            "2mL",
            "--runs",
            "3",
            "--systematic",
            "1%",
            "--random",
            "1%",
            "--format",
            "json",
        ],
        "2.01mL\nredo\n2.0mL\n1.99mL\n",
    );
    assert_eq!(made.code, 0, "{}", made.err);
    let found: Value = serde_json::from_str(&made.out).unwrap();
    assert_eq!((&found["schema"], &found["passed"]), (&Value::from("verification/1"), &Value::from(true)));
    let record = user.record().unwrap();
    let intents = record.lines().filter(|line| line.contains("\"intent\""));
    assert_eq!(intents.filter(|line| line.contains("\"purpose\":\"dose\"")).count(), 4);
}

#[test]
fn a_carry_of_before_is_no_error_of_the_pump_that_is_verified() {
    let user = User::new();
    // The retraction leaves half a millilitre to the next dose.
    user.json(&["5mL", "--retract", "500uL"]);
    let verify = [
        "calibrate",
        "verify",
        "--volume",
        "10mL",
        "--runs",
        "2",
        "--systematic",
        "0.6%",
        "--random",
        "0.2%",
    ];
    let said = answers(&user, &[&verify[..], &["--format", "json"]].concat(), "10.5mL\n10mL\n");
    let found: Value =
        serde_json::from_str(&said.out).unwrap_or_else(|error| panic!("{error}: {}", said.err));
    assert!(number(&found, "systematic_percent").abs() < 0.01, "{found}");
    assert_eq!(said.code, 0, "{}", said.err);
}

#[test]
fn a_verification_that_fails_after_a_dose_does_not_say_that_nothing_has_moved() {
    let user = User::new();
    let file = user.types(&["pumps", "show", "three-roller"]).out;
    // The second dose would use up the tube.
    let file = if file.contains("[tube]") {
        file.replace("[tube]", "[tube]\nlife_ml = 15.0")
    } else {
        file + "\n[tube]\nlife_ml = 15.0\n"
    };
    fs::write(user.path("worn.toml"), file).unwrap();
    let verify = ["calibrate", "verify", "--volume", "10mL", "--runs", "2", "--pump", "worn.toml"];
    let said = answers(&user, &verify, "10mL\n");
    assert!(said.err.contains("tube") && said.err.contains("nothing is kept"), "{}", said.err);
    assert_eq!(said.code, 1, "{}", said.err);
    // Nothing moves where the first dose is refused.
    let said = answers(&user, &verify, "");
    assert!(said.err.contains("tube"), "{}", said.err);
    assert_eq!(said.code, 2, "{}", said.err);
}
