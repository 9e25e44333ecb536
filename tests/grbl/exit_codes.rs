//! Claims about the command's exit codes with a board. The code is 2 only if nothing has moved.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use pump_bench::built_in;
use pump_bench::pump_file::{DriveTable, DriverName};

use crate::rig::start;
use crate::simulated::options::{Options, Sensor};

/// Runs `dose home --sensor --yes` on a board of its own. The journal may grow to `bytes`.
fn search(folder: &Path, bytes: Option<u64>) -> Output {
    let sensor = Some(Sensor { at: 4000, width: 128, every: 12_800 });
    let board = start(Options { time_scale: 4.0, sensor, ..Options::default() });
    let mut file = built_in("three-roller").unwrap();
    let table = DriveTable { index_angle_deg: Some(40.0), ..DriveTable::of(DriverName::Grbl) };
    file.drive = Some(DriveTable { port: Some(board.path().to_owned()), ..table });
    let pump = folder.join("pump.toml");
    fs::write(&pump, file.to_toml()).unwrap();
    let limit = bytes.map_or("unlimited".to_owned(), |bytes| bytes.to_string());
    // The shell ignores the signal, so a write beyond the limit fails as on a full disk.
    let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$@\"";
    let mut command = Command::new("bash");
    command.args(["-c", script, &limit, env!("CARGO_BIN_EXE_dose"), "home", "--sensor", "--yes", "--pump"]);
    command.arg(&pump).env("DOSE_STATE_DIR", folder.join("state"));
    command.output().unwrap()
}

#[test]
#[cfg(target_os = "linux")]
fn an_angle_that_cannot_be_recorded_after_the_search_exits_with_1_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let output = search(folder.path(), None);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let journal = folder.path().join("state/three-roller/grbl/journal.jsonl");
    let lines = fs::read_to_string(&journal).unwrap();

    let full = tempfile::tempdir().unwrap();
    let output = search(full.path(), Some(lines.len() as u64 - 40));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("the rotor was turned and stands at 4") && said.contains("could not be recorded"),
        "{said}"
    );
}
