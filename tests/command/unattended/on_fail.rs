//! The command that a failure runs.

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::user::User;

const TELL: &str = "cat > reason.json; env | grep ^DOSE_FAIL_ | sort > reason.env";

fn told(user: &User) -> (Value, String) {
    let reason = fs::read_to_string(user.path("reason.json")).unwrap();
    assert_eq!(reason.lines().count(), 1);
    (serde_json::from_str(&reason).unwrap(), fs::read_to_string(user.path("reason.env")).unwrap())
}

#[test]
fn a_refusal_is_told_with_its_reason_and_its_exit_code_stays() {
    let user = User::new();
    let answer = user.types(&["1000L", "--on-fail", TELL]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.starts_with("error: ") && answer.err.lines().count() == 1, "{}", answer.err);
    let (reason, environment) = told(&user);
    assert_eq!((&reason["schema"], &reason["code"]), (&"error/1".into(), &2.into()));
    let kind = reason["kind"].as_str().unwrap();
    assert_eq!(
        environment,
        format!(
            "DOSE_FAIL_CODE=2\nDOSE_FAIL_KIND={kind}\nDOSE_FAIL_LEAST_ML=0\nDOSE_FAIL_MOST_ML=0\n\
             DOSE_FAIL_PUMP=three-roller\nDOSE_FAIL_RACK=\n"
        )
    );
    // A dose that is made, and a dry run, tell nobody.
    fs::remove_file(user.path("reason.json")).unwrap();
    assert_eq!(user.types(&["1mL", "--on-fail", TELL]).code, 0);
    assert_eq!(user.types(&["1000L", "--dry-run", "--on-fail", TELL]).code, 2);
    assert!(!user.path("reason.json").exists());
}

#[test]
fn the_configuration_names_the_command_for_doses_without_a_terminal() {
    let user = User::new();
    fs::create_dir_all(user.path("config/pump-dose")).unwrap();
    let config = format!("schema = \"config/1\"\ndefault_pump = \"two-roller\"\non_fail = '{TELL}'\n");
    fs::write(user.path("config/pump-dose/config.toml"), config).unwrap();
    let limited = ["5mL", "--max-per-day", "4mL"];
    let mut command = user.command(&limited);
    assert_eq!(command.stdin(Stdio::null()).output().unwrap().status.code(), Some(5));
    let (reason, environment) = told(&user);
    assert_eq!((&reason["code"], &reason["kind"]), (&5.into(), &"safety".into()));
    assert!(environment.contains("DOSE_FAIL_PUMP=two-roller"), "{environment}");
    let shown = user.json(&["config", "show"]);
    assert_eq!(shown["on_fail"], TELL);
}

#[test]
fn a_command_that_fails_or_hangs_is_a_warning() {
    let user = User::new();
    let failed = user.types(&["1000L", "--on-fail", "exit 3", "--format", "json"]);
    assert_eq!(failed.code, 2);
    assert!(failed.err.contains("warning: the command of --on-fail, `exit 3`, ended with"), "{}", failed.err);
    let last: Value = serde_json::from_str(failed.err.lines().last().unwrap()).unwrap();
    assert_eq!(last["schema"], "error/1", "the error is the last line");
    let began = Instant::now();
    // A process that the shell starts is ended with it.
    let hung = user.types(&["1000L", "--on-fail", "(sleep 61; echo late > late) & wait"]);
    assert_eq!(hung.code, 2);
    assert!(hung.err.contains("was ended after 10 s"), "{}", hung.err);
    assert!(began.elapsed() >= Duration::from_secs(10) && began.elapsed() < Duration::from_secs(50));
}

#[test]
fn the_rest_of_a_dose_and_a_calibration_tell_their_failure_too() {
    let user = User::new();
    for words in [
        &["resume"][..],
        &["calibrate", "run", "--speeds", "10000rpm"],
        &["calibrate", "verify", "--volume", "1000L", "--runs", "2"],
    ] {
        let answer = user.types(&[words, &["--on-fail", TELL]].concat());
        let (reason, _) = told(&user);
        assert_eq!((answer.code, &reason["code"]), (2, &2.into()), "{words:?}: {}", answer.err);
        fs::remove_file(user.path("reason.json")).unwrap();
    }
    // A dry run tells nobody.
    assert_eq!(user.types(&["resume", "--dry-run", "--on-fail", TELL]).code, 2);
    assert!(!user.path("reason.json").exists());
}

#[test]
fn a_stopped_dose_tells_the_bounds_that_its_report_has() {
    let user = User::new();
    assert_eq!(user.types(&["home", "--set", "30deg", "--tolerance", "5deg"]).code, 0);
    let words = ["3L", "--on-fail", TELL, "--format", "json"];
    let child = user.command(&words).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    user.until_moved("three-roller");
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    let stopped = child.wait_with_output().unwrap();
    assert_eq!(stopped.status.code(), Some(130));
    let report: Value = serde_json::from_slice(&stopped.stdout).unwrap();
    let (_, environment) = told(&user);
    let bound = |name: &str| -> f64 {
        let line = environment.lines().find_map(|line| line.strip_prefix(name)).unwrap();
        line.trim_start_matches('=').parse().unwrap()
    };
    let (least_ml, most_ml) = (bound("DOSE_FAIL_LEAST_ML"), bound("DOSE_FAIL_MOST_ML"));
    let stated = ["volume_least_ml", "volume_most_ml"].map(|key| report[key].as_f64().unwrap());
    assert!(most_ml > least_ml, "{environment}");
    assert!((least_ml - stated[0]).abs() < 1e-9 && (most_ml - stated[1]).abs() < 1e-9, "{report}");
}
