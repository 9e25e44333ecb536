//! Racks that nobody watches: interrupted doses, disturbed angles, options of real motors, and failures that are told.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{MIX, desk};
use crate::unattended::clock::with_room;
use crate::user::{Answer, User, number};

/// Rack of these pumps that takes a minute and a half.
fn slow() -> String {
    MIX.replace("6mL\"\nrate = \"6mL/s", "90mL\"\nrate = \"1mL/s")
}

/// Leaves a rack whose process was killed on its way.
fn killed(user: &User) {
    let mut command = user.command(&["run", "mix.toml"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    user.until_moved("three-roller");
    user.until_moved("two-roller");
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Types a command without a terminal.
fn unattended(user: &User, arguments: &[&str]) -> Answer {
    let output = user.command(arguments).stdin(Stdio::null()).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

fn objects(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_rack_after_a_power_cut_asks_or_makes_each_rest_first_or_accepts_it() {
    let user = desk(&slow());
    killed(&user);
    let fast = |policy: &str| {
        user.types(&["run", "mix.toml", "--pace", "fast", "--format", "json", "--unfinished", policy])
    };
    assert_eq!(user.types(&["run", "mix.toml", "--pace", "fast"]).code, 4);
    assert_eq!(fast("ask").code, 4);
    let resumed = fast("resume");
    assert_eq!(resumed.code, 0, "{}", resumed.err);
    let [acid, base, rack] = &objects(&resumed.out)[..] else { panic!("{}", resumed.out) };
    for (rest, pump) in [(acid, "three-roller"), (base, "two-roller")] {
        assert_eq!((&rest["schema"], &rest["pump"]), (&"dose/1".into(), &pump.into()));
        assert!(rest["warnings"].to_string().contains("the rest of an interrupted dose"), "{rest}");
        let status = user.json(&["status", "--pump", pump]);
        assert!(status["unfinished"].is_null(), "{status}");
    }
    assert_eq!((&rack["schema"], &rack["end"]), (&"rack/1".into(), &"completed".into()));
    // Twice 60 and 30 mL in all.
    let worn_ml = |pump: &str| number(&user.json(&["status", "--pump", pump])["wear"], "volume_ml");
    assert!((worn_ml("three-roller") - 120.0).abs() < 0.5 && (worn_ml("two-roller") - 60.0).abs() < 0.5);
    let user = desk(&slow());
    killed(&user);
    let accepted =
        user.types(&["run", "mix.toml", "--pace", "fast", "--format", "json", "--unfinished", "accept"]);
    assert_eq!((accepted.code, objects(&accepted.out).len()), (0, 1), "{}", accepted.err);
    assert_eq!(accepted.err.matches("was accepted as it is").count(), 2, "{}", accepted.err);
}

/// Text of a pump's journal, empty before its first entry.
fn journal(user: &User, pump: &str) -> String {
    fs::read_to_string(user.path(&format!("state/{pump}/sim/journal.jsonl"))).unwrap_or_default()
}

fn worn_ml(user: &User, pump: &str) -> f64 {
    number(&user.json(&["status", "--pump", pump])["wear"], "volume_ml")
}

#[test]
fn a_rack_that_is_killed_at_any_growth_of_its_journals_keeps_its_ratio_or_is_refused() {
    for growths in 1..=10 {
        let user = desk(&slow());
        let mut command = user.command(&["run", "mix.toml"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let size = |pump: &str| {
            fs::metadata(user.path(&format!("state/{pump}/sim/journal.jsonl"))).map_or(0, |file| file.len())
        };
        let deadline = Instant::now() + Duration::from_secs(120);
        let (mut seen, mut last) = (0, (0, 0));
        while seen < growths {
            assert!(Instant::now() < deadline, "{seen} growths of the journals");
            let now = (size("three-roller"), size("two-roller"));
            seen += usize::from(now != last);
            last = now;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let [acid, base] = ["three-roller", "two-roller"].map(|pump| journal(&user, pump));
        for (moved, other) in [(&acid, &base), (&base, &acid)] {
            let is_alone = moved.contains("\"progress\"") && !other.contains("\"intent\"");
            assert!(!is_alone, "growth {growths}: a share moved before the other was on record");
        }
        let rack = ["run", "mix.toml", "--pace", "fast", "--format", "json", "--unfinished", "resume"];
        let resumed = user.types(&rack);
        let [acid_ml, base_ml] = ["three-roller", "two-roller"].map(|pump| worn_ml(&user, pump));
        match resumed.code {
            0 => assert!((acid_ml - 2.0 * base_ml).abs() < 0.5, "growth {growths}: {acid_ml}, {base_ml} mL"),
            4 => assert!(resumed.err.contains("no share of") && acid_ml + base_ml == 0.0, "{}", resumed.err),
            _ => panic!("growth {growths}: {}", resumed.err),
        }
    }
}

#[test]
fn a_share_that_has_not_moved_is_not_made_without_its_partner() {
    let user = desk(&slow());
    killed(&user);
    // A loss of power between the entries of the two pumps.
    let path = user.path("state/three-roller/sim/journal.jsonl");
    let acid = journal(&user, "three-roller");
    let end = acid.find("\"intent\"").unwrap();
    let end = end + acid[end..].find('\n').unwrap() + 1;
    fs::write(path, &acid[..end]).unwrap();
    fs::remove_dir_all(user.path("state/two-roller")).unwrap();
    let rack = ["run", "mix.toml", "--pace", "fast", "--unfinished"];
    let refused = user.types(&[&rack[..], &["resume"]].concat());
    assert_eq!(refused.code, 4, "{}{}", refused.out, refused.err);
    for told in [
        "`acid` of the rack has an unfinished share that has not moved, and no share of base is",
        "dose accept",
    ] {
        assert!(refused.err.contains(told), "{}", refused.err);
    }
    assert_eq!(worn_ml(&user, "three-roller"), 0.0);
    let accepted = user.types(&[&rack[..], &["accept"]].concat());
    assert_eq!(accepted.code, 0, "{}", accepted.err);
}

#[test]
fn a_rack_without_a_person_obeys_home_and_turns_no_pump_to_its_sensor() {
    for (home, code) in [("refuse", 2), ("sensor", 2), ("accept", 0)] {
        let user = desk(&MIX.replace("two-roller", "base.toml"));
        let pump =
            user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base\"");
        fs::write(user.path("base.toml"), format!("{pump}\n[safety]\nhome = \"{home}\"\n")).unwrap();
        let rack = ["run", "mix.toml", "--pace", "fast", "--format", "json"];
        assert_eq!(unattended(&user, &rack).code, 0, "{home}: nothing was disturbed");
        assert_eq!(user.types(&["release", "--pump", "base.toml"]).code, 0);
        let before = user.json(&["status"]);
        let answer = unattended(&user, &rack);
        assert_eq!(answer.code, code, "{home}: {}", answer.err);
        if home == "accept" {
            assert!(answer.err.contains("[safety] home = \"accept\""), "{}", answer.err);
        } else {
            let error: Value = serde_json::from_str(answer.err.lines().last().unwrap()).unwrap();
            assert_eq!((&error["kind"], &error["moved"]), (&"angle".into(), &false.into()), "{error}");
            let told = match home {
                "sensor" => {
                    "[safety] home = \"sensor\" turns no pump of a rack, whose motions have their times"
                }
                _ => "[safety] home = \"refuse\" makes no dose without a person then",
            };
            assert!(error["message"].as_str().unwrap().contains(told), "{error}");
            assert_eq!(user.json(&["status"])["wear"], before["wear"], "the other pump did not move");
        }
    }
}

#[test]
fn options_of_real_motors_are_those_of_the_real_pumps_of_a_rack() {
    let user = desk(&MIX.replace("two-roller", "base.toml"));
    let pump =
        user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base\"");
    let drive = "[drive]\ndriver = \"node\"\nport = \"/no/such/port\"\n";
    for (text, refused) in [(pump.clone(), true), (format!("{pump}\n{drive}"), false)] {
        fs::write(user.path("base.toml"), text).unwrap();
        let answer = user.types(&["run", "mix.toml", "--dry-run", "--confirm-pump"]);
        assert_eq!(answer.code, if refused { 2 } else { 0 }, "{}{}", answer.out, answer.err);
        assert_eq!(answer.err.contains("means nothing to a simulated motor"), refused, "{}", answer.err);
    }
}

#[test]
fn the_command_of_a_failure_hears_the_rack_and_the_pump_that_failed() {
    let user = desk(&MIX.replace("two-roller", "base.toml"));
    let pump =
        user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base\"");
    fs::write(user.path("base.toml"), format!("{pump}\n[safety]\nmax_ml_per_day = 1.5\n")).unwrap();
    let tell = "echo \"$DOSE_FAIL_RACK $DOSE_FAIL_PUMP $DOSE_FAIL_CODE\" > told";
    assert_eq!(user.types(&["run", "./mix.toml", "--pace", "fast", "--on-fail", tell]).code, 5);
    assert_eq!(fs::read_to_string(user.path("told")).unwrap(), "mix base 5\n");
}

#[test]
#[cfg(target_os = "linux")]
fn the_command_of_a_rack_that_a_fault_ends_hears_the_bounds_of_its_total_and_of_the_pump_that_failed() {
    let user = desk(&MIX.replace("\"6mL\"", "\"300mL\""));
    // The records of both pumps are there, and there is no room for what a long run adds.
    assert_eq!(user.types(&["run", "mix.toml", "--dry-run"]).code, 0);
    let tell = "cat > reason.json; env | grep ^DOSE_FAIL_ > reason.env";
    let words = ["run", "mix.toml", "--pace", "fast", "--format", "json", "--on-fail", tell];
    let ended = with_room(&user, 4000, &words);
    let err = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(1), "{err}");
    let report: Value = serde_json::from_slice(&ended.stdout).unwrap();
    assert_eq!(report["end"], "fault", "{report}");
    let told = fs::read_to_string(user.path("reason.env")).unwrap();
    let value = |key: &str| {
        let line = told.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
        line.unwrap_or_else(|| panic!("{key}: {told}")).to_owned()
    };
    assert_eq!((value("DOSE_FAIL_RACK").as_str(), value("DOSE_FAIL_CODE").as_str()), ("mix", "1"));
    assert_eq!(value("DOSE_FAIL_PUMP"), report["fault"].as_str().unwrap());
    let bounds = ["LEAST", "MOST"].map(|key| value(&format!("DOSE_FAIL_{key}_ML")).parse::<f64>().unwrap());
    let stated = ["delivered_least_ml", "delivered_most_ml"].map(|key| number(&report["total"], key));
    assert!(bounds[1] >= bounds[0] && bounds[0] > 0.0, "{told}");
    for (bound, stated) in bounds.into_iter().zip(stated) {
        assert!((bound - stated).abs() < 1e-6, "{told}{report}");
    }
    let reason: Value = serde_json::from_str(&fs::read_to_string(user.path("reason.json")).unwrap()).unwrap();
    assert_eq!((&reason["schema"], &reason["moved"]), (&"error/1".into(), &true.into()), "{reason}");
    let message = reason["message"].as_str().unwrap();
    assert!(message.contains("every other pump was stopped"), "{message}");
}
