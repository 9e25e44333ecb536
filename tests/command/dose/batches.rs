//! Several doses from one command.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::user::{User, number};

/// Largest volume of a motor step of the three-roller pump, mL.
const STEP_ML: f64 = 2.2e-3;

fn objects(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn batch(user: &User, arguments: &[&str]) -> (Vec<Value>, String) {
    let answer = user.types(&[arguments, &["--format", "json"]].concat());
    assert_eq!(answer.code, 0, "{arguments:?}: {}", answer.err);
    (objects(&answer.out), answer.err)
}

/// A batch under way, and what it has reported.
struct Running {
    child: Child,
    out: BufReader<ChildStdout>,
}

impl Running {
    fn start(user: &User, arguments: &[&str]) -> Self {
        let arguments = [arguments, &["--format", "json"]].concat();
        let mut child =
            user.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let out = BufReader::new(child.stdout.take().unwrap());
        Self { child, out }
    }

    fn next_report(&mut self) -> Value {
        let mut line = String::new();
        self.out.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap()
    }

    fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-s", name, &id]).status().unwrap().success());
    }

    /// Exit code, the reports that are left, and standard error.
    fn end(mut self) -> (i32, Vec<Value>, String) {
        let (mut out, mut err) = (String::new(), String::new());
        self.out.read_to_string(&mut out).unwrap();
        self.child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        (self.child.wait().unwrap().code().unwrap(), objects(&out), err)
    }
}

#[test]
fn every_dose_of_a_batch_is_its_own_and_settles_what_the_one_before_owed() {
    let user = User::new();
    let started = Instant::now();
    let (reports, _) = batch(&user, &["1mL", "--repeat", "4", "--every", "300ms", "--start-angle", "30deg"]);
    assert!(started.elapsed() >= Duration::from_millis(900), "from start to start");
    assert_eq!(reports.len(), 4);
    assert!((number(&reports[0], "start_angle_deg") - 30.0).abs() < 1e-9);
    for (before, after) in reports.iter().zip(&reports[1..]) {
        assert_eq!(before["carry_ml"], after["carry_in_ml"]);
        assert!((number(before, "end_angle_deg") - number(after, "start_angle_deg")).abs() < 1e-9);
        assert_eq!(after["completed"], true);
    }
    let record = user.record().unwrap();
    assert_eq!(record.matches("\"intent\"").count(), 4);
    assert_eq!(record.matches("\"why\":\"done\"").count(), 4);
}

#[test]
fn a_batch_is_a_line_a_dose_and_a_total_for_people() {
    let user = User::new();
    for (options, verb) in [(&[][..], "delivered"), (&["--dry-run"], "planned")] {
        let text = user.types(&[&["1mL", "--repeat", "3"], options].concat()).out;
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "{text}");
        assert!(lines[0].starts_with("SIMULATED: no motor moved"), "{text}");
        for (n, line) in lines[1..4].iter().enumerate() {
            // A dose that was made begins with its time: 2026-11-23T03:15:00+01:00.
            let (time, dose) = line.split_once("  ").unwrap_or(("", line));
            assert_eq!(time.len(), if verb == "planned" { 0 } else { 25 }, "{text}");
            assert!(dose.starts_with(&format!("three-roller, dose {} of 3: 1.00 mL ± 0.1", n + 1)), "{text}");
        }
        assert!(
            lines[4].starts_with("three-roller: 3 doses, ")
                && lines[4].contains(verb)
                && lines[4].ends_with("3.000 mL requested"),
            "{text}"
        );
    }
    let whole = user.types(&["1mL", "--repeat", "2", "-v"]).out;
    assert_eq!(
        (whole.matches("\n  rollers  ").count(), whole.matches(": 2 doses, ").count()),
        (2, 1),
        "{whole}"
    );
    // A warning that every dose has is printed once.
    let user = User::new();
    assert_eq!(user.types(&["home", "--unknown"]).code, 0);
    let text = user.types(&["1mL", "--repeat", "3"]).out;
    let warnings: Vec<&str> = text.lines().filter(|line| line.starts_with("warning: ")).collect();
    let mut once = warnings.clone();
    once.sort_unstable();
    once.dedup();
    assert!(!warnings.is_empty() && once.len() == warnings.len(), "{text}");
}

#[test]
fn a_rehearsed_batch_is_planned_as_it_would_run_and_records_nothing() {
    let user = User::new();
    user.json(&["3mL"]);
    let before = user.record();
    let (planned, _) = batch(&user, &["0.7mL", "--repeat", "5", "--every", "1h", "--dry-run"]);
    assert_eq!(user.record(), before);
    let (made, _) = batch(&user, &["0.7mL", "--repeat", "5"]);
    assert_eq!(planned.len(), 5);
    for (planned, made) in planned.iter().zip(&made) {
        for key in ["start_angle_deg", "carry_in_ml", "planned_ml", "steps", "carry_ml"] {
            assert_eq!(planned[key], made[key], "{key}");
        }
        assert!(planned["delivered_ml"].is_null());
    }
}

