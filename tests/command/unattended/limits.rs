//! The safety limits as a person meets them: exit code 5, `dose safety` and `dose vessel`.

use std::fs;

use serde_json::Value;

use crate::user::{Answer, User, number};

/// A pump of its own with these safety limits. Returns the name of its file.
fn pump(user: &User, safety: &str) -> &'static str {
    let shown = user.types(&["pumps", "show", "three-roller"]);
    assert_eq!(shown.code, 0);
    let text = shown.out.replace("id = \"three-roller\"", "id = \"tank\"");
    fs::write(user.path("tank.toml"), format!("{text}\n[safety]\n{safety}\n")).unwrap();
    "tank.toml"
}

fn reason(answer: &Answer) -> Value {
    serde_json::from_str(answer.err.lines().last().unwrap()).unwrap()
}

#[test]
fn a_pump_stands_with_exit_code_5_until_it_is_cleared_by_name_with_a_reason() {
    let user = User::new();
    let tank = pump(&user, "max_ml_per_day = 30.0");
    let dose = |words: &[&str]| user.types(&[words, &["--pump", tank, "--format", "json"]].concat());
    assert_eq!(dose(&["25mL"]).code, 0);
    // A dry run is refused too, and the pump does not stand afterwards.
    assert_eq!(dose(&["6mL", "--dry-run"]).code, 5);
    assert_eq!(dose(&["1mL"]).code, 0);
    let refused = dose(&["6mL"]);
    assert_eq!((refused.code, refused.out.as_str()), (5, ""));
    let error = reason(&refused);
    assert_eq!(
        (&error["code"], &error["kind"], &error["moved"]),
        (&5.into(), &"safety".into(), &false.into())
    );
    assert!(
        error["message"].as_str().unwrap().contains("`dose safety clear tank.toml --reason <TEXT>`"),
        "{error}"
    );
    for words in
        [&["0.1mL"][..], &["prime", "1mL"], &["purge", "-1mL"], &["run", "--rate", "1mL/s", "--for", "1s"]]
    {
        assert_eq!(dose(words).code, 5, "{words:?}");
    }
    let status = user.types(&["status", "--pump", tank]);
    assert!(
        status.out.contains(" of 30 mL in the last 24 h, ") && status.out.contains("the pump STANDS since"),
        "{}",
        status.out
    );
    assert_eq!(user.types(&["safety", "clear", tank]).code, 2, "a reason is needed");
    assert_eq!(user.types(&["safety", "clear", tank, "--reason", " "]).code, 2);
    assert_eq!(user.types(&["safety", "clear", "--reason", "no name"]).code, 2);
    let cleared = user.types(&["safety", "clear", tank, "--reason", "the tank is at 23 L, as it should be"]);
    assert_eq!(cleared.code, 0, "{}", cleared.err);
    assert!(cleared.out.starts_with("tank may go on, and your reason is on record"), "{}", cleared.out);
    let journal = fs::read_to_string(user.path("state/tank/sim/journal.jsonl")).unwrap();
    assert!(journal.contains("the tank is at 23 L, as it should be"));
    // The volumes before are not said to be nothing: the count is one since the clear.
    let counted = user.types(&["safety", "--pump", tank]).out;
    assert!(counted.contains("safety: 0 of 30 mL since it was cleared at 20"), "{counted}");
    assert_eq!(dose(&["30mL"]).code, 0);
    let again = user.types(&["safety", "clear", tank, "--reason", "once more"]);
    assert!(again.code == 2 && again.err.contains("does not stand"), "{}", again.err);
}

