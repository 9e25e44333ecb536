//! The order of the words: options stand before the command or after it.

use crate::user::{User, number};

#[test]
fn an_option_stands_before_its_command_or_after_it() {
    let user = User::new();
    for words in [
        &["--pump", "two-roller", "status", "--format", "json"][..],
        &["status", "--pump", "two-roller", "--format", "json"],
        &["--format=json", "status", "--pump=two-roller"],
        &["--format", "json", "--pump", "two-roller", "status"],
    ] {
        let answer = user.types(words);
        assert_eq!(answer.code, 0, "{words:?}: {}", answer.err);
        assert!(answer.out.contains("\"pump\":\"two-roller\""), "{words:?}: {}", answer.out);
    }
    for words in [
        &["--format", "rust", "pumps", "show", "two-roller"][..],
        &["pumps", "--format", "rust", "show", "two-roller"],
    ] {
        assert!(user.types(words).out.contains("pub static PUMP"), "{words:?}");
    }
    let listed = user.types(&["--format", "json", "calibrate"]);
    assert!(listed.out.contains("calibrations/1"), "{}", listed.err);
    // A flag of one command and an option with a value of another.
    std::fs::write(user.path("r.csv"), "flow_ml_s,drop_kpa\n5,0.8\n10,1.5\n15,2.3\n20,3.0\n").unwrap();
    let found = user.types(&["--offset", "--data", "r.csv", "identify", "resistance"]);
    assert_eq!(found.code, 0, "{}", found.err);
}

#[test]
fn an_option_after_its_command_counts_in_place_of_the_one_before() {
    let user = User::new();
    for words in [
        &["--pump", "nobody", "status", "--pump", "two-roller", "--format", "json"][..],
        &["--pump=nobody", "--format=text", "status", "--format", "json", "--pump=two-roller"],
    ] {
        let answer = user.types(words);
        assert_eq!(answer.code, 0, "{words:?}: {}", answer.err);
        assert!(answer.out.contains("\"pump\":\"two-roller\""), "{words:?}: {}", answer.out);
    }
    let answer = user.types(&["-v", "prime", "1mL", "--verbose", "--dry-run"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    // In one place an option that stands twice is a slip.
    assert!(user.is_refused(&["1mL", "--rate", "5mL/s", "--rate", "6mL/s"]).contains("multiple times"));
}

#[test]
fn the_environment_names_pump_and_record_for_every_command() {
    let user = User::new();
    let state = user.path("state").display().to_string();
    for words in [
        &["--state-dir", &state, "pumps", "list"][..],
        &["pumps", "list", "--pump", "two-roller"],
        &["simulate", "--speed", "100rpm", "--duration", "1s", "--state-dir", &state],
    ] {
        let answer = user.types(words);
        assert_eq!(answer.code, 0, "{words:?}: {}", answer.err);
    }
    let status = user.command(&["status"]).env("DOSE_PUMP", "two-roller").output().unwrap();
    assert!(String::from_utf8(status.stdout).unwrap().starts_with("two-roller (sim)"));
}

#[test]
fn a_volume_may_be_two_words() {
    let user = User::new();
    let asked = |words: &[&str]| number(&user.json(&[words, &["--dry-run"]].concat()), "requested_ml");
    assert_eq!(asked(&["25", "mL"]), 25.0);
    assert_eq!(asked(&["-25", "mL"]), -25.0);
    assert_eq!(asked(&["prime", "20", "mL"]), 20.0);
    assert_eq!(asked(&["purge", "0.02", "L"]), 20.0);
    assert!(user.is_refused(&["25", "mL", "status"]).contains("a command together"));
    assert!(user.is_refused(&["25", "furlongs"]).contains("unknown volume or mass unit `furlongs`"));
}

#[test]
fn an_option_that_a_command_does_not_have_is_refused_by_name() {
    let user = User::new();
    for (words, expected) in [
        (&["status", "--smooth"][..], "`dose status` takes no --smooth"),
        (&["--smooth", "status"], "`dose status` takes no --smooth"),
        (&["simulate", "--within", "3s"], "`dose simulate` takes no --within"),
        (&["calibrate", "list", "--port", "x"], "`dose calibrate list` takes no --port"),
        (&["home", "--unknown", "--format", "json"], "`dose home` takes no --format"),
        (&["pumps", "list", "--driver", "sim"], "`dose pumps list` takes no --driver"),
        (&["completions", "bash", "-v"], "`dose completions` takes no -v"),
    ] {
        let message = user.is_refused(words);
        assert!(message.contains(expected), "{words:?}: {message}");
    }
}