#[test]
fn a_thousand_small_doses_add_up_within_a_step_over_restarts_and_a_reversed_one() {
    let user = User::new();
    let (mut reports, _) = batch(&user, &["0.1mL", "--repeat", "600"]);
    reports.push(user.json(&["-3.3mL"]));
    reports.extend(batch(&user, &["0.1mL", "--repeat", "400"]).0);
    assert_eq!(reports.len(), 1001);
    let sum = |key| reports.iter().map(|report| number(report, key)).sum::<f64>();
    let carry_ml = number(&reports[1000], "carry_ml");
    assert!(carry_ml.abs() < STEP_ML, "{carry_ml}");
    assert!((sum("planned_ml") + carry_ml - (100.0 - 3.3)).abs() < 1e-9);
    // The vessel is read once less than 1 nL can still arrive.
    assert!((sum("delivered_ml") - (100.0 - 3.3)).abs() < STEP_ML + 1e-4);
    let status = user.json(&["status"]);
    assert_eq!(number(&status, "carry_ml"), carry_ml);
    assert!((number(&status["wear"], "volume_ml") - 103.3).abs() < 1e-2, "either way");
}

#[test]
fn doses_that_come_due_while_one_runs_are_skipped_aloud_or_made_at_once() {
    let user = User::new();
    let arguments = ["100mL", "--repeat", "5", "--every", "1ms"];
    let skipping = user.types(&[&arguments[..], &["--format", "json"]].concat());
    assert_eq!((skipping.code, skipping.out.lines().count()), (1, 1), "{}", skipping.err);
    let err = skipping.err;
    assert!(err.contains("warning: doses 2 to 5 of 5 were skipped: their times had passed"), "{err}");
    // A script must not take the batch for whole.
    let last: Value = serde_json::from_str(err.lines().last().unwrap()).unwrap();
    assert_eq!((&last["kind"], &last["code"], &last["moved"]), (&"missed".into(), &1.into(), &true.into()));
    let answer = user.types(&arguments);
    assert!(
        answer.out.contains("\ndoses 2 to 5 of 5 were skipped: their times had passed"),
        "{}",
        answer.out
    );
    let told = "4 of 5 doses were not made: the time had passed; --missed now makes such a dose at once; 1 of 5 doses \
                of the batch were done and 4 skipped";
    assert!(answer.code == 1 && answer.err.contains(told), "{}", answer.err);
    let (reports, err) = batch(&user, &[&arguments[..], &["--missed", "now"]].concat());
    assert_eq!(reports.len(), 5);
    assert!(!err.contains("skipped"), "{err}");
}

#[test]
fn a_batch_that_was_suspended_skips_what_it_slept_through() {
    let user = User::new();
    let mut running = Running::start(&user, &["5mL", "--repeat", "4", "--every", "5s"]);
    running.next_report();
    let first = Instant::now();
    running.signal("STOP");
    // The times of the second and the third dose pass. Both margins are seconds: a busy machine takes its time.
    sleep(Duration::from_millis(11_500).saturating_sub(first.elapsed()));
    running.signal("CONT");
    let (code, reports, err) = running.end();
    assert_eq!((code, reports.len()), (1, 1), "{err}");
    let told = "doses 2 to 3 of 4 were skipped: their times had passed";
    assert_eq!(err.matches(told).count(), 1, "{err}");
    assert_eq!(reports[0]["warnings"], serde_json::json!([told]));
}

#[test]
fn a_signal_between_doses_ends_the_batch_at_once_with_nothing_unfinished() {
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let user = User::new();
        let mut running = Running::start(&user, &["1mL", "--repeat", "3", "--every", "1h"]);
        running.next_report();
        let refused = user.types(&["1mL"]);
        assert_eq!(refused.code, 3, "the pump stays this batch's: {}", refused.err);
        let sent = Instant::now();
        running.signal(name);
        let (ended, reports, err) = running.end();
        // The next dose is due in an hour.
        assert!(sent.elapsed() < Duration::from_secs(300));
        assert_eq!((ended, reports.len()), (code, 0), "{err}");
        assert!(err.contains("nothing is unfinished; 1 of 3 doses of the batch were done"), "{err}");
        assert!(user.json(&["status"])["unfinished"].is_null());
        user.json(&["1mL"]);
    }
}

