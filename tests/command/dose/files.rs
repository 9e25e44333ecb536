//! Step lists, traces, plots and the report itself.

use std::fs;

use crate::user::{User, number, rows};

#[test]
fn steps_and_trace_are_what_the_report_says() {
    let user = User::new();
    let arguments = ["3mL", "--start-angle", "100deg", "--dry-run", "--steps", "s.csv", "--trace", "t.csv"];
    let report = user.json(&arguments);
    let (header, steps) = rows(&user.path("s.csv"));
    assert_eq!(header, "step,time_s,direction,angle_rad");
    assert_eq!(steps.len() as i64, report["steps"].as_i64().unwrap());
    assert_eq!(steps[0][0], 1.0);
    let last = steps.last().unwrap();
    assert_eq!(last[1], number(&report, "motion_s"));
    assert!((last[3].to_degrees() - number(&report, "end_angle_deg")).abs() < 1e-9);
    assert!(steps.iter().all(|step| step[2] == 1.0));

    let (header, trace) = rows(&user.path("t.csv"));
    assert_eq!(header, "time_s,angle_rad,speed_rad_s,q_in_ml_s,q_out_ml_s,p_in_kpa,p_out_kpa,delivered_ml");
    assert!(trace.iter().any(|row| row[0] == number(&report, "motion_s")));
    assert!((trace[1][0] - 1e-3).abs() < 1e-15);
    let end = trace.last().unwrap();
    assert_eq!(end[0], number(&report, "motion_s") + number(&report, "settle_s"));
    assert!((end[7] - number(&report, "planned_ml")).abs() < 1.01e-3, "less than 1 uL is undelivered");
    let highest = trace.iter().map(|row| row[6]).fold(f64::NEG_INFINITY, f64::max);
    let reported = number(&report, "outlet_max_kpa");
    assert!(highest <= reported + 1e-3 && highest > reported - 0.05, "{highest} for {reported}");
}

#[test]
fn a_plot_is_written_whole() {
    let user = User::new();
    assert!(user.is_refused(&["25mL", "--plot", "dose.png"]).contains("dose.png: plots are SVG"));
    user.json(&["25mL", "--plot", "dose.svg"]);
    let svg = fs::read_to_string(user.path("dose.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    let panels =
        ["flow at the rollers, mL/s", "pressure, kPa absolute", "speed, r/min", "delivered, mL", "time, s"];
    for text in panels.into_iter().chain(["requested", "by one constant", "prefers-color-scheme:dark"]) {
        assert!(svg.contains(text), "{text}");
    }
    let labels: Vec<_> = svg.lines().map(str::trim).filter(|line| line.parse::<f64>().is_ok()).collect();
    assert!(labels.len() > 20 && labels.contains(&"30"), "{labels:?}");
    assert!(labels.iter().all(|label| !label.contains('.') || !label.ends_with('0')), "needless: {labels:?}");
}

#[test]
fn unwritable_outputs_are_refused_before_anything_moves() {
    let user = User::new();
    fs::create_dir(user.path("folder")).unwrap();
    for option in ["--steps", "--trace", "--plot"] {
        for target in ["no/such/folder/file", "folder"] {
            let message = user.is_refused(&["25mL", option, target]);
            assert!(message.contains("cannot write") && message.contains(target), "{message}");
        }
    }
    user.is_refused(&["25mL", "--steps", "steps.csv", "--plot", "no/such/folder/file"]);
    fs::write(user.path("acid.toml"), "a pump file").unwrap();
    let message = user.is_refused(&["25mL", "--dry-run", "--steps", "acid.toml"]);
    assert!(message.contains("acid.toml: there is a TOML file, and it would be lost"), "{message}");
    assert_eq!(fs::read_to_string(user.path("acid.toml")).unwrap(), "a pump file");
    assert!(!user.path("steps.csv").exists(), "all outputs or none");
    assert!(user.is_refused(&["25mL", "--steps", "x", "--trace", "x"]).contains("two outputs"));
    assert!(user.is_refused(&["25mL", "--steps", "./x", "--trace", "x"]).contains("two outputs"));
    assert!(user.is_refused(&["25mL", "--steps", "-"]).contains("no file"));
    assert!(user.is_refused(&["25mL", "--dt", "1s"]).contains("--trace"));
    let left: Vec<_> =
        fs::read_dir(user.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(
        left.iter().all(|name| ["acid.toml", "folder", "state"].iter().any(|known| name == known)),
        "{left:?}"
    );
    assert!(user.is_refused(&["25mL", "--state-dir", "/dev/null/x"]).contains("--state-dir"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_that_does_not_fit_is_named_and_its_temporary_file_is_not() {
    let user = User::new();
    let script = "trap '' XFSZ; prlimit --fsize=20000 --pid $$; exec \"$@\"";
    let mut command = user.command(&["25mL", "--dry-run", "--steps", "steps.csv"]);
    let program = command.get_program().to_owned();
    let envs: Vec<_> = command
        .get_envs()
        .map(|(name, value)| (name.to_owned(), value.unwrap_or_default().to_owned()))
        .collect();
    command = std::process::Command::new("bash");
    command.args(["-c", script, "limited"]).arg(program).args(["25mL", "--dry-run", "--steps", "steps.csv"]);
    let output = command.envs(envs).env_remove("DOSE_PUMP").current_dir(user.folder.path()).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot write steps.csv: File too large"), "{message}");
    assert!(!message.contains(".dose-"), "{message}");
}

#[test]
fn a_state_folder_that_is_named_by_a_relative_path_in_the_environment_is_ignored() {
    let user = User::new();
    let status = |state: &str| {
        let mut command = user.command(&["status", "--format", "json"]);
        command.env_remove("DOSE_STATE_DIR").env("HOME", user.path("home")).env("XDG_STATE_HOME", state);
        let output = command.output().unwrap();
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        report["folder"].as_str().unwrap().to_owned()
    };
    let home = user.path("home/.local/state/pump-dose/three-roller/sim").display().to_string();
    assert_eq!(status("relative/folder"), home);
    let absolute = user.path("xdg").display().to_string();
    assert_eq!(status(&absolute), format!("{absolute}/pump-dose/three-roller/sim"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_report_that_cannot_be_printed_does_not_hide_the_dose() {
    let user = User::new();
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let output = user.command(&["5mL"]).stdout(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("mL were delivered and recorded"), "{message}");
    assert!(user.record().is_some());
    let output = user.command(&["5mL", "--dry-run"]).stdout(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "nothing moved");
}