#[test]
fn a_pump_is_put_to_stand_by_name_with_a_reason_that_every_refusal_shows() {
    let user = User::new();
    let tank = pump(&user, "");
    let reason_of = "there is water under the rack";
    assert_eq!(user.types(&["safety", "stand", tank]).code, 2, "a reason is needed");
    assert_eq!(user.types(&["safety", "stand", tank, "--reason", " "]).code, 2);
    assert_eq!(user.types(&["safety", "stand", "--reason", "no name"]).code, 2);
    let stands = user.types(&["safety", "stand", tank, "--reason", reason_of]);
    assert_eq!(stands.code, 0, "{}", stands.err);
    assert!(stands.out.contains("tank stands") && stands.out.contains(reason_of), "{}", stands.out);
    let dose = |words: &[&str]| user.types(&[words, &["--pump", tank, "--format", "json"]].concat());
    for words in [&["1mL"][..], &["1mL", "--dry-run"], &["prime", "1mL"], &["run", "--rate", "1mL/s"]] {
        let refused = dose(words);
        assert_eq!((refused.code, refused.out.as_str()), (5, ""), "{words:?}");
        let error = reason(&refused);
        assert_eq!((&error["kind"], &error["value"]), (&"safety".into(), &Value::Null));
        let text = error["message"].as_str().unwrap();
        assert!(text.contains("stands by order since ") && text.contains(reason_of), "{text}");
    }
    for words in [["status", "--pump", tank], ["safety", "--pump", tank]] {
        let told = user.types(&words).out;
        assert!(told.contains("STANDS since") && told.contains(reason_of), "{told}");
    }
    let stand = &user.json(&["status", "--pump", tank])["safety"]["stand"];
    assert_eq!((&stand["limit"], &stand["reason"]), (&"ordered".into(), &reason_of.into()));
    let cleared = user.types(&["safety", "clear", tank, "--reason", "dry again"]);
    assert!(cleared.code == 0 && !cleared.out.contains("count no more"), "{}{}", cleared.out, cleared.err);
    assert_eq!(dose(&["1mL"]).code, 0);
    let words = ["safety", "stand", tank, "--reason", "service", "--format", "json"];
    let status: Value = serde_json::from_str(&user.types(&words).out).unwrap();
    assert_eq!(
        (&status["schema"], &status["safety"]["stand"]["reason"]),
        (&"status/1".into(), &"service".into())
    );
}

#[test]
fn an_option_narrows_the_limit_of_a_day_and_never_widens_it() {
    let user = User::new();
    let tank = pump(&user, "max_ml_per_day = 30.0");
    assert_eq!(user.types(&["11mL", "--pump", tank, "--max-per-day", "10mL"]).code, 5);
    user.types(&["safety", "clear", tank, "--reason", "a test"]);
    let wider = user.types(&["1mL", "--pump", tank, "--max-per-day", "31mL"]);
    assert!(wider.code == 2 && wider.err.contains("max_ml_per_day = 30"), "{}", wider.err);
    for none in ["0mL", "-5mL"] {
        assert_eq!(user.types(&["1mL", "--max-per-day", none]).code, 2, "{none}");
    }
    // A built-in pump has no limit of its own.
    assert_eq!(user.types(&["2mL", "--max-per-day", "2mL"]).code, 0);
    assert_eq!(user.types(&["2mL", "--max-per-day", "2mL"]).code, 5);
    assert_eq!(user.types(&["2mL"]).code, 5, "it stands whoever asks");
}

#[test]
fn a_full_vessel_is_emptied_and_the_pump_cleared() {
    let user = User::new();
    let tank = pump(&user, "vessel_ml = 50.0");
    let dose = |volume: &str| user.types(&[volume, "--pump", tank]);
    assert_eq!([dose("25mL").code, dose("25mL").code, dose("1mL").code], [0, 0, 5]);
    let refused = dose("1mL").err;
    assert!(refused.contains("empty the vessel and run `dose vessel emptied --pump tank.toml`"), "{refused}");
    let emptied = user.types(&["vessel", "emptied", "--pump", tank]);
    assert!(emptied.out.contains("it had received "), "{}{}", emptied.out, emptied.err);
    assert_eq!(dose("1mL").code, 5);
    assert_eq!(user.types(&["safety", "clear", tank, "--reason", "emptied"]).code, 0);
    assert_eq!(dose("50mL").code, 0);
    let safety = user.json(&["safety", "--pump", tank]);
    assert!((number(&safety["safety"], "received_ml") - 50.0).abs() < 0.01, "{safety}");
    assert_eq!(safety["safety"]["stand"], Value::Null);
}

#[test]
fn a_batch_that_would_not_fit_moves_nothing() {
    let user = User::new();
    let tank = pump(&user, "max_ml_per_day = 30.0");
    let batch = |count| user.types(&["5mL", "--repeat", count, "--pump", tank, "--format", "json"]);
    let refused = batch("7");
    assert_eq!((refused.code, refused.out.as_str()), (5, ""));
    assert_eq!(reason(&refused)["moved"], false);
    assert_eq!(number(&user.json(&["status", "--pump", tank])["wear"], "volume_ml"), 0.0);
    user.types(&["safety", "clear", tank, "--reason", "six then"]);
    assert_eq!(batch("6").code, 0);
}

