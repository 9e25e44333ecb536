//! Claims about nodes that are told apart, by their numbers and by the names that their ports keep.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::PathBuf;

use pump_bench::built_in;
use pump_bench::drives::{Disturbance, Drive, DriveError, Node, NodeError, Opening};
use pump_bench::notice::Remedy;
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::report::Explain;

use crate::rig::{Rig, node_error};
use crate::world::SharedWorld;

/// Computer at which boards are plugged in.
struct Computer {
    rig: Rig,
    folder: tempfile::TempDir,
}

impl Computer {
    /// Makes a computer with a board of this number at ttyACM0.
    fn new(number: u64, name: &str) -> Self {
        let computer = Self { rig: Rig::new(), folder: tempfile::tempdir().unwrap() };
        File::create(computer.device()).unwrap();
        computer.plugged(number, name)
    }

    fn device(&self) -> PathBuf {
        self.folder.path().join("ttyACM0")
    }

    /// Puts another board at the port.
    fn plugged(mut self, number: u64, name: &str) -> Self {
        self.rig.world = SharedWorld::of_board(number);
        let names = self.folder.path().join("by-id");
        let _ = fs::remove_dir_all(&names);
        fs::create_dir(&names).unwrap();
        symlink(self.device(), names.join(name)).unwrap();
        self
    }

    fn opening(&self, accept_settings: bool) -> Opening {
        let port_names = Some(self.folder.path().join("by-id"));
        Opening { port_names, accept_settings, ..self.rig.opening() }
    }

    fn open(&self, accept_settings: bool) -> Result<Node, DriveError> {
        let table = DriveTable::of(DriverName::Node).with_port(self.device());
        self.rig.open_by(&table, &self.opening(accept_settings))
    }
}

#[test]
fn a_board_is_known_by_its_number_whatever_its_port_is_called() {
    let computer = Computer::new(0xe660_5838_8372_b0a2, "usb-FTDI_FT232R_A5069RR4-if00-port0");
    drop(computer.open(false).unwrap());
    let computer = computer.plugged(0xe660_5838_8372_b0a2, "usb-pump-dose_node_e66058388372b0a2-if00");
    let mut drive = computer.open(false).unwrap();
    assert_eq!(drive.disturbed(), Some(Disturbance::Reset), "it was switched off meanwhile");
    drop(drive);
    let computer = computer.plugged(0xe660_5838_834c_17af, "usb-pump-dose_node_e66058388372b0a2-if00");
    let refused = computer.open(false).unwrap_err();
    assert_eq!(refused.remedies(), [Remedy::AcceptBoard]);
    let said = node_error(&refused).to_string();
    assert!(said.contains("number e6605838834c17af"), "{said}");
    assert!(said.contains("number e66058388372b0a2 (usb-pump-dose_node_e66058388372b0a2-if00)"), "{said}");
    let facts = refused.facts();
    assert_eq!(
        facts.value.as_deref(),
        Some("number e6605838834c17af (usb-pump-dose_node_e66058388372b0a2-if00)")
    );
    assert!(facts.allowed.unwrap().starts_with("number e66058388372b0a2"));
    assert!(computer.rig.world.rises().is_empty());
    let mut accepted = computer.open(true).unwrap();
    assert!(accepted.notes().iter().any(|note| note.text().contains("number e66058388372b0a2")));
    drop(accepted);
    drop(computer.open(false).unwrap());
}

#[test]
fn boards_without_numbers_are_told_apart_by_the_names_of_their_ports() {
    let computer = Computer::new(0, "usb-left");
    drop(computer.open(false).unwrap());
    drop(computer.open(false).unwrap());
    let computer = computer.plugged(0, "usb-right");
    let refused = computer.open(false).unwrap_err();
    let said = node_error(&refused).to_string();
    assert!(said.contains("is usb-right, and the record of the pump is of usb-left"), "{said}");
    drop(computer.open(true).unwrap());
}

#[test]
fn a_board_that_gains_a_number_is_known_and_one_that_loses_it_is_not() {
    // New firmware, or a flash chip that is not asked well.
    let computer = Computer::new(0, "usb-left");
    drop(computer.open(false).unwrap());
    let computer = computer.plugged(7, "usb-left");
    drop(computer.open(false).unwrap());
    let computer = computer.plugged(0, "usb-left");
    let refused = computer.open(false).unwrap_err();
    assert!(matches!(node_error(&refused), NodeError::OtherBoard { .. }), "{refused}");
}

#[test]
fn an_axis_that_turns_another_pump_by_its_record_is_refused_until_it_is_accepted() {
    let (world, folder) = (SharedWorld::of_board(7), tempfile::tempdir().unwrap());
    let open = |pump: &str, axis: Axis, accept_settings: bool| {
        let opening = Opening { accept_settings, ..Opening::of_pump(pump, DriverName::Node, folder.path()) };
        fs::create_dir_all(opening.settings_record.as_ref().unwrap().parent().unwrap()).unwrap();
        let motor = built_in("three-roller").unwrap().motor;
        Node::over(Box::new(world.clone()), &Rig::table().with_axis(axis), &motor, &opening)
    };
    drop(open("acid", Axis::X, false).unwrap());
    drop(open("base", Axis::Y, false).unwrap());
    let refused = open("other", Axis::X, false).unwrap_err();
    let said = node_error(&refused).to_string();
    assert!(
        said.contains("belongs to pump `acid` by the record; name another one in the file of pump `other`"),
        "{said}"
    );
    assert_eq!(refused.remedies(), [Remedy::TakePlace]);
    assert_eq!(refused.facts().value.as_deref(), Some("axis X"));
    let notes = open("other", Axis::X, true).unwrap().notes();
    assert!(
        notes.iter().any(|note| note.text().contains("turned pump `acid` by the record; it turns this pump")),
        "{notes:?}"
    );
    // The pump that made place is refused in its turn, and the others are not.
    drop(open("other", Axis::X, false).unwrap());
    drop(open("base", Axis::Y, false).unwrap());
    let refused = open("acid", Axis::X, false).unwrap_err();
    assert!(node_error(&refused).to_string().contains("belongs to pump `other`"), "{refused}");
    drop(open("acid", Axis::Z, false).unwrap());
    assert!(world.rises().is_empty());
}
