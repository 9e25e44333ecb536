//! Calibrations as a user makes and uses them.

use std::fs;
use std::io::{Read, Write};
use std::process::Stdio;

use serde_json::Value;

use crate::user::{Answer, User, number};

/// Volume of a revolution by the model, mL.
const REVOLUTION_ML: f64 = 21.318_486_6;

/// A table of runs of three revolutions at these speeds and factors.
fn table(user: &User, name: &str, runs: &[(f64, f64)]) -> String {
    let mut text = "speed_rpm,revolutions,volume_ml\n".to_owned();
    for (rpm, factor) in runs {
        text.push_str(&format!("{rpm},3,{}\n", 3.0 * REVOLUTION_ML * factor));
    }
    fs::write(user.path(name), text).unwrap();
    name.to_owned()
}

/// Types a command and then these lines.
fn answers(user: &User, arguments: &[&str], lines: &str) -> Answer {
    let mut command = user.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A command that was refused reads nothing.
    let _ = child.stdin.take().unwrap().write_all(lines.as_bytes());
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

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
fn guided_runs_are_weighed_one_by_one_and_the_last_can_be_repeated() {
    let user = User::new();
    let arguments = [
        "calibrate",
        "run",
        "--speeds",
        "10rpm,60rpm",
        "--runs",
        "2",
        "--pitches",
        "3",
        "--temperature",
        "21degC",
    ];
    // A trial, a reading of the wrong unit, a run to repeat, and one more time the last.
    let lines = "21.3mL\n21.0kg\n21.2g\nredo\n21.25g\n21.4mL\n21.5mL\nredo\n21.6mL\n\n";
    let said = answers(&user, &arguments, lines);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.err.contains("run 1 gave 21060") && said.err.contains("a mistake in a unit"),
        "{}",
        said.err
    );
    let list = user.json(&["calibrate", "list"]);
    let runs = list["calibrations"][0]["runs"].as_array().unwrap().clone();
    assert_eq!((list["active"].as_u64(), runs.len()), (Some(1), 4));
    assert_eq!(runs[1]["reading"]["mass_g"], 21.25);
    assert_eq!(runs[3]["reading"]["volume_ml"], 21.6);
    assert_eq!(
        (&runs[0]["speed_rpm"], &runs[0]["temperature_degc"]),
        (&Value::from(10.0), &Value::from(21.0))
    );
    // The trial and 4 + 2 runs of a revolution moved the rotor and are on record; nothing is owed or unfinished.
    let record = user.record().unwrap();
    let intents = record.lines().filter(|line| line.contains("\"intent\""));
    let runs = intents.filter(|line| line.contains("\"purpose\":\"calibrate\""));
    assert_eq!(runs.count(), 7, "{record}");
    let status = user.json(&["status"]);
    assert_eq!((number(&status, "carry_ml"), &status["unfinished"]), (0.0, &Value::Null));
}

