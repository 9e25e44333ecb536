//! Claims about guided runs.

use std::fs;
use std::io::{Read, Write};
use std::process::Stdio;

use serde_json::Value;

use super::answers;
use crate::user::{User, number};

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
    let lines = "21.3mL\n21.0kg\n21.2g\nredo\n21.25g\n21.3mL\n21.35mL\n21.4mL\n21.5mL\nredo\n21.6mL\n\n";
    let said = answers(&user, &arguments, lines);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.err.contains("run 1 gave 21060") && said.err.contains("a mistake in a unit"),
        "{}",
        said.err
    );
    let list = user.json(&["calibrate", "list"]);
    let runs = list["calibrations"][0]["runs"].as_array().unwrap().clone();
    assert_eq!((list["active"].as_u64(), runs.len()), (Some(1), 6));
    assert_eq!(runs[1]["reading"]["mass_g"], 21.25);
    assert_eq!(runs[5]["reading"]["volume_ml"], 21.6);
    assert_eq!(
        (&runs[0]["speed_rpm"], &runs[0]["temperature_degc"]),
        (&Value::from(10.0), &Value::from(21.0))
    );
    // The trial and 6 + 2 runs of a revolution moved the rotor and are on record; nothing is owed or unfinished.
    let record = user.record().unwrap();
    let intents = record.lines().filter(|line| line.contains("\"intent\""));
    let runs = intents.filter(|line| line.contains("\"purpose\":\"calibrate\""));
    assert_eq!(runs.count(), 9, "{record}");
    let status = user.json(&["status"]);
    assert_eq!((number(&status, "carry_ml"), &status["unfinished"]), (0.0, &Value::Null));
}

#[test]
fn readings_of_a_guided_calibration_stay_on_record_and_it_can_be_continued() {
    let user = User::new();
    let arguments = ["calibrate", "run", "--speeds", "60rpm", "--runs", "4", "--pitches", "1"];
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
            "now it is ethanol at 25 °C; add --fluid water --temperature 25degC, or give the readings up",
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
    assert!(refused.err.contains("1 speeds for a speed law; 3 at least are needed"), "{}", refused.err);
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
    // A pitch of 7.106 mL of water at 25 °C, of which a gram has 1.0038 mL.
    until("trial run (as 7.08g or 7.11mL; redo, quit): ", &mut text);
    typed.write_all(b"7.1mL\n").unwrap();
    until("run 1 of 2, 60 r/min (as 7.08g or 7.11mL; redo, quit): ", &mut text);
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

#[test]
fn coarse_readings_that_are_typed_are_as_unsure_as_their_last_digit() {
    let user = User::new();
    // A pitch is 7.1 mL: 14.2 g of two pitches, on a scale that shows whole grams.
    let arguments =
        ["calibrate", "run", "--speeds", "60rpm", "--runs", "3", "--pitches", "2", "--format", "json"];
    let said = answers(&user, &arguments, "14g\n14g\n14g\n14g\n\n");
    assert_eq!(said.code, 0, "{}", said.err);
    let found: Value = serde_json::from_str(&said.out).unwrap();
    let (factor, reading) =
        (number(&found["displacement"], "factor"), number(&found["displacement"], "reading"));
    // Two readings, each known to a gram over the square root of 12, of 14.2 mL.
    let expected = (2.0_f64 / 12.0).sqrt() / 14.2;
    assert!((reading / expected - 1.0).abs() < 0.05, "{reading} {expected}");
    assert!((factor - 0.99).abs() < 0.02, "{factor}");
    assert!(!found["warnings"].to_string().contains("depart"), "{found}");
    let dose = user.json(&["50mL", "--speed", "60rpm"]);
    assert!(number(&dose, "expanded_uncertainty_ml") > 2.0 * 0.9 * expected * 50.0, "{dose}");
}
