//! The seams of the clock and the disk are real: the command itself under libfaketime, and with a limit of file size.
#![allow(clippy::print_stderr, reason = "a test that is skipped says why")]

use std::process::{Command, Output, Stdio};

use crate::user::{User, number};

/// Variable that makes a machine without faketime a failure.
const NEEDED: &str = "FAKETIME_NEEDED";

/// Runs the command at a time of the wall clock. None if this machine has no faketime.
fn at(user: &User, time: &str, words: &[&str]) -> Option<Output> {
    let has = Command::new("faketime").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if has.is_err() {
        assert!(std::env::var_os(NEEDED).is_none(), "this machine has no faketime, and {NEEDED} asks for it");
        eprintln!(
            "skipped: this machine has no faketime (package faketime); {NEEDED}=1 makes that a failure"
        );
        return None;
    }
    let command = user.command(words);
    let mut faked = Command::new("faketime");
    faked.args(["-f", &format!("@{time}")]).arg(command.get_program()).args(command.get_args());
    faked.current_dir(user.folder.path());
    faked.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    faked
        .env("TZ", "UTC")
        .env("FAKETIME_DONT_FAKE_MONOTONIC", "1")
        .env_remove("DOSE_PUMP")
        .env_remove("DOSE_CONFIG");
    Some(faked.output().unwrap())
}

#[test]
fn a_day_is_that_of_the_computers_clock_and_a_clock_set_back_frees_nothing() {
    let user = User::new();
    let dose = |time: &str, volume: &str| {
        at(&user, time, &[volume, "--max-per-day", "30mL"]).map(|output| output.status.code().unwrap())
    };
    let Some(first) = dose("2026-03-01 06:00:00", "25mL") else { return };
    assert_eq!(first, 0);
    assert_eq!(dose("2026-03-02 05:59:00", "5mL"), Some(0));
    assert_eq!(dose("2026-03-02 06:01:00", "25mL"), Some(0), "the first one is a day old");
    assert_eq!(dose("1970-01-01 00:05:00", "1mL"), Some(5), "the clock was set back");
    assert_eq!(dose("2026-03-09 06:00:00", "1mL"), Some(5), "it stands");
    let cleared =
        at(&user, "2026-03-09 06:00:00", &["safety", "clear", "three-roller", "--reason", "a test"]);
    assert_eq!(cleared.unwrap().status.code(), Some(0));
    assert_eq!(dose("2026-03-09 06:00:01", "30mL"), Some(0));
    let log = at(&user, "2026-03-09 07:00:00", &["log", "--format", "csv"]).unwrap();
    let log = String::from_utf8(log.stdout).unwrap();
    for time in ["2026-03-01T06:00:00", "2026-03-02T05:59:00", "2026-03-02T06:01:00", "2026-03-09T06:00:01"] {
        assert_eq!(log.matches(time).count(), 1, "{time}: {log}");
    }
}

/// Runs the command with files of at most so many bytes. The shell ignores the signal, so that a write beyond the limit
/// fails as on a full disk.
fn with_room(user: &User, bytes: u64, words: &[&str]) -> Output {
    let command = user.command(words);
    let mut limited = Command::new("bash");
    let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$@\"";
    limited.args(["-c", script, &bytes.to_string()]).arg(command.get_program()).args(command.get_args());
    limited.current_dir(user.folder.path()).env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG");
    limited.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    limited.output().unwrap()
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_costs_no_dose_twice_and_lets_no_pump_go_beyond_its_limit() {
    let user = User::new();
    let limited = |volume| [volume, "--max-per-day", "30mL"];
    assert_eq!(user.types(&limited("20mL")).code, 0);
    let journal = user.record().unwrap().len() as u64;
    // Not even the intent has room: nothing moves.
    let refused = with_room(&user, journal + 10, &limited("5mL"));
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let received = |user: &User| number(&user.json(&["status"])["safety"], "day_ml");
    let before_ml = received(&user);
    assert!((before_ml - 20.0).abs() < 0.01, "{before_ml}");
    // The stand itself has no room. The pump is refused all the same, and again once there is room.
    assert_eq!(with_room(&user, journal + 10, &limited("15mL")).status.code(), Some(5));
    assert_eq!(user.types(&limited("15mL")).code, 5);
    assert_eq!(user.types(&["safety", "clear", "three-roller", "--reason", "room was made"]).code, 0);
    // The intent has room and the rest has none: the dose stops, and its bounds are on record.
    let journal = user.record().unwrap().len() as u64;
    let stopped = with_room(&user, journal + 2500, &limited("25mL"));
    assert_eq!(stopped.status.code(), Some(1), "{stopped:?}");
    assert_eq!(user.types(&limited("1mL")).code, 4);
    let status = user.json(&["status"]);
    let most_ml = number(&status["unfinished"], "delivered_most_ml");
    assert!((number(&status["safety"], "day_ml") - most_ml).abs() < 1e-6, "the most counts: {status}");
}
