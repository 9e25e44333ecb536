//! The seams of the clock and the disk are real: the command itself under libfaketime, and with a limit of file size.
#![allow(clippy::print_stderr, reason = "a test that is skipped says why")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use pump_bench::record::Stamp;
use serde_json::Value;

use crate::user::{User, number};

/// Variable that makes a machine without faketime a failure.
const NEEDED: &str = "FAKETIME_NEEDED";

/// Returns true if this machine has faketime.
fn has_faketime() -> bool {
    let has = Command::new("faketime").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if has.is_err() {
        assert!(std::env::var_os(NEEDED).is_none(), "this machine has no faketime, and {NEEDED} asks for it");
        eprintln!(
            "skipped: this machine has no faketime (package faketime); {NEEDED}=1 makes that a failure"
        );
    }
    has.is_ok()
}

/// Returns the command under faketime with `clock` as its specification and `before` the words of the command.
fn faked(user: &User, clock: &str, before: &[&str], words: &[&str]) -> Command {
    let command = user.command(words);
    let mut faked = Command::new("faketime");
    faked.args(["-f", clock]).args(before).arg(command.get_program()).args(command.get_args());
    faked.current_dir(user.folder.path());
    faked.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    faked
        .env("TZ", "UTC")
        .env("FAKETIME_DONT_FAKE_MONOTONIC", "1")
        .env_remove("DOSE_PUMP")
        .env_remove("DOSE_CONFIG");
    faked
}

/// Runs the command at a time of the wall clock. None if this machine has no faketime.
fn at(user: &User, time: &str, words: &[&str]) -> Option<Output> {
    has_faketime().then(|| faked(user, &format!("@{time}"), &[], words).output().unwrap())
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

#[test]
fn a_batch_keeps_its_times_while_the_clock_jumps_and_says_what_it_saw() {
    if !has_faketime() {
        return;
    }
    let user = User::new();
    let clock = user.path("clock");
    let set = |offset: &str| {
        // A file that is replaced is never read half written.
        let new = user.path("clock.new");
        fs::write(&new, offset).unwrap();
        fs::rename(new, &clock).unwrap();
    };
    set("+0");
    let file = format!("FAKETIME_TIMESTAMP_FILE={}", clock.display());
    let by_file = ["env", "-u", "FAKETIME", "FAKETIME_NO_CACHE=1", &file];
    let words = ["1mL", "--repeat", "4", "--every", "1500ms", "--format", "json"];
    let began = Instant::now();
    let mut batch = faked(&user, "+0", &by_file, &words);
    let mut child = batch.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut next = || serde_json::from_str::<Value>(&lines.next().unwrap().unwrap()).unwrap();
    let mut doses = vec![next()];
    // The battery is empty: 27 hours back. Then the network sets the clock, four days on.
    set("-97200");
    doses.push(next());
    set("+248400");
    doses.extend([next(), next()]);
    let took_s = began.elapsed().as_secs_f64();
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(took_s >= 3.0 * 1.5 - 0.1, "three pauses by the steady clock: {took_s} s");
    for seen in ["went back by 27 h", "went ahead by 4 days"] {
        assert_eq!(err.matches(seen).count(), 1, "{err}");
    }
    let times: Vec<Stamp> =
        doses.iter().map(|dose| dose["time"].as_str().unwrap().parse().unwrap()).collect();
    let [back, ahead] = [1, 2].map(|dose| times[dose].unix_s as i64 - times[0].unix_s as i64);
    // The doses are a pause apart, and the clock is read to a second.
    assert!((back + 97_200 - 1).abs() < 60 && (ahead - 248_400 - 3).abs() < 60, "{times:?}");
    let delivered_ml: f64 = doses.iter().map(|dose| number(dose, "delivered_ml")).sum();
    let day_ml = number(&user.json(&["status"])["wear"], "volume_ml");
    assert!((delivered_ml - 4.0).abs() < 0.01 && (day_ml - delivered_ml).abs() < 0.01, "{day_ml}");
}

/// Runs the command with files of at most so many bytes. The shell ignores the signal, so that a write beyond the limit
/// fails as on a full disk.
pub(crate) fn with_room(user: &User, bytes: u64, words: &[&str]) -> Output {
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
