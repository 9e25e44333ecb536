//! Errors as JSON: the last line of standard error, with the exit code and the facts.

use std::fs;

use serde_json::Value;

use crate::user::{Answer, User};

/// The error that a command reports to a program.
fn error(answer: &Answer) -> Value {
    let last = answer.err.lines().last().unwrap_or_default();
    let error: Value = serde_json::from_str(last).unwrap_or_else(|_| panic!("no JSON: {}", answer.err));
    let keys: Vec<&str> = error.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(keys, ["allowed", "code", "kind", "message", "moved", "schema", "value"]);
    assert_eq!((&error["schema"], &error["code"]), (&"error/1".into(), &answer.code.into()), "{error}");
    error
}

#[test]
fn an_error_for_a_program_has_its_kind_its_value_and_what_is_allowed() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    fs::write(user.path("bad.toml"), three.replace("gear = 1.0", "gear = 0.0")).unwrap();
    fs::write(user.path("bad.csv"), "speed_rpm,revolutions,volume_ml\n60,x,64\n").unwrap();
    for (words, kind, value, allowed) in [
        (&["25"][..], "quantity", Some("25"), Some("25mL")),
        (&["25furlongs"], "quantity", Some("25furlongs"), Some("mL")),
        (&["25mL", "--rate", "5"], "quantity", Some("5"), Some("10mL/s")),
        (&["1e9mL"], "range", Some("1000000000"), Some("up to 100000")),
        (&["25mL", "--speed", "171rpm"], "limit", Some("171.000 r/min"), Some("170")),
        (&["25mL", "--max-outlet-pressure", "89kPaa"], "limit", None, Some("89")),
        (&["25mL", "--driver", "teleport"], "usage", Some("teleport"), Some("sim, grbl, node, klipper")),
        (&["25mL", "--teleport"], "usage", Some("--teleport"), None),
        (&["simulate", "--speed", "100rpm"], "usage", None, None),
        (&["status", "--smooth"], "usage", Some("--smooth"), None),
        (&["stauts"], "usage", Some("stauts"), None),
        (&["25mL", "status"], "usage", Some("25mL"), None),
        (&["1mL", "--pump", "bad.toml"], "pump_file", Some("0"), Some("0.001 to 10000")),
        (&["1mL", "--pump", "gone.toml"], "input", Some("gone.toml"), None),
        (&["1mL", "--pump", "nobody"], "pump_file", Some("nobody"), Some("three-roller")),
        (&["1mL", "--trace", "no/folder/t.csv"], "output", Some("no/folder/t.csv"), None),
        (&["1mL", "--trace", "/"], "output", Some("/"), Some("a plain file")),
        (&["calibrate", "run", "--from", "bad.csv"], "table", None, None),
        (&["calibrate", "use", "7", "--format", "json"], "usage", Some("--format"), None),
        (&["resume"], "record", None, None),
    ] {
        let answer = user.types(&[words, &["--format", "json"]].concat());
        let error = error(&answer);
        assert_eq!((answer.code, answer.out.as_str()), (2, ""), "{words:?}: {error}");
        assert_eq!((&error["kind"], &error["moved"]), (&kind.into(), &false.into()), "{words:?}: {error}");
        let said = |key: &str| error[key].as_str().map(str::to_owned);
        assert!(
            value.is_none_or(|value| said("value").is_some_and(|said| said == value)),
            "{words:?}: {error}"
        );
        let is_allowed = |allowed| said("allowed").is_some_and(|said| said.contains(allowed));
        assert!(allowed.is_none_or(is_allowed), "{words:?}: {error}");
        assert!(!said("message").unwrap().is_empty() && !error["message"].as_str().unwrap().contains('\n'));
        // People read words.
        let words: Vec<&str> =
            words.iter().copied().filter(|word| !["--format", "json"].contains(word)).collect();
        let answer = user.types(&words);
        assert!(answer.err.starts_with("error: ") && !answer.err.contains("error/1"), "{}", answer.err);
    }
}

#[test]
fn an_error_for_a_program_says_if_another_process_or_a_dose_stands_in_the_way() {
    let user = User::new();
    user.json(&["1mL"]);
    let lock = fs::File::options().write(true).open(user.path("state/three-roller/sim/lock")).unwrap();
    lock.lock().unwrap();
    let answer = user.types(&["1mL", "--format=json"]);
    let busy = error(&answer);
    assert_eq!((answer.code, &busy["kind"], &busy["moved"]), (3, &"busy".into(), &false.into()));
    // A verification that fails has moved nothing where the readings are a table.
    fs::write(user.path("ten.csv"), "volume_ml\n10.5\n10.5\n10.5\n").unwrap();
    let verify = ["calibrate", "verify", "--volume", "10mL", "--from", "ten.csv", "--format", "json"];
    let answer = user.types(&verify);
    let failed = error(&answer);
    assert_eq!((answer.code, &failed["kind"], &failed["moved"]), (1, &"tolerance".into(), &false.into()));
}

#[test]
#[cfg(target_os = "linux")]
fn an_error_after_motion_says_that_the_pump_moved() {
    let user = User::new();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = user.command(&["5mL", "--format", "json"]).stdout(full).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let answer = Answer { code: output.status.code().unwrap(), out: String::new(), err: text(output.stderr) };
    let moved = error(&answer);
    assert_eq!(
        (answer.code, &moved["kind"], &moved["moved"]),
        (1, &"output".into(), &true.into()),
        "{moved}"
    );
}

#[test]
fn every_kind_and_every_key_of_an_error_is_documented() {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/errors.md")).unwrap();
    let kinds = pump_bench::report::ErrorKind::ALL.iter().map(|kind| kind.as_str());
    for word in kinds.chain(["schema", "code", "kind", "message", "value", "allowed", "moved"]) {
        assert!(text.contains(&format!("| `{word}` |")), "{word}");
    }
}

#[test]
fn the_sentences_of_a_usage_error_stand_apart() {
    let answer = User::new().types(&["25mL", "--dryrun", "--format", "json"]);
    let message = "unexpected argument '--dryrun' found; tip: a similar argument exists: '--dry-run'";
    assert_eq!(error(&answer)["message"], message);
}