#[test]
fn readings_of_a_guided_calibration_stay_on_record_and_it_can_be_continued() {
    let user = User::new();
    let arguments = ["calibrate", "run", "--speeds", "10rpm,60rpm", "--runs", "2", "--pitches", "1"];
    let go_on = ["calibrate", "run", "--continue"];
    // The person leaves after one reading, and the answers end after another.
    let left = answers(&user, &arguments, "7.1mL\n7.11mL\nquit\n");
    assert_eq!(left.code, 0, "{}", left.err);
    assert!(left.out.starts_with("doses go on as before; 1 reading is on record"), "{}", left.out);
    assert!(user.types(&["calibrate", "list"]).out.contains("is not calibrated"));
    let ended = answers(&user, &go_on, "7.12mL\n");
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("1 of 4 runs") && ended.err.contains("2 readings are on record"),
        "{}",
        ended.err
    );
    // Whoever looks is told.
    let told = "2 of 4 readings on record; `dose calibrate run --continue` goes on with it";
    for words in [&["status"][..], &["calibrate", "list"]] {
        let answer = user.types(words);
        assert!(answer.out.contains(told), "{words:?}: {}", answer.out);
    }
    let unfinished = &user.json(&["status"])["unfinished_calibration"];
    assert_eq!((&unfinished["readings"], &unfinished["planned"]), (&2.into(), &4.into()));
    // Nothing moves where it is not said what becomes of the readings, nor for other runs or another fluid.
    for (words, why) in [
        (&arguments[..], "2 of 4 readings is on record"),
        (&["calibrate", "run", "--continue", "--speeds", "30rpm"], "has other runs than these"),
        (
            &["calibrate", "run", "--continue", "--fluid", "ethanol"],
            "for water at 25 °C, and now it is ethanol",
        ),
        (&["calibrate", "run", "--continue", "--pump", "three-roller-as-built"], "nothing to go on with"),
    ] {
        let refused = answers(&user, words, "7.1mL\n");
        assert_eq!(refused.code, 2, "{words:?} {}", refused.err);
        assert!(refused.err.contains(why) && !refused.err.contains("moving"), "{words:?} {}", refused.err);
    }
    // Readings that cannot be fitted are kept. The rotor has turned, so this is a fault.
    let log = user.path("state/three-roller/sim/calibrations/unfinished.jsonl");
    let by_law = ["calibrate", "run", "--continue", "--fit", "speed-law"];
    let refused = answers(&user, &by_law, "7.03mL\n7.04mL\n\n");
    assert_eq!(refused.code, 1, "{}", refused.err);
    assert!(refused.err.contains("2 speeds for a speed law; 3 at least are needed"), "{}", refused.err);
    assert!(refused.err.contains("4 readings are on record"), "{}", refused.err);
    // Nothing is left to be made, so nothing moves.
    assert_eq!(answers(&user, &by_law, "\n").code, 2);
    let unfinished = fs::read_to_string(&log).unwrap();
    let kept = answers(&user, &go_on, "\n");
    assert_eq!(kept.code, 0, "{}", kept.err);
    assert!(kept.err.contains("4 of 4 runs") && !kept.err.contains("moving"), "{}", kept.err);
    assert!(!log.exists());
    assert!(user.json(&["status"])["unfinished_calibration"].is_null());
    let list = user.json(&["calibrate", "list"]);
    let runs = list["calibrations"][0]["runs"].as_array().unwrap().clone();
    let read = runs.iter().map(|run| number(&run["reading"], "volume_ml")).collect::<Vec<_>>();
    assert_eq!(read, [7.11, 7.12, 7.03, 7.04]);
    // A process that ended between keeping the calibration and removing the log leaves nothing to go on with.
    fs::write(&log, unfinished).unwrap();
    assert_eq!(answers(&user, &go_on, "\n").code, 2);
    assert_eq!(answers(&user, &arguments, "7.1mL\nquit\n").code, 0);
}

