//! Every way in which a dose may end, and what is on record then.

use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::user::{User, number};

const JOURNAL: &str = "state/three-roller/sim/journal.jsonl";

/// A dose that the simulation needs seconds for.
const LONG: &str = "3L";

/// Starts a long dose and waits until its journal says that steps were made.
fn begun(user: &User) -> Child {
    begun_with(user, &[])
}

/// Starts a long dose with options and waits until its journal says that steps were made.
fn begun_with(user: &User, options: &[&str]) -> Child {
    let child = user
        .command(&[&[LONG], options].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    user.until_moved("three-roller");
    child
}

/// Sends a signal as a user would.
fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-s", name, &id]).status().unwrap().success());
}

#[test]
fn the_rest_of_a_dose_keeps_its_rate_its_limits_its_end_its_retraction_and_its_fluid() {
    let user = User::new();
    let options = [
        "--rate",
        "20mL/s",
        "--max-outlet-pressure",
        "150kPaa",
        "--finish",
        "low-flow",
        "--retract",
        "2990mL",
        "--fluid",
        "ethanol",
    ];
    let child = begun_with(&user, &options);
    signal(&child, "INT");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    let rest = user.json(&["resume"]);
    assert!((number(&rest, "cruise_flow_ml_s") - 20.0).abs() < 1e-6, "{rest}");
    assert!((number(&rest, "retraction_ml") - 2990.0).abs() < 0.01, "{rest}");
    assert_eq!(rest["finish"], "low-flow");
    assert!(!rest["limits_not_checked"].as_array().unwrap().contains(&"discharge_pressure".into()), "{rest}");
    let log = user.types(&["log"]).out;
    // The stopped part, the rest and the retraction.
    assert_eq!(log.matches("ethanol at 25 °C").count(), 3, "{log}");
}

#[test]
fn a_stopped_dose_says_exactly_what_it_delivered_and_resume_makes_the_rest() {
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let user = User::new();
        let child = begun(&user);
        // Whoever asks meanwhile is told that it moves, and who moves it.
        assert_eq!(user.json(&["status"])["in_use_by"], format!("process {}", child.id()));
        let moving = user.types(&["status"]).out;
        assert!(
            moving.contains(&format!("in motion, by process {}: a dose of 3000 mL", child.id())),
            "{moving}"
        );
        let planned = user.types(&["1mL", "--dry-run"]);
        assert_eq!(planned.code, 3, "{}", planned.err);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code));
        let (out, err) =
            (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert!(out.contains("delivered, then stopped"), "{out}");
        assert!(err.contains("stopped by the user; `dose resume`"), "{err}");
        // As unsure as what was delivered, not as what was asked.
        let words: Vec<&str> = out.lines().nth(1).unwrap().split(' ').collect();
        let [said, unsure] = [1, 4].map(|n| words[n].parse::<f64>().unwrap());
        assert!(unsure < 0.06 * said + 0.2, "{out}");
        let log = user.json(&["log"]);
        assert_eq!((&log["end"], &log["cause"]), (&"stopped".into(), &format!("SIG{name}").into()));

        let status = user.json(&["status"]);
        let unfinished = &status["unfinished"];
        let delivered = number(unfinished, "delivered_least_ml");
        assert_eq!(number(unfinished, "delivered_most_ml"), delivered);
        assert!(delivered > 0.0 && delivered < 3000.0);
        assert_eq!((&status["half_width_deg"], &status["in_use_by"]), (&0.0.into(), &Value::Null));

        let refused = user.types(&["1mL"]);
        assert_eq!(refused.code, 4, "{}", refused.err);
        assert!(refused.err.contains("a dose of 3000 mL is unfinished"), "{}", refused.err);
        assert_eq!(user.types(&["home", "--set", "0deg"]).code, 4);
        assert_eq!(user.types(&["1mL", "--dry-run", "--start-angle", "0deg"]).code, 4);

        let rest = user.json(&["resume"]);
        assert!((delivered + number(&rest, "planned_ml") + number(&rest, "carry_ml") - 3000.0).abs() < 1e-9);
        assert!(number(&rest, "carry_ml").abs() < 1e-3);
        let status = user.json(&["status"]);
        assert!(status["unfinished"].is_null());
        assert!((number(&status["wear"], "volume_ml") - 3000.0).abs() < 1e-2);
        // An undisturbed dose has this end angle too.
        let other = User::new();
        other.json(&[LONG]);
        assert!((number(&status, "angle_deg") - number(&other.json(&["status"]), "angle_deg")).abs() < 1e-9);
    }
}

