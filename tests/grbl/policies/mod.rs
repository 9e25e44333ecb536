//! Claims about doses without a person on a board whose motor was let go.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::pump_file::{DriveTable, DriverName, HomePolicy};
use pump_bench::{Bench, PumpFile, built_in};

use crate::rig::plug;
use crate::simulated::Simulated;
use crate::simulated::options::{Options, Sensor};

/// A board with an index sensor, and a pump whose doses without a person do as `home` says.
fn bench(folder: &Path, home: HomePolicy) -> (Simulated, PathBuf) {
    let sensor = Some(Sensor { at: 4000, width: 128, every: 12_800 });
    let board = plug(Options { time_scale: 4.0, sensor, ..Options::default() });
    let mut file = built_in("three-roller").unwrap();
    let table = DriveTable::of(DriverName::Grbl).with_index_angle_deg(40.0);
    file.drive = Some(table.with_port(board.path()));
    file.motor.confirmed = None;
    file.safety.home = Some(home);
    let pump = folder.join("pump.toml");
    fs::write(&pump, file.to_toml()).unwrap();
    (board, pump)
}

fn types(folder: &Path, pump: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    command.args(words).arg("--pump").arg(pump).env("DOSE_STATE_DIR", folder.join("state"));
    command.env("XDG_CONFIG_HOME", folder).env_remove("DOSE_CONFIG").stdin(Stdio::null()).output().unwrap()
}

/// A dose after the motor was let go. The angle was stated to 1 deg, and two full steps are 3.6 deg.
fn after_release(folder: &Path, pump: &Path) -> Output {
    for words in [&["home", "--set", "0deg"][..], &["release"]] {
        let done = types(folder, pump, words);
        assert_eq!(done.status.code(), Some(0), "{words:?}: {done:?}");
    }
    types(folder, pump, &["0.5mL", "--rate", "2mL/s", "--format", "json"])
}

#[test]
fn a_dose_without_a_person_does_as_the_pump_file_says_once_the_angle_was_disturbed() {
    for (home, code) in [(HomePolicy::Refuse, 2), (HomePolicy::Accept, 0), (HomePolicy::Sensor, 0)] {
        let folder = tempfile::tempdir().unwrap();
        let (board, pump) = bench(folder.path(), home);
        let output = after_release(folder.path(), &pump);
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.code(), Some(code), "{home}: {out}{err}");
        match home {
            HomePolicy::Refuse => {
                assert_eq!(board.rest().steps, 0, "nothing moved");
                assert!(
                    err.contains("\"kind\":\"angle\"") && err.contains("known within 4.6 deg now"),
                    "{err}"
                );
            }
            HomePolicy::Accept => {
                assert!(
                    err.contains("known within 4.6 deg now: [safety] home = \"accept\" doses from it"),
                    "{err}"
                );
                assert!(out.contains("\"half_width_deg\":4.6"), "{out}");
            }
            HomePolicy::Sensor => {
                assert!(board.rest().steps > 4000, "the rotor passed the sensor");
                assert!(err.contains("turned to its index sensor first and pumped"), "{err}");
                assert!(!out.contains("\"half_width_deg\":4.6"), "{out}");
            }
        }
    }
}

#[test]
fn a_rest_without_a_person_turns_to_the_sensor_first_once_the_angle_was_disturbed() {
    let folder = tempfile::tempdir().unwrap();
    let (board, pump) = bench(folder.path(), HomePolicy::Sensor);
    assert_eq!(types(folder.path(), &pump, &["home", "--set", "0deg"]).status.code(), Some(0));
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    command
        .args(["20mL", "--rate", "2mL/s", "--pump"])
        .arg(&pump)
        .env("DOSE_STATE_DIR", folder.path().join("state"));
    command.env("XDG_CONFIG_HOME", folder.path()).env_remove("DOSE_CONFIG").stdin(Stdio::null());
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    while board.truth().steps < 500 {
        assert!(Instant::now() < deadline, "the board does not move");
        sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(types(folder.path(), &pump, &["release"]).status.code(), Some(0));
    let output = types(folder.path(), &pump, &["resume", "--format", "json"]);
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(err.contains("turned to its index sensor first and pumped"), "{err}");
    assert!(out.contains("\"completed\":true"), "{out}");
}

/// A dose waits for the port that a pump of another name has, says for whom, and goes on once the port is free.
#[test]
fn a_dose_waits_for_a_port_that_another_pump_has() {
    let folder = tempfile::tempdir().unwrap();
    let (board, pump) = bench(folder.path(), HomePolicy::Accept);
    let state = folder.path().join("state");
    let mut file = PumpFile::read(&pump).unwrap();
    file.pump.id = "other".to_owned();
    let other = Bench::new(file, None, &state).unwrap();
    let mut session = other.session().unwrap();
    session.connect().unwrap();
    let refused = types(folder.path(), &pump, &["0.5mL", "--rate", "2mL/s"]);
    assert_eq!(refused.status.code(), Some(3), "at once without --wait: {refused:?}");
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    command.args(["0.5mL", "--rate", "2mL/s", "--wait", "600s", "--pump"]).arg(&pump);
    command.env("DOSE_STATE_DIR", &state).env("XDG_CONFIG_HOME", folder.path()).env_remove("DOSE_CONFIG");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let port = board.path().display().to_string();
    assert!(
        line.starts_with(&format!("waiting for {port}, in use by process {}", std::process::id())),
        "{line}"
    );
    assert_eq!(board.rest().steps, 0, "nothing moved meanwhile");
    drop(session);
    let ended = child.wait_with_output().unwrap();
    assert!(ended.status.success(), "{ended:?}");
    assert!(board.rest().steps > 0);
}