#[test]
fn a_reading_that_cannot_be_recorded_is_repeated_to_the_person() {
    let user = User::new();
    let arguments = ["calibrate", "run", "--speeds", "60rpm", "--runs", "2", "--pitches", "1"];
    let mut command = user.command(&arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let (mut typed, mut shown) = (child.stdin.take().unwrap(), child.stderr.take().unwrap());
    let mut text = String::new();
    let mut until = |word: &str, text: &mut String| {
        let mut byte = [0];
        while !text.ends_with(word) && shown.read(&mut byte).unwrap() == 1 {
            text.push(char::from(byte[0]));
        }
    };
    until("trial run (as 42.51g or 42.6mL; redo, quit): ", &mut text);
    typed.write_all(b"7.1mL\n").unwrap();
    until("run 1 of 2, 60 r/min (as 42.51g or 42.6mL; redo, quit): ", &mut text);
    // A folder stands in the place of the log: nothing can be appended.
    let log = user.path("state/three-roller/sim/calibrations/unfinished.jsonl");
    fs::remove_file(&log).unwrap();
    fs::create_dir(&log).unwrap();
    typed.write_all(b"7.12mL\n").unwrap();
    until("never", &mut text);
    assert_eq!(child.wait().unwrap().code(), Some(1), "{text}");
    assert!(text.contains("the reading 7.12mL of this run is not on record: note it down"), "{text}");
    assert_eq!(user.types(&["status"]).code, 0, "the rest of the record is well");
}

#[test]
fn a_guided_calibration_begins_anew_on_request_and_with_a_new_tube() {
    let user = User::new();
    let arguments = ["calibrate", "run", "--speeds", "60rpm", "--runs", "2", "--pitches", "1"];
    let log = user.path("state/three-roller/sim/calibrations/unfinished.jsonl");
    assert_eq!(answers(&user, &arguments, "7.1mL\n7.1mL\nquit\n").code, 0);
    // The readings are given up at once, also by someone who leaves at the trial run.
    let anew =
        answers(&user, &["calibrate", "run", "--speeds", "30rpm", "--pitches", "1", "--anew"], "quit\n");
    assert!(anew.code == 0 && anew.err.contains("3 runs of"), "{}", anew.err);
    assert_eq!(anew.out, "doses go on as before; no reading is on record\n");
    assert_eq!(answers(&user, &arguments, "7.1mL\n7.1mL\nquit\n").code, 0);
    let tube = user.types(&["tube", "--new"]);
    assert!(
        tube.out.contains("1 readings of a guided calibration of the old tube are given up"),
        "{}",
        tube.out
    );
    assert!(!log.exists());
    // A speed that the motor cannot have is refused before anything moves.
    let refused = answers(&user, &["calibrate", "run", "--speeds", "60rpm,400rpm"], "");
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(!refused.err.contains("moving"), "{}", refused.err);
}

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
    assert!(failed.out.starts_with("FAILED") && failed.err.contains("not within their tolerance"));
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
fn the_guided_example_prints_what_it_shows() {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/calibration.md")).unwrap();
    let after = text.split("<!-- typed by the test").nth(1).unwrap();
    let block = after.split("```text\n$ dose ").nth(1).unwrap().split("```").next().unwrap();
    let (typed, shown) = block.split_once('\n').unwrap();
    // The answer stands behind its question; a pipe does not show it.
    let (mut lines, mut expected) = (String::new(), String::new());
    for line in shown.lines() {
        let question = ["quit): ", "quit keeps the readings alone: "].iter().find_map(|end| {
            let place = line.find(end)?;
            Some(line.split_at(place + end.len()))
        });
        match question {
            Some((question, answer)) => {
                expected.push_str(question);
                lines.push_str(&format!("{answer}\n"));
            }
            None => expected.push_str(&format!("{line}\n")),
        }
    }
    let user = User::new();
    let said = answers(&user, &typed.split(' ').collect::<Vec<_>>(), &lines);
    assert_eq!(said.err + &said.out, expected);
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

#[test]
fn guided_runs_of_a_coarse_motor_are_whole_steps_where_the_angle_is_unknown() {
    let user = User::new();
    let file = user.types(&["pumps", "show", "three-roller"]).out.replace("12800", "400");
    assert!(file.contains("400"), "{file}");
    fs::write(user.path("coarse.toml"), file).unwrap();
    let of_coarse = |arguments: &[&'static str]| [arguments, &["--pump", "coarse.toml"]].concat();
    assert_eq!(user.types(&of_coarse(&["home", "--unknown"])).code, 0);
    let run = ["calibrate", "run", "--speeds", "60rpm", "--runs", "1"];
    let said = answers(&user, &of_coarse(&run), "64mL\n64mL\n\n");
    assert!(said.code == 0 && said.err.contains("9 pitches, 64.0 mL"), "{}{}", said.out, said.err);
    // A single pitch is 133 1/3 steps.
    let refused = answers(&user, &of_coarse(&[&run[..], &["--pitches", "1"]].concat()), "");
    assert!(refused.code == 2 && refused.err.contains("from an unknown angle"), "{}", refused.err);
}
