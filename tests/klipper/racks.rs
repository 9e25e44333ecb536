//! Racks with Klipper boards: one pump at each, and never two at one.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

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

#[test]
fn two_boards_pour_side_by_side() {
    let (rig, other) = (Rig::new(Character::default()), Rig::new(Character::default()));
    let (code, said) = runs(&rig, rig.board.path(), other.board.path());
    assert_eq!(code, Some(0), "{said}");
    let (red, blue) = (rig.board.truth().steps, other.board.truth().steps);
    assert!(red[0] > 500 && blue[1].abs_diff(red[0]) < 20, "{red:?} {blue:?}");
}