#[test]
fn limits_that_limit_nothing_are_refused() {
    let user = User::new();
    for (wrong, key) in [
        ("max_ml_per_day = 0", "[safety] max_ml_per_day"),
        ("vessel_ml = -1.0", "[safety] vessel_ml"),
        ("max_ml_per_day = nan", "[safety] max_ml_per_day"),
        ("home = \"sometimes\"", "unknown variant"),
        ("max_per_day = 3", "unknown field"),
    ] {
        let tank = pump(&user, wrong);
        let refused = user.types(&["1mL", "--pump", tank]);
        assert!(refused.code == 2 && refused.err.contains(key), "{wrong}: {}", refused.err);
    }
}

#[test]
fn a_run_until_stopped_that_a_limit_ends_stands_with_exit_code_5_and_tells_of_it() {
    let user = User::new();
    let tank = pump(&user, "vessel_ml = 5.0");
    let tell = "cat > reason.json; echo $DOSE_FAIL_LEAST_ML > least_ml";
    let ran = user.types(&["run", "--rate", "6mL/s", "--pump", tank, "--format", "json", "--on-fail", tell]);
    assert_eq!(ran.code, 5, "{}", ran.err);
    let report: Value = serde_json::from_str(&ran.out).unwrap();
    let delivered_ml = number(&report, "delivered_ml");
    assert!(delivered_ml > 4.9 && delivered_ml < 5.0 && report["completed"] == true, "{report}");
    let error = reason(&ran);
    assert_eq!((&error["kind"], &error["moved"]), (&"safety".into(), &true.into()));
    assert!(
        error["message"].as_str().unwrap().contains("a run until it is stopped ends at the limit"),
        "{error}"
    );
    let told: Value = serde_json::from_str(&fs::read_to_string(user.path("reason.json")).unwrap()).unwrap();
    assert_eq!(told["code"], 5);
    let least_ml: f64 = fs::read_to_string(user.path("least_ml")).unwrap().trim().parse().unwrap();
    assert!((least_ml - delivered_ml).abs() < 1e-9, "{least_ml}");
    let refused = user.types(&["0.01mL", "--pump", tank]);
    assert!(refused.code == 5 && refused.err.contains("dose vessel emptied"), "{}", refused.err);
    let cleared = user.types(&["safety", "clear", tank, "--reason", "a test"]);
    assert_eq!(cleared.code, 0, "{}", cleared.err);
    assert_eq!(user.types(&["0.01mL", "--pump", tank]).code, 0);
}

#[cfg(unix)]
#[test]
fn the_rest_of_a_run_until_stopped_that_was_killed_stands_at_the_limit_too() {
    use std::process::Stdio;

    let user = User::new();
    let tank = pump(&user, "vessel_ml = 12.0");
    let mut command = user.command(&["run", "--rate", "3mL/s", "--pump", tank]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    user.until_moved("tank");
    child.kill().unwrap();
    child.wait().unwrap();
    let resumed = user.types(&["resume", "--pump", tank, "--format", "json"]);
    assert_eq!(resumed.code, 5, "{}{}", resumed.out, resumed.err);
    // The rest goes to the limit, or is refused since the unknown steps count: the pump stands either way.
    let safety = user.json(&["safety", "--pump", tank]);
    assert_eq!(safety["safety"]["stand"]["limit"], "vessel", "{safety}");
    assert!(number(&safety["safety"], "received_ml") <= 12.01, "{safety}");
}

#[test]
fn a_batch_that_would_exceed_a_limit_is_refused_with_the_volume_of_the_whole_batch() {
    let user = User::new();
    let tank = pump(&user, "max_ml_per_day = 70.0");
    let words = ["30mL", "--repeat", "4", "--pump", tank];
    let dry = user.types(&[&words[..], &["--dry-run"]].concat());
    let run = user.types(&words);
    for answer in [&dry, &run] {
        assert_eq!(answer.code, 5, "{}", answer.err);
    }
    assert!(run.err.contains("120 mL were planned, and the limit of 24 h is "), "{}", run.err);
}
