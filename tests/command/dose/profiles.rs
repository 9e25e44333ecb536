//! `dose run --profile`: a flow over time.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::user::{User, number};

/// Volume of a motor step where the built-in pump gives most, in mL: 4.398 mL/rad at 12,800 steps.
const STEP_ML: f64 = 4.398 * std::f64::consts::TAU / 12_800.0;

/// A flow with a slope, a level, a small step, a pause and a way back to rest: 5 + 12 + 0.8 + ... mL.
const ROWS: &str = "time_s,flow_ml_s\n0,0\n5,2\n11,2\n11,1.9\n12,0\n15,0\n18,1.5\n20,0\n";

/// Volume of these rows, in mL, by trapezoids.
const VOLUME_ML: f64 = 5.0 + 12.0 + 0.95 + 2.25 + 1.5;

fn user(rows: &str) -> User {
    let user = User::new();
    fs::write(user.path("flow.csv"), rows).unwrap();
    user
}

#[test]
fn a_profile_delivers_its_volume_in_its_time_and_the_record_goes_on_from_there() {
    let user = user(ROWS);
    let run = user.json(&["run", "--profile", "flow.csv"]);
    let planned = number(&run, "planned_ml");
    assert!((0.0..STEP_ML).contains(&(VOLUME_ML - planned)), "{planned}");
    // The vessel has what left the line.
    assert!((number(&run, "delivered_ml") - planned).abs() < 1e-4, "{run}");
    assert_eq!((&run["purpose"], &run["completed"]), (&"run".into(), &true.into()));
    assert_eq!(run["carry_ml"], 0.0);
    let told = &run["run"];
    assert_eq!((&told["until"], &told["was_stopped"]), (&"profile".into(), &false.into()));
    assert_eq!(told["profile"]["name"], "flow.csv");
    assert!((number(&told["profile"], "volume_ml") - VOLUME_ML).abs() < 1e-9);
    assert_eq!(number(&told["profile"], "time_s"), 20.0);
    assert!((number(&told["profile"], "largest_departure_ml") / STEP_ML - 1.0).abs() < 1e-3);
    let status = user.json(&["status"]);
    assert_eq!(status["unfinished"], Value::Null);
    assert!((number(&status["wear"], "volume_ml") - planned).abs() < 1e-6);
    // The angle is known still, so another follows, back this time.
    let back = user.json(&["run", "--profile", "flow.csv", "--reverse"]);
    assert!((number(&back, "delivered_ml") + VOLUME_ML).abs() < 2.0 * STEP_ML, "{back}");
    let text = user.types(&["run", "--profile", "flow.csv", "--dry-run"]);
    assert!(text.out.contains("profile flow.csv: 21.7 mL in 20 s at the rollers"), "{}", text.out);
    let log = user.types(&["log", "--format", "csv"]).out;
    assert!(log.contains("flow.csv"), "{log}");
}

