//! Racks with Klipper boards: one pump at each, and never two at one. They begin together.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::rig::{Rig, ended};
use crate::simulated_klipper::Character;

/// Rack of two pumps that begin together.
const RACK: &str = "schema = \"rack/1\"\n[pumps]\nred = \"red.toml\"\nblue = \"blue.toml\"\n\
                    [[step]]\nratio = { red = 1, blue = 1 }\nvolume = \"2mL\"\nrate = \"2mL/s\"\n";

/// Runs the rack with a pump at each of these ports, the second at other pins. Returns the exit code and what was said.
fn runs(rig: &Rig, red: &Path, blue: &Path) -> (Option<i32>, String) {
    let folder = rig.folder.path();
    let text = fs::read_to_string(rig.pump()).unwrap();
    let at = |port: &Path| {
        text.replace("driver = \"klipper\"", &format!("driver = \"klipper\"\nport = \"{}\"", port.display()))
    };
    let blue = at(blue).replace("id = \"red\"", "id = \"blue\"").replace("PB13", "PB10");
    fs::write(folder.join("red.toml"), at(red)).unwrap();
    fs::write(folder.join("blue.toml"), blue.replace("PB12", "PB2").replace("PB14", "PB11")).unwrap();
    fs::write(folder.join("rack.toml"), RACK).unwrap();
    runs_rack(rig)
}

/// Runs the rack as its files are. Returns the exit code and what was said.
fn runs_rack(rig: &Rig) -> (Option<i32>, String) {
    let folder = rig.folder.path();
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    for name in ["DOSE_PUMP", "DOSE_CONFIG"] {
        command.env_remove(name);
    }
    command.env("XDG_CONFIG_HOME", folder).env("DOSE_STATE_DIR", folder.join("state")).current_dir(folder);
    command.args(["run", "rack.toml", "--confirm-pump"]);
    ended(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
}

#[test]
fn two_pumps_at_one_board_are_refused_and_nothing_moves() {
    let rig = Rig::new(Character::default());
    let (code, said) = runs(&rig, rig.board.path(), rig.board.path());
    assert!(code != Some(0), "{said}");
    assert!(said.contains("a board with the Klipper firmware turns one pump at a time"), "{said}");
    assert_eq!(rig.board.truth().steps, [0; 4]);
}

/// Returns the instant of the first step that the board of a rig has made at a socket.
fn first_step(rig: &Rig, socket: &str) -> Instant {
    rig.board.instant_of(rig.steps_of(socket)[0].0).unwrap()
}

/// Runs the rack with boards whose ports have this rate, 0 for USB, and whose clocks drift. Returns the time between
/// the begins.
fn spread(baud: u32) -> Duration {
    let fast = Character { baud, drift_ppm: 100.0, first_tick: 4_000_000_000, ..Character::default() };
    let slow = Character { baud, drift_ppm: -80.0, ..Character::default() };
    let (rig, other) = (Rig::new(fast), Rig::new(slow));
    let (code, said) = runs(&rig, rig.board.path(), other.board.path());
    assert_eq!(code, Some(0), "{said}");
    let (red, blue) = (rig.board.truth().steps, other.board.truth().steps);
    assert!(red[0] > 500 && blue[1].abs_diff(red[0]) < 20, "{red:?} {blue:?}");
    let begins = [first_step(&rig, "X"), first_step(&other, "Y")];
    begins[0].max(begins[1]) - begins[0].min(begins[1])
}

#[test]
fn two_boards_at_usb_ports_begin_within_50_us_and_pour_side_by_side() {
    let spread = spread(0);
    assert!(spread < Duration::from_micros(50), "{spread:?}");
}

#[test]
fn two_boards_at_uarts_begin_within_the_time_that_a_question_takes() {
    let spread = spread(250_000);
    assert!(spread < Duration::from_micros(800), "{spread:?}");
}

#[test]
fn two_pumps_at_one_step_pin_are_refused_with_its_name() {
    let rig = Rig::new(Character::default());
    let (_, said) = runs(&rig, rig.board.path(), rig.board.path());
    assert!(!said.contains("step pin"), "{said}");
    let blue = rig.folder.path().join("blue.toml");
    let text = fs::read_to_string(&blue).unwrap().replace("PB10", "PB13");
    fs::write(&blue, text).unwrap();
    let (code, said) = runs_rack(&rig);
    assert!(code != Some(0) && said.contains("both at the step pin PB13, and"), "{said}");
    assert!(said.contains("red") && said.contains("blue"), "{said}");
    assert_eq!(rig.board.truth().steps, [0; 4]);
}
