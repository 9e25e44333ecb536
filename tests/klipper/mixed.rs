//! Racks with boards of both kinds, and with several nodes. They begin together.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use pump_bench::built_in;
use pump_bench::pump_file::{DriveTable, DriverName};

use crate::racks::{RACK, runs_rack};
use crate::rig::Rig;
use crate::simulated_klipper;
use crate::simulated_node::{Character, SimulatedNode};

/// Most by which boards at USB ports begin apart.
const APART: Duration = Duration::from_micros(50);

/// Number of racks of which one begins so: a busy computer holds the answers of a board back.
const RACKS: usize = 4;

/// Switches a node at a USB port on.
fn node(number: u64) -> SimulatedNode {
    SimulatedNode::start_as(Character { number, usb: true, ..Character::default() }).unwrap()
}

/// Writes the pump file of the published pump at the axis X of a node.
fn write_node(folder: &Path, id: &str, port: &Path) {
    let mut file = built_in("three-roller").unwrap();
    file.pump.id = id.to_owned();
    file.drive = Some(DriveTable::of(DriverName::Node).with_port(port));
    fs::write(folder.join(format!("{id}.toml")), file.to_toml()).unwrap();
}

/// Runs a rack on new boards until it begins as it should. `spread` returns the time between two begins.
fn begins_together(spread: impl Fn() -> Duration) {
    let spreads: Vec<_> =
        std::iter::repeat_with(spread).take(RACKS).take_while(|spread| *spread >= APART).collect();
    assert!(spreads.len() < RACKS, "{spreads:?}");
}

/// Returns the time between two instants, whichever is the first.
fn between(one: Instant, other: Instant) -> Duration {
    one.max(other) - one.min(other)
}

#[test]
fn a_node_and_a_klipper_board_begin_within_50_us_and_pour_side_by_side() {
    begins_together(|| {
        let at_usb = simulated_klipper::Character { baud: 0, drift_ppm: 90.0, ..Default::default() };
        let (rig, node) = (Rig::new(at_usb), node(3));
        let folder = rig.folder.path();
        let text = fs::read_to_string(rig.pump()).unwrap();
        let port = format!("driver = \"klipper\"\nport = \"{}\"", rig.board.path().display());
        fs::write(folder.join("red.toml"), text.replace("driver = \"klipper\"", &port)).unwrap();
        write_node(folder, "blue", node.path());
        fs::write(folder.join("rack.toml"), RACK).unwrap();
        let (code, said) = runs_rack(&rig);
        assert_eq!(code, Some(0), "{said}");
        let (red, blue) = (rig.board.truth().steps[0], node.truth().steps[0]);
        assert!(red > 500 && blue.abs_diff(red) < 20, "{red} {blue}");
        let first = rig.board.instant_of(rig.steps_of("X")[0].0).unwrap();
        between(first, node.truth().first_steps[0].unwrap())
    });
}

#[test]
fn two_nodes_begin_within_50_us_and_none_begins_without_the_other() {
    begins_together(|| {
        let rig = Rig::new(simulated_klipper::Character::default());
        let folder = rig.folder.path();
        let (one, other) = (node(3), node(4));
        write_node(folder, "red", one.path());
        write_node(folder, "blue", other.path());
        fs::write(folder.join("rack.toml"), RACK).unwrap();
        let (code, said) = runs_rack(&rig);
        assert_eq!(code, Some(0), "{said}");
        let first = |board: &SimulatedNode| board.truth().first_steps[0].unwrap();
        let spread = between(first(&one), first(&other));
        let before = one.truth().steps;
        other.touch("estop").unwrap();
        let (code, said) = runs_rack(&rig);
        assert!(code != Some(0) && said.contains("emergency stop"), "{code:?}: {said}");
        assert_eq!(one.truth().steps, before, "{said}");
        spread
    });
}