#[test]
fn a_changed_pump_file_tells_a_stopped_dose_by_the_file_of_then_and_why_an_angle_is_lost() {
    let user = User::new();
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    let write = |change: (&str, &str)| {
        assert!(shown.contains(change.0), "{shown}");
        let file = shown.replace("id = \"three-roller\"", "id = \"mine\"").replace(change.0, change.1);
        fs::write(user.path("mine.toml"), file).unwrap();
    };
    let status = || user.json(&["status", "--pump", "mine.toml"]);
    let told = || user.types(&["status", "--pump", "mine.toml"]).out;
    write(("polynomial_ml_deg", "polynomial_ml_deg"));
    let options = ["--pump", "mine.toml"];
    let child = user
        .command(&[&[LONG], &options[..]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    user.until_moved("mine");
    signal(&child, "INT");
    child.wait_with_output().unwrap();
    let before = number(&status()["unfinished"], "delivered_least_ml");
    assert!(!told().contains("by the pump file of then"), "{}", told());

    write(("bore_radius_mm = 5.0", "bore_radius_mm = 4.8"));
    let after = number(&status()["unfinished"], "delivered_least_ml");
    // The volume of a part of a pitch has another share of its whole.
    assert!((after - before).abs() < 0.3, "{before} {after}");
    assert!(told().contains(
        "(by the pump file of then, which gave 21.3185 mL per revolution; it gives 19.1519 mL now)"
    ));
    let rehearsed = user.json(&["resume", "--dry-run", "--pump", "mine.toml"]);
    assert!(
        rehearsed["warnings"].to_string().contains("and gave 21.3185 mL when the unfinished dose was made")
    );
    let rest = user.json(&["resume", "--pump", "mine.toml"]);
    let total = after + number(&rest, "planned_ml") + number(&rest, "carry_ml");
    assert!((total - 3000.0).abs() < 1e-9, "{rest}");
    assert!(
        rest["warnings"].to_string().contains("what was delivered counts as by the file of then"),
        "{rest}"
    );

    assert!(status()["angle_lost_by"].is_null());
    write(("steps_per_rev = 12800", "steps_per_rev = 25600"));
    assert_eq!((&status()["angle_lost_by"], &status()["angle_deg"]), (&"other_steps".into(), &Value::Null));
    let why =
        "the angle is unknown, because the pump file's motor has other steps per revolution of the head";
    assert!(told().contains(why), "{}", told());
    assert_eq!(user.types(&["home", "--set", "30deg", "--pump", "mine.toml"]).code, 0);
    assert!(status()["angle_lost_by"].is_null());
    // An angle that a person says is unknown has no other cause.
    assert_eq!(user.types(&["home", "--unknown", "--pump", "mine.toml"]).code, 0);
    assert!(status()["angle_lost_by"].is_null() && status()["angle_deg"].is_null());
}

#[test]
fn a_killed_dose_is_known_between_bounds_and_can_be_accepted_as_it_is() {
    let user = User::new();
    let mut child = begun(&user);
    child.kill().unwrap();
    child.wait().unwrap();
    let status = user.json(&["status"]);
    let unfinished = &status["unfinished"];
    let (least, most) = (number(unfinished, "delivered_least_ml"), number(unfinished, "delivered_most_ml"));
    assert!(most > least && most - least < 0.7, "{least} {most}");
    assert!(number(&status, "half_width_deg") > 0.0);
    assert_eq!(user.types(&["1mL"]).code, 4);
    let answer = user.types(&["accept"]);
    assert_eq!(answer.code, 0);
    let told = format!("is accepted as it is: between {least:.4} and {most:.4} mL were delivered\n");
    assert!(
        answer.out.starts_with("the unfinished dose of ") && answer.out.contains(&told),
        "{}",
        answer.out
    );
    let report = user.json(&["1mL"]);
    assert_eq!(report["phase"]["half_width_deg"], status["half_width_deg"]);
    assert_eq!(report["carry_in_ml"], 0.0);
    assert_eq!(user.types(&["discard"]).code, 2);
    assert!(user.is_refused(&["resume"]).contains("nothing to resume"));
}

/// Returns words as a person types them.
fn words(typed: &[String]) -> Vec<&str> {
    typed.iter().map(String::as_str).collect()
}

#[test]
fn a_smooth_dose_that_was_killed_twice_is_homed_and_resumed_as_typed() {
    let user = User::new();
    let mut child = begun_with(&user, &["--smooth"]);
    child.kill().unwrap();
    child.wait().unwrap();
    let entries = || fs::read_to_string(user.path(JOURNAL)).unwrap().matches("progress").count();
    let before = entries();
    let mut again = user.command(&["resume", "--rate", "5mL/s"]).stdout(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    while entries() == before {
        assert!(Instant::now() < deadline, "no progress on record");
        sleep(Duration::from_millis(2));
    }
    again.kill().unwrap();
    again.wait().unwrap();
    let asked = user.json(&["status"])["unfinished"]["requested_ml"].clone();
    assert_eq!(asked, 3000.0);

    let refused = user.types(&["resume", "--smooth"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    let advised: Vec<String> = refused.err.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let typed = |command: &str, value: (&str, &str)| -> Vec<String> {
        let advice = advised.iter().find(|advice| advice.starts_with(command));
        let advice =
            advice.unwrap_or_else(|| panic!("{command} in {}", refused.err)).replace(value.0, value.1);
        advice.split(' ').skip(1).map(str::to_owned).collect()
    };
    let say_angle = typed("dose home --unfinished --set", ("<ANGLE>", "30deg"));
    let finish = typed("dose resume", ("<FLOW>", "30mL/s"));
    let homed = user.types(&["home", "--set", "30deg"]);
    assert_eq!(homed.code, 4, "{}", homed.err);
    let homed = user.types(&words(&say_angle));
    assert_eq!(homed.code, 0, "{}", homed.err);
    let status = user.json(&["status"]);
    assert!((number(&status, "angle_deg") - 30.0).abs() < 1e-9, "{status}");
    assert_eq!(status["unfinished"]["requested_ml"], asked, "the dose is kept");
    let resumed = user.json(&words(&finish));
    assert_eq!(resumed["completed"], true);
    assert_eq!(user.json(&["status"])["unfinished"], Value::Null);
}

#[test]
fn a_torn_last_line_is_what_did_not_happen() {
    let user = User::new();
    user.json(&["5mL"]);
    let before = user.json(&["status"]);
    let whole = fs::read(user.path(JOURNAL)).unwrap();
    for torn in [&b"{"[..], b"{\"crc32\":\"00000000\",\"entry\":{\"progress\":", &[0; 100]] {
        fs::write(user.path(JOURNAL), [&whole, torn].concat()).unwrap();
        assert_eq!(user.json(&["status"]), before);
        user.json(&["1mL", "--dry-run"]);
    }
    user.json(&["1mL"]);
    let text = fs::read_to_string(user.path(JOURNAL)).unwrap();
    assert!(!text.contains('\0') && text.starts_with(str::from_utf8(&whole).unwrap()));
}

#[test]
fn a_damaged_journal_stops_everything_until_the_angle_is_set() {
    let user = User::new();
    user.json(&["5mL"]);
    user.json(&["5mL"]);
    let text = fs::read_to_string(user.path(JOURNAL)).unwrap();
    // A digit of the last line, which is whole.
    let at = text.rfind("angle_rad\":").unwrap() + 12;
    let damaged =
        format!("{}{}{}", &text[..at], if &text[at..=at] == "1" { "2" } else { "1" }, &text[at + 1..]);
    fs::write(user.path(JOURNAL), &damaged).unwrap();
    for command in [&["1mL"][..], &["1mL", "--start-angle", "3deg"], &["status"], &["resume"], &["discard"]] {
        let message = user.is_refused(command);
        assert!(message.contains("is damaged") && message.contains("home --set"), "{message}");
    }
    let answer = user.types(&["home", "--set", "30deg"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(
        answer.out.contains("journal.damaged") && answer.out.contains("stand at 30.00°"),
        "{}",
        answer.out
    );
    assert_eq!(fs::read_to_string(user.path("state/three-roller/sim/journal.damaged")).unwrap(), damaged);
    assert!((number(&user.json(&["1mL"]), "start_angle_deg") - 30.0).abs() < 1e-9);
}

#[test]
#[cfg(target_os = "linux")]
fn a_disk_that_is_full_before_motion_refuses_and_in_motion_stops() {
    let user = User::new();
    user.json(&["1mL"]);
    let lines = fs::read_to_string(user.path(JOURNAL)).unwrap();
    // The shell ignores the signal, so that writing beyond the limit is an error as on a full disk.
    let limited = |bytes: usize, volume: &str| {
        let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$1\" \"$2\"";
        let mut command = std::process::Command::new("bash");
        command.args(["-c", script, &bytes.to_string(), env!("CARGO_BIN_EXE_dose"), volume]);
        command.env("DOSE_STATE_DIR", user.path("state")).env_remove("DOSE_PUMP");
        let output = command.output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, message) = limited(lines.len() + 10, "10mL");
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("cannot write"), "{message}");
    assert_eq!(fs::read_to_string(user.path(JOURNAL)).unwrap(), lines);

    let (code, message) = limited(lines.len() + 1200, "10mL");
    assert_eq!(code, 1, "{message}");
    assert!(message.contains("because its progress could not be recorded"), "{message}");
    let said: f64 = message.split("after ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let status = user.json(&["status"]);
    let unfinished = &status["unfinished"];
    let (least, most) = (number(unfinished, "delivered_least_ml"), number(unfinished, "delivered_most_ml"));
    assert!(least <= said + 1e-4 && said <= most + 1e-4 && most > least, "{least} {said} {most}");
    let rest = user.json(&["resume"]);
    assert!((0.5 * (least + most) + number(&rest, "requested_ml") - 10.0).abs() < 1e-9);
}

#[test]
fn of_two_starts_in_the_same_moment_one_is_told_who_has_the_pump() {
    let user = User::new();
    let mut first = begun(&user);
    let second = user.types(&["1mL"]);
    assert_eq!(second.code, 3, "{}", second.err);
    assert!(second.err.contains(&format!("process {}", first.id())), "{}", second.err);
    first.kill().unwrap();
    first.wait().unwrap();
    // The lock went with its holder.
    assert_eq!(user.types(&["1mL"]).code, 4);
}

/// Makes a dose that is stopped on its way. Returns its report.
fn stopped(user: &User, volume: &str) -> String {
    let child = user.command(&[volume]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    user.until_moved("three-roller");
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_dose_that_was_stopped_tells_the_time_that_it_moved() {
    let user = User::new();
    let said = stopped(&user, LONG);
    // 3 L at 5 mL/s take 600 s and the ramps.
    let line = said.lines().find(|line| line.contains(" s at 5 mL/s")).unwrap_or_else(|| panic!("{said}"));
    let told_s: f64 = line.split(' ').next().unwrap().parse().unwrap();
    let status = user.json(&["status"]);
    let moved_s = number(&status["unfinished"], "delivered_least_ml") / 5.0;
    assert!((told_s - moved_s).abs() < 0.5, "{told_s} told and {moved_s} moved");
}

#[test]
fn a_rest_can_be_planned_without_moving() {
    let user = User::new();
    assert!(user.is_refused(&["resume", "--dry-run"]).contains("nothing to resume"));
    stopped(&user, "3009g");
    let before = user.record();
    let planned = user.json(&["resume", "--dry-run"]);
    assert!(planned["delivered_ml"].is_null() && user.record() == before);
    // A balance in air shows 3009 g for this volume (Z of ISO 8655-6), and nobody reads twelve decimals.
    let refused = user.types(&["1mL"]);
    assert!(
        refused.code == 4 && refused.err.contains("a dose of 3020.56 mL is unfinished"),
        "{}",
        refused.err
    );
    assert!(user.types(&["status"]).out.contains("a dose of 3020.56 mL, of which"));
    let made = user.json(&["resume"]);
    assert_eq!((&made["steps"], &made["planned_ml"]), (&planned["steps"], &planned["planned_ml"]));
}

#[test]
fn a_dose_that_is_accepted_is_reported_to_programs() {
    let user = User::new();
    stopped(&user, LONG);
    let unfinished = user.json(&["status"])["unfinished"].clone();
    let accepted = user.json(&["discard"]);
    assert_eq!((&accepted["schema"], &accepted["requested_ml"]), (&"accepted/1".into(), &3000.0.into()));
    for key in ["delivered_least_ml", "delivered_most_ml"] {
        assert_eq!(accepted[key], unfinished[key]);
    }
    assert_eq!(accepted["angle_deg"], user.json(&["status"])["angle_deg"]);
    let refused = user.types(&["discard", "--format", "json"]);
    let error: Value = serde_json::from_str(&refused.err).unwrap();
    assert_eq!((refused.code, &error["schema"]), (2, &"error/1".into()));
}
