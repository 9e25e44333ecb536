//! Claims about the command's exit codes with a board. The code is 2 only if nothing has moved.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use pump_bench::pump_file::{DriveTable, DriverName, PumpFile};
use pump_bench::report::Ending;
use pump_bench::{Bench, DoseError, DoseRequest, built_in};

use crate::rig::plug;
use crate::simulated::Simulated;
use crate::simulated::options::{Defects, Options, Sensor};

/// Writes the file of a pump with this board.
fn pump_file(folder: &Path, board: &Simulated) -> PathBuf {
    let mut file = built_in("three-roller").unwrap();
    let table = DriveTable::of(DriverName::Grbl).with_index_angle_deg(40.0);
    file.drive = Some(table.with_port(board.path()));
    file.motor.confirmed = None;
    let pump = folder.join("pump.toml");
    fs::write(&pump, file.to_toml()).unwrap();
    pump
}

/// Prepares the command with a pump that has this board.
fn command(folder: &Path, board: &Simulated, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    command.args(words).arg("--pump").arg(pump_file(folder, board));
    command.env("DOSE_STATE_DIR", folder.join("state")).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Interrupts the command once `when` returns true. Returns its output.
fn interrupt(mut command: Command, when: impl Fn() -> bool) -> Output {
    let child = command.spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    while !when() {
        assert!(Instant::now() < deadline, "the moment never came");
        std::thread::sleep(Duration::from_millis(2));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    child.wait_with_output().unwrap()
}

/// Returns a board that never falls silent.
fn talkative(defects: Defects) -> Simulated {
    let auto_report = Some(Duration::from_millis(10));
    plug(Options { auto_report, chatters: true, defects, ..Options::default() })
}

#[test]
#[cfg(unix)]
fn ctrl_c_is_heard_at_rest_and_in_motion_whatever_the_board_says() {
    let folder = tempfile::tempdir().unwrap();
    // Another program moves the board, and the command waits for rest.
    let board = talkative(Defects { foreign: Some((0, 10_000.0)), ..Defects::default() });
    let asked = board.truth().asked;
    let dose = command(folder.path(), &board, &["3mL"]);
    let output = interrupt(dose, || board.truth().asked > asked + 12);
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    assert!(board.truth().moving, "it waited for the other program");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("before anything moved"), "{said}");

    let folder = tempfile::tempdir().unwrap();
    let board = talkative(Defects::default());
    let output = interrupt(command(folder.path(), &board, &["20mL"]), || board.truth().steps > 1_000);
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let made = board.rest().steps;
    assert!(made < 10_000, "it went on to the end: {made}");
    let output = command(folder.path(), &board, &["status", "--format", "json"]).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let exactly = format!("\"steps_made_least\":{made},\"steps_made_most\":{made},");
    assert!(said.contains(&exactly), "{made}: {said}");
}

#[test]
fn a_hold_exits_with_1_and_the_rest_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options {
        defects: Defects { pressed: Some((900, b'!')), ..Defects::default() },
        patient: true,
        ..Options::default()
    });
    let output = command(folder.path(), &board, &["3mL"]).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("stopped by somebody else") && said.contains("dose resume"), "{said}");
    let made = board.rest().steps;
    let output = command(folder.path(), &board, &["resume"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(board.rest().steps > made + 500);
}

#[test]
fn settings_that_changed_exit_with_2_until_they_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let run = |settings: Vec<(u16, f32)>, words: &[&str]| {
        let board = plug(Options { settings, ..Options::default() });
        let output = command(folder.path(), &board, words).output().unwrap();
        (output.status.code(), board.truth().steps != 0, String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(run(vec![], &["0.5mL"]).0, Some(0));
    let (code, moved, said) = run(vec![(100, 210.0)], &["0.5mL"]);
    assert_eq!((code, moved), (Some(2), false), "{said}");
    assert!(said.contains("$100 was 250 and is 210 now"), "{said}");
    assert_eq!(run(vec![(100, 210.0)], &["0.5mL", "--accept-settings"]).0, Some(0));
    assert_eq!(run(vec![(100, 210.0)], &["0.5mL"]).0, Some(0));
}

#[test]
fn a_resume_of_a_dose_that_the_board_has_finished_exits_with_0_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let output = command(folder.path(), &board, &["home", "--set", "0deg"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let journal = folder.path().join("state/three-roller/grbl/journal.jsonl");
    let steps = {
        let file = PumpFile::read(&pump_file(folder.path(), &board)).unwrap();
        let bench = Bench::new(file, None, &folder.path().join("state")).unwrap();
        let mut session = bench.session().unwrap();
        let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
        // A kill leaves the journal as it is late in the motion.
        let mut late = Vec::new();
        session
            .run(&prepared, |made| {
                if made < prepared.plan.steps().unsigned_abs() {
                    late = fs::read(&journal).unwrap();
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        fs::write(&journal, late).unwrap();
        prepared.plan.steps()
    };
    assert_eq!(board.rest().steps, steps);
    let output = command(folder.path(), &board, &["resume"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("the device has finished the dose"));
    assert_eq!(board.rest().steps, steps);
}

/// Runs `dose home --sensor --yes` on a board of its own. The journal may grow to `bytes`.
fn search(folder: &Path, bytes: Option<u64>) -> Output {
    let sensor = Some(Sensor { at: 4000, width: 128, every: 12_800 });
    let board = plug(Options { time_scale: 4.0, sensor, ..Options::default() });
    let pump = pump_file(folder, &board);
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

#[test]
fn a_plan_that_is_refused_tells_what_befell_the_rotor() {
    // The motor was stopped in a dose, and its board is switched off and on.
    let refused = |words: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let is_resume = words[0] == "resume";
        {
            let pressed = is_resume.then_some((500, b'!'));
            let board = plug(Options {
                defects: Defects { pressed, ..Defects::default() },
                patient: true,
                ..Options::default()
            });
            let homed = command(folder.path(), &board, &["home", "--set", "0deg"]).output().unwrap();
            assert_eq!(homed.status.code(), Some(0), "{homed:?}");
            let dosed = command(folder.path(), &board, &["2mL"]).output().unwrap();
            assert_eq!(dosed.status.code(), Some(i32::from(is_resume)), "{dosed:?}");
        }
        let board = plug(Options::default());
        let output = command(folder.path(), &board, words).output().unwrap();
        assert_eq!((output.status.code(), board.truth().steps), (Some(2), 0), "{words:?}: {output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        let notes = said.lines().filter(|line| line.starts_with("warning: the device was reset"));
        assert_eq!(notes.count(), 1, "{words:?}: {said}");
    };
    // One after the other: many processes and boards at a time starve each other.
    for words in [
        &["1mL", "--within", "0.01s"][..],
        &["1mL", "--within", "0.01s", "--format", "json"],
        &["1mL", "--within", "0.01s", "--repeat", "2"],
        &["resume", "--within", "0.01s"],
        &["calibrate", "verify", "--volume", "10mL", "--within", "0.01s"],
        &["calibrate", "run", "--speeds", "10000rpm"],
    ] {
        refused(words);
    }
}

#[test]
fn a_board_that_takes_seconds_to_answer_costs_a_batch_no_dose() {
    let folder = tempfile::tempdir().unwrap();
    // The board starts anew when its port is opened.
    let boot = Duration::from_millis(6_500);
    let board = plug(Options { resets_on_open: true, boot, ..Options::default() });
    let batch = ["0.2mL", "--repeat", "2", "--every", "5s"];
    let output = command(folder.path(), &board, &batch).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("dose 2 of 2") && !said.contains("skipped"), "{said}");
}

#[test]
fn a_dose_that_has_given_more_than_was_asked_stands_in_the_way() {
    let beyond = DoseError::BeyondRequest { requested_ml: 1.0, delivered_ml: 1.2 };
    assert_eq!(beyond.ending(), Ending::Unfinished);
}

#[test]
fn the_default_speeds_of_a_guided_calibration_keep_to_what_the_board_can_do() {
    for most_rpm in [30.0, 12.0] {
        let folder = tempfile::tempdir().unwrap();
        // A revolution of the pump head is 12,800 steps of 250 a unit.
        let settings = vec![(110, most_rpm * 12_800.0 / 250.0)];
        let board = plug(Options { settings, ..Options::default() });
        let words = ["calibrate", "run", "--dry-run"];
        let output = command(folder.path(), &board, &words).stdin(Stdio::null()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{most_rpm} r/min: {said}");
        assert!(said.contains("nothing moves"), "{said}");
        assert_eq!(board.truth().steps, 0);
        // A speed beyond the board's limit is refused by name.
        let fast = ["calibrate", "run", "--dry-run", "--speeds", "40rpm"];
        let output = command(folder.path(), &board, &fast).stdin(Stdio::null()).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            said.contains("40.000 r/min is above") && said.contains(&format!("{most_rpm:.2} r/min")),
            "{said}"
        );
    }
}

#[test]
fn control_characters_of_a_board_are_shown_and_not_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    let evil = "left\u{1b}[2J\u{7f}pump";
    let dose = |board: &Simulated| {
        let words = ["0.2mL"];
        command(folder.path(), board, &words).stdin(Stdio::null()).output().unwrap()
    };
    assert_eq!(dose(&plug(Options { text: evil, ..Options::default() })).status.code(), Some(0));
    let refused = dose(&plug(Options { text: "right pump", ..Options::default() }));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("right pump") && said.contains("[2J"), "{said}");
    assert!(!said.contains(|c: char| c.is_control() && c != '\n'), "{said:?}");
}
