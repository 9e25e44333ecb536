//! `dose log`: every dose with its time, and the totals.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::user::{User, number};

fn objects(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn every_dose_is_listed_as_it_was_typed_with_the_time_of_its_report() {
    let user = User::new();
    let none = user.types(&["log"]);
    assert_eq!(
        (none.code, none.out.as_str()),
        (0, "no dose of three-roller is in the log of the drive sim\n")
    );
    let report = user.json(&["25mL"]);
    assert_eq!(report["asked"], "25 mL");
    user.types(&["3g", "--reverse"]);
    user.types(&["prime", "10mL"]);
    user.types(&["tube", "--new"]);
    user.types(&["1 mL"]);
    let dry = user.json(&["2mL", "--dry-run"]);
    assert_eq!((&dry["time"], &dry["asked"]), (&Value::Null, &json!("2 mL")));
    let listed = objects(&user.types(&["log", "--format", "json"]).out);
    assert_eq!(listed[0]["time"], report["time"]);
    let of = |key: &str| listed.iter().map(|dose| dose[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("schema"), vec![json!("log/1"); 4]);
    assert_eq!(of("number"), [json!(1), json!(2), json!(3), json!(4)]);
    assert_eq!(of("asked"), [json!("25 mL"), json!("-3 g"), json!("10 mL"), json!("1 mL")]);
    assert_eq!(of("purpose"), [json!("dose"), json!("dose"), json!("prime"), json!("dose")]);
    assert_eq!(of("tube"), [json!(1), json!(1), json!(1), json!(2)]);
    let sum_ml: f64 = listed.iter().map(|dose| number(dose, "delivered_ml")).sum();
    let totals = objects(&user.types(&["log", "--totals", "--format", "json"]).out);
    let tubes: Vec<&Value> = totals.iter().filter(|total| total["tube"] != Value::Null).collect();
    assert_eq!(tubes.len(), 2);
    let total_ml: f64 = tubes.iter().map(|total| number(total, "delivered_ml")).sum();
    // 3 g by a balance in air are 3/0.997 mL and 0.9 per mille more for the buoyancy: 25 - 3.0117 + 10 + 1.
    assert!((total_ml - sum_ml).abs() < 1e-9 && (sum_ml - 32.9883).abs() < 0.005, "{total_ml} {sum_ml}");
    let csv = user.types(&["log", "--format", "csv"]).out;
    assert_eq!(csv.lines().count(), 5);
    assert!(csv.starts_with("number,time,purpose,asked,"), "{csv}");
    let last = objects(&user.types(&["log", "-n", "2", "--format", "json"]).out);
    assert_eq!(last, listed[2..]);
    let last = user.types(&["log", "--last", "1"]).out;
    assert!(!last.contains("25 mL") && last.contains("tube 1: ") && last.contains("tube 2: 0.99"), "{last}");
    assert!(user.is_refused(&["log", "-n", "0"]).contains("--last"));
    let text = user.types(&["log"]).out;
    assert!(text.contains("25 mL") && text.contains("tube 2: 0.99"), "{text}");
}

#[test]
fn a_time_leaves_out_the_doses_before_it_and_nonsense_is_refused() {
    let user = User::new();
    user.types(&["1mL"]);
    let count = |arguments: &[&str]| {
        objects(&user.types(&[&["log", "--format", "json"][..], arguments].concat()).out).len()
    };
    assert_eq!(count(&["--since", "2d"]), 1);
    assert_eq!(count(&["--until", "2d"]), 0);
    assert_eq!(count(&["--since", "2999-01-01"]), 0);
    assert_eq!(count(&["--since", "1970-01-02", "--until", "2999-01-01T00:00:00+01:00"]), 1);
    for words in [&["--since", "2999-01-01"][..], &["--until", "2d"]] {
        let none = user.types(&[&["log"][..], words].concat()).out;
        assert_eq!(none, "no dose of three-roller in that time; the log of the drive sim has 1 dose\n");
    }
    let turned = user.is_refused(&["log", "--since", "1h", "--until", "2h"]);
    assert!(turned.contains("--until 2h is not after --since 1h"), "{turned}");
    let minus = user.is_refused(&["log", "--since", "-2d"]);
    assert!(minus.contains("`-2d` is no moment"), "with the minus that was typed: {minus}");
    let message = user.is_refused(&["log", "--since", "last week"]);
    assert!(message.contains("`last week` is no moment") && message.contains("2d"), "{message}");
}

/// Writes other times into the log, one a dose.
fn set_times(user: &User, times: &[&str]) {
    let path = user.path("state/three-roller/sim/log.jsonl");
    let mut log = String::new();
    for (line, time) in fs::read_to_string(&path).unwrap().lines().zip(times) {
        let mut line: Value = serde_json::from_str(line).unwrap();
        line["entry"]["time"] = (*time).into();
        let text = line["entry"].to_string();
        log += &format!("{{\"crc32\":\"{:08x}\",\"entry\":{text}}}\n", crc32fast::hash(text.as_bytes()));
    }
    fs::write(path, log).unwrap();
}

#[test]
fn a_clock_that_was_set_back_is_remarked_in_every_format_and_hides_no_dose_in_silence() {
    let user = User::new();
    (0..3).for_each(|_| drop(user.types(&["1mL"])));
    // The third dose was made after the second one, by a clock that had been set back by 27 hours.
    set_times(
        &user,
        &["2024-11-21T23:00:00+00:00", "2024-11-23T02:15:00+00:00", "2024-11-21T23:15:00+00:00"],
    );
    let remarked = |dose: &Value| dose["clock_went_back"] == true;
    let listed = objects(&user.types(&["log", "--format", "json"]).out);
    assert_eq!(listed.iter().map(remarked).collect::<Vec<_>>(), [false, false, true]);
    let csv = user.types(&["log", "--format", "csv"]).out;
    assert!(csv.lines().nth(3).unwrap().ends_with(",true,water,25,three-roller,sim,"), "{csv}");
    let text = user.types(&["log"]).out;
    assert!(text.contains("; the clock had gone back\n"), "{text}");
    assert!(text.contains("in 3 doses; the clock had gone back once"), "{text}");
    let totals = objects(&user.types(&["log", "--totals", "--format", "json"]).out);
    assert_eq!(totals.last().unwrap()["clock_went_back"], 1);
    let since = user.types(&["log", "--since", "2024-11-23T01:00:00Z", "--format", "json"]);
    assert_eq!(objects(&since.out).len(), 1);
    let told =
        "1 dose is left out: number 3, whose time is before --since although dose 2 at 2024-11-23T02:15";
    assert!(since.err.contains(&format!("warning: {told}")), "{}", since.err);
    assert_eq!(user.types(&["log", "--since", "1970-01-02"]).err, "");
}

#[test]
fn one_wrong_time_in_the_future_makes_no_later_list_warn() {
    let user = User::new();
    (0..4).for_each(|_| drop(user.types(&["1mL"])));
    let [ahead, day, later] =
        ["2999-01-01T00:00:00+00:00", "2024-11-21T23:15:00+00:00", "2024-11-22T23:15:00+00:00"];
    set_times(&user, &["2024-11-20T23:00:00+00:00", ahead, day, later]);
    let since = user.types(&["log", "--since", "2024-11-22", "--format", "json"]);
    let numbers: Vec<_> = objects(&since.out).iter().map(|dose| dose["number"].clone()).collect();
    assert_eq!((numbers, since.err.as_str()), (vec![json!(2), json!(4)], ""));
}

#[test]
fn a_total_has_what_was_pumped_in_either_direction() {
    let user = User::new();
    for words in [&["10mL"][..], &["purge", "--reverse", "15mL"]] {
        assert_eq!(user.types(words).code, 0);
    }
    let totals = objects(&user.types(&["log", "--totals", "--format", "json"]).out);
    let tube = totals.last().unwrap();
    assert!((number(tube, "delivered_ml") + 5.0).abs() < 0.01, "{tube}");
    assert!((number(tube, "pumped_ml") - 25.0).abs() < 0.01, "{tube}");
    let worn_ml = 1e3 * number(&user.json(&["tube"]), "volume_l");
    assert!((number(tube, "pumped_ml") - worn_ml).abs() < 0.01, "as the tube counts it: {worn_ml}");
}

#[test]
fn a_damaged_line_is_told_and_the_others_are_listed() {
    let user = User::new();
    (0..3).for_each(|_| drop(user.types(&["1mL"])));
    let path = user.path("state/three-roller/sim/log.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen("\"number\":2", "\"number\":9", 1)).unwrap();
    let answer = user.types(&["log", "--format", "json"]);
    assert_eq!((answer.code, objects(&answer.out).len()), (0, 2));
    assert!(answer.err.contains("line 2 of the log is damaged"), "{}", answer.err);
}

/// A log far larger than the memory that the command may have is listed to its end.
#[cfg(target_os = "linux")]
#[test]
fn a_log_is_listed_in_constant_memory() {
    const MEMORY_KIB: u64 = 65_536;
    const DOSES: u64 = 50_000;
    let user = User::new();
    user.types(&["1mL"]);
    let path = user.path("state/three-roller/sim/log.jsonl");
    let line: Value = serde_json::from_str(fs::read_to_string(&path).unwrap().trim()).unwrap();
    let mut to = BufWriter::new(File::create(&path).unwrap());
    for dose in 1..=DOSES {
        let mut entry = line["entry"].clone();
        entry["number"] = dose.into();
        entry["cause"] = "a long cause ".repeat(200).into();
        let text = entry.to_string();
        writeln!(to, "{{\"crc32\":\"{:08x}\",\"entry\":{text}}}", crc32fast::hash(text.as_bytes())).unwrap();
    }
    to.flush().unwrap();
    assert!(
        fs::metadata(&path).unwrap().len() > 1024 * MEMORY_KIB + (32 << 20),
        "the log is larger than the memory"
    );
    let script = format!("ulimit -v {MEMORY_KIB} && exec \"$@\"");
    let listed = |words: &[&str]| {
        let path = user.path("listed");
        let mut limited = Command::new("sh");
        limited.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_dose"), "log"]).args(words);
        limited.env("DOSE_STATE_DIR", user.path("state")).env("XDG_CONFIG_HOME", user.path("config"));
        limited.env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG").stdout(File::create(&path).unwrap());
        let output = limited.output().unwrap();
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        path
    };
    let text = fs::read_to_string(listed(&["--totals", "--format", "json"])).unwrap();
    assert!(objects(&text).iter().all(|total| total["doses"] == json!(DOSES)), "{text}");
    // The rows themselves: a dose each, a head in the table, and the totals of a day and a tube in the text.
    for (words, others) in [(&["--format", "json"][..], 0), (&["--format", "csv"], 1), (&[], 2)] {
        let rows = BufReader::new(File::open(listed(words)).unwrap()).split(b'\n').count() as u64;
        assert_eq!(rows, DOSES + others, "{words:?}");
    }
}

#[test]
fn a_run_that_was_killed_has_bounds_and_not_the_uncertainty_of_a_plan_without_end() {
    let user = User::new();
    let mut run = user.command(&["run", "--rate", "5mL/s", "--pace", "real"]);
    let mut run = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let moved =
        || user.json(&["status"])["unfinished"]["delivered_most_ml"].as_f64().is_some_and(|ml| ml > 0.0);
    let begun = Instant::now();
    while !moved() {
        assert!(begun.elapsed() < Duration::from_secs(30), "the run has not begun");
        sleep(Duration::from_millis(20));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    fs::create_dir_all(user.path("config/pump-dose")).unwrap();
    let pump = user.types(&["pumps", "show", "three-roller"]).out;
    fs::write(user.path("config/pump-dose/three.toml"), pump).unwrap();
    let config = "schema = \"config/1\"\n[pumps]\nthree = \"three.toml\"\n";
    fs::write(user.path("config/pump-dose/config.toml"), config).unwrap();
    let row = user.types(&["status", "--all"]).out;
    assert!(
        row.contains("unfinished: a run until it is stopped, of which between ")
            && row.contains("; at ")
            && row.contains("° ± "),
        "{row}"
    );

    assert_eq!(user.types(&["accept"]).code, 0);
    let dose = &objects(&user.types(&["log", "--format", "json"]).out)[0];
    let [least_ml, most_ml, middle_ml] =
        ["delivered_least_ml", "delivered_most_ml", "delivered_ml"].map(|key| number(dose, key));
    assert!(least_ml <= middle_ml && middle_ml <= most_ml && most_ml < 1000.0, "{dose}");
    assert_eq!(dose["expanded_uncertainty_ml"], Value::Null);
}

#[test]
fn a_dry_run_beyond_a_limit_says_that_the_pump_would_stand() {
    let user = User::new();
    let refused = user.types(&["5mL", "--repeat", "3", "--max-per-day", "12mL", "--dry-run"]);
    assert_eq!(refused.code, 5);
    assert!(refused.err.contains("would stand at a safety limit: "), "{}", refused.err);
    assert!(!refused.err.contains("dose safety clear"), "{}", refused.err);
}