#[test]
fn at_a_thousand_instants_the_steps_file_is_within_a_step_of_the_rows() {
    let user = user(ROWS);
    user.types(&[
        "run",
        "--profile",
        "flow.csv",
        "--dry-run",
        "--steps",
        "steps.csv",
        "--trace",
        "trace.csv",
    ]);
    let read = |name: &str| -> Vec<Vec<f64>> {
        let text = fs::read_to_string(user.path(name)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let (steps, rows) = (read("steps.csv"), read("flow.csv"));
    let pump = pump_model::Pump::three_roller();
    let volume_ml = |angle_rad: f64| pump.outlet_curve().volume_ml(angle_rad);
    let start_ml = volume_ml(0.0);
    for instant in 0..1000 {
        let until_s = 0.0203 * f64::from(instant);
        // Volume of the rows up to then: trapezoids of their straight lines.
        let mut wanted_ml = 0.0;
        for pair in rows.windows(2) {
            let (from_s, to_s) = (pair[0][0], pair[1][0].min(until_s));
            if to_s > from_s {
                let slope = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
                wanted_ml += (to_s - from_s) * (pair[0][1] + 0.5 * slope * (to_s - from_s));
            }
        }
        let made = steps.partition_point(|step| step[1] <= until_s);
        let stands_rad = if made == 0 { 0.0 } else { steps[made - 1][3] };
        let behind_ml = wanted_ml - (volume_ml(stands_rad) - start_ml);
        assert!((-1e-6..1.01 * STEP_ML).contains(&behind_ml), "{until_s} s: {behind_ml} mL");
    }
    // The trace's flow at the rollers is that of the rows.
    let trace = read("trace.csv");
    let at = |time_s: f64| trace.iter().find(|row| row[0] >= time_s).unwrap()[4];
    for (time_s, flow_ml_s) in [(2.5, 1.0), (8.0, 2.0), (13.0, 0.0), (16.5, 0.75)] {
        assert!((at(time_s) - flow_ml_s).abs() < 0.03 * flow_ml_s + 1e-3, "{time_s}: {}", at(time_s));
    }
}

#[test]
fn what_cannot_be_met_is_refused_with_its_first_instant_and_nothing_moves() {
    for (rows, words) in [
        ("0,0\n10,100\n", "rad/s2 where the rollers stand then; the pump's limit is 500.0 rad/s2"),
        ("0,10\n10,10\n", "at 0.0000 s, in row 2, the flow steps from 0 to 10 mL/s"),
        ("0,0\n5,2\n4,2\n", "row 4 has the time 4 s after 5 s; times do not go back"),
        ("-1,0\n5,2\n", "row 2 has the time -1 s; allowed: 0 in the first row"),
        ("2,0\n5,2\n", "row 2 has the time 2 s"),
        ("0,0\n5,2\n9,-1\n", "row 4 has the flow -1 mL/s against the direction"),
        ("0,0\n5,0\n", "two rows or more at different times, and one with a flow"),
        ("", "one with a flow; rows of this one: 0"),
        ("0,0\n5,\n", "the profile cannot be used: line 3: flow_ml_s is missing"),
        ("0,0\n5,nan\n", "flow_ml_s is `nan`"),
        ("0,0\nabc,2\n", "the profile cannot be used: line 3: time_s is `abc`"),
        ("0,0\n5\n", "line 3: 1 cells under 2 columns"),
    ] {
        let user = user(&format!("time_s,flow_ml_s\n{rows}"));
        let refused = user.is_refused(&["run", "--profile", "flow.csv"]);
        assert!(refused.contains(words), "{rows:?}: {refused}");
    }
    let headless = user("0,0\n5,2\n").is_refused(&["run", "--profile", "flow.csv"]);
    assert!(headless.contains("unknown column `0`; known: time_s, flow_ml_s"), "{headless}");
    let half = user("time_s\n0\n").is_refused(&["run", "--profile", "flow.csv"]);
    assert!(half.contains("no column `flow_ml_s`"), "{half}");
    let limits = user(ROWS).is_refused(&["run", "--profile", "flow.csv", "--max-outlet-pressure", "88kPaa"]);
    assert!(
        limits.contains("the pressure at the outlet would reach") && limits.contains("at most 88.00 kPa"),
        "{limits}"
    );
    let none = user(ROWS).is_refused(&["run", "--profile", "none.csv"]);
    assert!(none.contains("none.csv"), "{none}");
    let own = user(ROWS).is_refused(&["run", "--profile", "flow.csv", "--steps", "flow.csv", "--dry-run"]);
    assert!(own.contains("flow.csv"), "{own}");
    for options in [&["--rate", "1mL/s"][..], &["--smooth"], &["--for", "1min"], &["--volume", "1L"]] {
        user(ROWS).is_refused(&[&["run", "--profile", "flow.csv"], options].concat());
    }
}

#[test]
fn a_flow_that_the_motor_cannot_meet_is_refused_with_the_part_and_the_acceleration_that_could() {
    let rows = |ml_s: f64| format!("time_s,flow_ml_s\n0,0\n5,{ml_s}\n10,{ml_s}\n15,0\n");
    let dry = ["run", "--profile", "flow.csv", "--dry-run"];
    let way_out = |refused: &str, words: &str| -> f64 {
        refused.split(words).next().unwrap().rsplit(' ').next().unwrap().parse().unwrap()
    };
    let user = user(&rows(6.0));
    let refused = user.is_refused(&dry[..3]);
    for said in [
        "in the stretch to row 3, the flow needs",
        "[motor] max_acceleration_rad_s2",
        "`dose run --rate <FLOW>`",
    ] {
        assert!(refused.contains(said), "{said}: {refused}");
    }
    // A level flow Q needs 27.6 Q² rad/s² of the built-in pump (PHYSICS section 9), of 500 rad/s².
    let enough_rad_s2 = way_out(&refused, " rad/s2 could as it is");
    assert!((0.98..1.03).contains(&(enough_rad_s2 / (27.6 * 36.0))), "{refused}");
    let factor = way_out(&refused, " times these flows could");
    assert!((0.69..0.72).contains(&factor), "{refused}");
    fs::write(user.path("flow.csv"), rows(6.0 * factor)).unwrap();
    assert_eq!(user.types(&dry).code, 0, "the smaller flow can be met");
    // No acceleration helps a head whose default pulse leaves less flow than its fastest speed makes up for.
    fs::write(user.path("head.toml"), include_str!("../../../examples/pumps/bought-head.toml")).unwrap();
    fs::write(user.path("flow.csv"), rows(0.1)).unwrap();
    let refused = user.is_refused(&[&dry[..], &["--pump", "head.toml"]].concat());
    assert!(!refused.contains("a motor of"), "{refused}");
    fs::write(user.path("flow.csv"), rows(0.1 * way_out(&refused, " times these flows could"))).unwrap();
    assert_eq!(user.types(&[&dry[..], &["--pump", "head.toml"]].concat()).code, 0);
}

#[test]
fn an_angle_that_is_not_known_to_a_step_is_refused_with_the_way_to_know_it() {
    let user = user(ROWS);
    user.types(&["home", "--set", "30deg"]);
    let refused = user.is_refused(&["run", "--profile", "flow.csv"]);
    assert!(refused.contains("to a motor step of 0.0281 degrees"), "{refused}");
    assert!(refused.contains("dose home --set <ANGLE> --tolerance 0deg"), "{refused}");
    user.types(&["home", "--set", "30deg", "--tolerance", "0deg"]);
    assert_eq!(user.types(&["run", "--profile", "flow.csv"]).code, 0);
}

#[test]
fn a_board_that_plans_its_own_ramps_is_refused_and_the_node_is_named() {
    let user = user(ROWS);
    let words =
        ["run", "--profile", "flow.csv", "--driver", "grbl", "--dry-run", "--start-angle", "0deg+-0deg"];
    let refused = user.is_refused(&words);
    assert!(refused.contains("the grbl driver has no way to follow a flow over time"), "{refused}");
    assert!(refused.contains("driver = \"node\""), "{refused}");
    let mut words = words;
    words[4] = "node";
    let planned = user.types(&words);
    assert_eq!(planned.code, 0, "{}", planned.err);
}

#[test]
fn a_profile_that_was_killed_cannot_be_resumed_and_its_bounds_hold_what_was_delivered() {
    let rows: String =
        (0..=4000).map(|n| format!("{},{}\n", n, if n == 0 || n == 4000 { 0.0 } else { 1.5 })).collect();
    let user = user(&format!("time_s,flow_ml_s\n{rows}"));
    let journal = "state/three-roller/sim/journal.jsonl";
    let mut child = user
        .command(&["run", "--profile", "flow.csv", "--format", "json"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    let progress = || {
        let text = fs::read_to_string(user.path(journal)).unwrap_or_default();
        text.lines().filter(|line| line.contains("progress")).count()
    };
    while progress() < 5 {
        assert!(Instant::now() < deadline, "no progress on record");
        sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let status = user.json(&["status"]);
    let unfinished = &status["unfinished"];
    let (least, most) = (number(unfinished, "delivered_least_ml"), number(unfinished, "delivered_most_ml"));
    assert!(0.0 < least && least < most && most - least < 2.0 && most < 5998.5, "{status}");
    assert_eq!((&unfinished["over_time"], &unfinished["until_stopped"]), (&true.into(), &false.into()));
    let told = user.types(&["status"]).out;
    assert!(told.contains("a flow over time of 5998.5 mL, of which"), "{told}");
    assert!(told.contains("no rest of it can be made") && !told.contains("dose resume"), "{told}");
    let dose = user.types(&["1mL"]);
    assert!(dose.code == 4 && !dose.err.contains("dose resume"), "{}", dose.err);
    let refused = user.types(&["resume"]);
    assert_eq!(refused.code, 4, "{}", refused.err);
    assert!(refused.err.contains("its times have passed, so no rest can be made"), "{}", refused.err);
    assert_eq!(user.types(&["run", "--profile", "flow.csv"]).code, 4);
    assert_eq!(user.types(&["discard"]).code, 0);
    assert_eq!(user.json(&["status"])["unfinished"], Value::Null);
}

#[test]
fn a_stopped_profile_wears_its_tube_for_the_time_that_it_turned() {
    // Most of the volume comes after a long pause, so that a part of the steps is no part of the time.
    let user = user("time_s,flow_ml_s\n0,0\n1,3\n2,0\n60,0\n61,3\n62,0\n");
    let words = ["run", "--profile", "flow.csv", "--pace", "real"];
    let mut child = user.command(&words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    while user.record().is_none_or(|text| text.matches("progress").count() <= 2) {
        assert!(Instant::now() < deadline, "no progress on record");
        sleep(Duration::from_millis(20));
    }
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let logged: Value = serde_json::from_str(user.types(&["log", "--format", "json"]).out.trim()).unwrap();
    let (worn_s, logged_s) =
        (number(&user.json(&["status"])["wear"], "motion_s"), number(&logged, "motion_s"));
    assert!(logged_s > 0.0 && logged_s < 60.0 && (worn_s - logged_s).abs() < 1e-9, "{worn_s} {logged_s}");
}
