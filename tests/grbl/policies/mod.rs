//! Claims about doses without a person on a board whose motor was let go.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use pump_bench::built_in;
use pump_bench::pump_file::{DriveTable, DriverName, HomePolicy};

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
                    err.contains("known within 4.6 deg: [safety] home = \"accept\" doses from it"),
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