#[test]
fn a_signal_in_motion_stops_the_dose_and_with_it_the_batch() {
    let user = User::new();
    let mut running = Running::start(&user, &["1L", "--repeat", "3"]);
    running.next_report();
    let deadline = Instant::now() + Duration::from_secs(120);
    while user.record().is_none_or(|text| text.matches("\"intent\"").count() != 2) {
        assert!(Instant::now() < deadline, "no second dose on record");
        sleep(Duration::from_millis(2));
    }
    user.until_moved("three-roller");
    running.signal("INT");
    let (code, reports, err) = running.end();
    assert_eq!((code, reports.len()), (130, 1), "{err}");
    assert_eq!(reports[0]["completed"], false);
    assert!(err.contains("`dose resume`") && err.contains("1 of 3 doses of the batch were done"), "{err}");
    let unfinished = user.json(&["status"])["unfinished"].clone();
    assert!((number(&unfinished, "requested_ml") - 1000.0).abs() < 1e-9);
    assert_eq!((&unfinished["end"], &unfinished["cause"]), (&"stopped".into(), &"SIGINT".into()));
    assert!(user.types(&["status"]).out.contains("; stopped by SIGINT; `dose resume`"));
    let rest = user.json(&["resume"]);
    assert!(number(&rest, "carry_ml").abs() < STEP_ML);
}

#[test]
#[cfg(target_os = "linux")]
fn a_dose_that_fails_ends_the_batch_with_its_own_code_and_says_how_many_were_done() {
    let user = User::new();
    user.json(&["1mL"]);
    let other = User::new();
    batch(&other, &["1mL", "--repeat", "2"]);
    // Room for the first dose of the batch and not for the second one's intent.
    let room = (other.record().unwrap().len() + 100).to_string();
    // The shell ignores the signal, so that writing beyond the limit is an error as on a full disk.
    let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$@\"";
    let mut command = Command::new("bash");
    command.args(["-c", script, &room, env!("CARGO_BIN_EXE_dose")]);
    command.args(["1mL", "--repeat", "3", "--format", "json"]);
    command.env("DOSE_STATE_DIR", user.path("state")).env_remove("DOSE_PUMP");
    let output = command.output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("cannot write") && err.contains("; 1 of 3 doses of the batch were done"), "{err}");
    assert_eq!(objects(&String::from_utf8(output.stdout).unwrap()).len(), 1);
}

#[test]
fn what_a_batch_cannot_obey_is_refused_by_name() {
    let user = User::new();
    for (arguments, expected) in [
        (
            &["1mL", "--repeat", "0"][..],
            "'0' for '--repeat <N>': number of doses is 0; allowed: whole numbers from 1 to 1000000",
        ),
        (&["1mL", "--repeat", "1000001"], "'1000001' for '--repeat <N>'"),
        (&["1mL", "--repeat", "2.5"], "'2.5' for '--repeat <N>'"),
        (&["1mL", "--every", "3s"], "say how many with --repeat"),
        (&["1mL", "--repeat", "3", "--missed", "now"], "give the doses times with --every"),
        (&["1mL", "--repeat", "3", "--every", "0s"], "`0s` is zero"),
        (
            &["1mL", "--repeat", "3", "--every", "1us"],
            "--every: time between doses in s is 0.000001; allowed: 0.001",
        ),
        (&["1mL", "--repeat", "3", "--every", "1e300h"], "--every: time between doses"),
        (
            &["1mL", "--repeat", "3", "--steps", "x.csv"],
            "--steps is the file of one dose, and --repeat asks for 3",
        ),
        (&["1mL", "--repeat", "3", "--trace", "x.csv"], "--trace is the file of one dose"),
        (&["1mL", "--repeat", "3", "--plot", "x.svg"], "--plot is the file of one dose"),
        (&["prime", "1mL", "--repeat", "3"], "`dose prime` takes no --repeat"),
        (&["status", "--every", "3s"], "`dose status` takes no --every"),
        (&["1e9mL", "--repeat", "3"], "; 0 of 3 doses of the batch were done"),
    ] {
        let message = user.is_refused(arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    user.json(&["1mL", "--repeat", "1", "--steps", "x.csv"]);
    assert!(user.path("x.csv").exists(), "a batch of one dose may have its files");
}

#[test]
fn a_warning_of_one_kind_is_told_once_though_its_numbers_differ() {
    let user = User::new();
    let arguments = ["0.1mL", "--repeat", "6", "--start-angle", "10deg"];
    let json = user.types(&[&arguments[..], &["--format", "json"]].concat());
    let reports = objects(&json.out);
    let peaks = |report: &Value| {
        let warnings = report["warnings"].as_array().unwrap().iter();
        warnings.map(|text| text.as_str().unwrap().to_owned()).find(|text| text.contains("peaks at"))
    };
    let told: std::collections::BTreeSet<String> = reports.iter().filter_map(peaks).collect();
    assert!(told.len() > 1, "the doses peak at several speeds: {told:?}");
    assert_eq!(json.err.matches("peaks at").count(), 1, "{}", json.err);
    let text = user.types(&arguments).out;
    assert_eq!(text.matches("peaks at").count(), 1, "{text}");
}
