//! Ports that are found by asking them.

mod klipper;
mod moved;

use std::fs;
use std::os::unix::fs::symlink;
use std::thread;

use pump_bench::drives::{
    DriveError, FoundBoard, Grbl, Opening, StopRequest, ask_ports, find_board, find_boards, serial_ports,
};
use pump_bench::pump_file::{DriveTable, DriverName};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::course::sees;
use crate::person::{ACID, Desk};
use crate::simulated::Simulated;
use crate::simulated::options::{Defects, Options};
use crate::simulated_node::SimulatedNode;
use crate::truth::TruePump;

/// Words for a port at which no board answers.
const NEITHER: &str =
    "neither a node (460800 baud), a grbl board (115200 baud) nor a Klipper board (250000 baud)";

#[test]
fn each_port_is_asked_and_nothing_moves() {
    let board = Simulated::start(Options::default()).unwrap();
    let held = Simulated::start(Options::default()).unwrap();
    let dev = tempfile::tempdir().unwrap();
    fs::create_dir_all(dev.path().join("serial/by-id")).unwrap();
    symlink(board.path(), dev.path().join("ttyUSB0")).unwrap();
    symlink(board.path(), dev.path().join("serial/by-id/usb-arduino")).unwrap();
    symlink(held.path(), dev.path().join("ttyACM3")).unwrap();
    symlink("/dev/null", dev.path().join("ttyUSB7")).unwrap();
    fs::write(dev.path().join("sda"), "").unwrap();
    let ports = serial_ports(dev.path());
    // A board has one name, and it is the one that stays.
    let names: Vec<_> = ports.iter().map(|port| port.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["usb-arduino", "ttyACM3", "ttyUSB7"]);
    let table = DriveTable::of(DriverName::Grbl).with_port(held.path());
    let motor = pump_bench::built_in("three-roller").unwrap().motor;
    let holding = Grbl::open(&table, &motor, &Opening::default()).unwrap();
    let answers = ask_ports(&ports, &StopRequest::new(|| false));
    assert_eq!(answers[0].1.as_ref().unwrap(), "Idle");
    assert!(matches!(answers[1].1, Err(DriveError::Busy { .. })), "{:?}", answers[1]);
    assert!(answers[2].1.is_err());
    drop(holding);
    for board in [board, held] {
        let truth = board.rest();
        assert_eq!((truth.steps, truth.starts), (0, 0));
    }
}

#[test]
fn grbl_boards_and_nodes_are_told_apart_and_named() {
    let (grbl, node) =
        (Simulated::start(Options::default()).unwrap(), SimulatedNode::start(0x5ec0d).unwrap());
    let ports = [grbl.path(), node.path(), std::path::Path::new("/dev/null")].map(std::path::Path::to_owned);
    let found = find_boards(&ports, &StopRequest::new(|| false));
    let said: Vec<_> = found.iter().map(|(_, board)| board.as_ref().map(FoundBoard::to_string)).collect();
    assert_eq!(said[0].as_ref().unwrap(), "a grbl board, Idle, axes X, Y, Z");
    assert_eq!(said[1].as_ref().unwrap(), "a node 000000000005ec0d, firmware 0.1.0, axes X, Y, Z, A");
    assert!(said[2].is_err());
    assert_eq!(found[1].1.as_ref().unwrap().driver(), DriverName::Node);
    assert_eq!((grbl.rest().starts, node.truth().steps), (0, [0; 4]));
    // Whichever driver is named, the board that is there is found.
    thread::scope(|scope| {
        for (port, board) in &found[..2] {
            scope.spawn(move || {
                for named in [Some(DriverName::Klipper), Some(DriverName::Node)] {
                    let answer = find_board(port, named, &StopRequest::new(|| false));
                    assert_eq!(answer.as_ref().unwrap(), board.as_ref().unwrap(), "{named:?}");
                }
            });
        }
    });
    assert_eq!((grbl.rest().steps, node.truth().steps), (0, [0; 4]));
}

/// Answer of a node whose firmware speaks version 9 of the protocol: a frame as this version makes it.
const VERSION_9: [u8; 27] =
    [0, 20, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 5, 5, 160, 212, 135, 0];

#[test]
fn a_node_of_another_version_is_named_whichever_driver_asks() {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let port = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    // The other end stays open, so that hosts may come and go.
    let kept = fs::File::options().read(true).write(true).open(&port).unwrap();
    let mut modes = tcgetattr(&kept).unwrap();
    modes.make_raw();
    tcsetattr(&kept, OptionalActions::Now, &modes).unwrap();
    // It ends with the test's process.
    thread::spawn(move || {
        let mut bytes = [0; 512];
        while let Ok(count @ 1..) = rustix::io::read(&master, &mut bytes) {
            // A frame of a node ends with a zero, and grbl's lines have none.
            if bytes[..count].contains(&0) {
                rustix::io::write(&master, &VERSION_9).unwrap();
            }
        }
    });
    let desk = Desk::new();
    for driver in ["grbl", "node"] {
        let refused = desk.types(&["1mL", "--driver", driver, "--port", &port, "--confirm-pump"]);
        let said = format!(
            "the firmware of the board at {port} speaks version 9 of the protocol, and this program speaks "
        );
        assert!(refused.code == 2 && refused.err.contains(&said), "{driver}: {}", refused.err);
    }
    drop(kept);
}

#[test]
fn a_port_without_a_board_is_asked_for_again_at_once() {
    let desk = Desk::new();
    let mut pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let silent = Options { defects: Defects { silent: Some(0), ..Defects::default() }, ..Options::default() };
    let silent = Simulated::start(silent).unwrap();
    fs::write(desk.path("notes.txt"), "no device").unwrap();
    let wrong = [
        "/dev/null".to_owned(),
        desk.path("notes.txt").display().to_string(),
        silent.path().display().to_string(),
        "/dev/ttyUSB99".to_owned(),
    ];
    let mut ports = wrong.iter().cloned().chain([pump.port()]);
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| match question {
        q if q.starts_with("Port") => ports.next(),
        q => Some(sees(&mut pump, q, "16")),
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    for port in &wrong[..3] {
        assert!(ended.err.contains(&format!("no board answers at {port}: ")), "{port}: {}", ended.err);
    }
    let neither = format!("{NEITHER} answers at {}; ", wrong[2]);
    assert!(ended.err.contains(&neither), "{}", ended.err);
    for port in &wrong[..2] {
        assert!(
            ended.err.contains(&format!("{port} cannot be opened as a serial port: it is no serial line; "))
        );
    }
    assert!(ended.err.contains("no board is at /dev/ttyUSB99: it is not there; "), "{}", ended.err);
    assert_eq!(ended.asked.iter().filter(|question| question.starts_with("Port")).count(), 5);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains(&pump.port()));
    assert_eq!(pump.board.rest().steps, 0);
}

#[test]
fn a_board_that_went_away_is_asked_for_in_the_same_run() {
    let desk = Desk::new();
    let mut pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let words = ["setup", "acid", "--driver", "grbl", "--port", "/dev/null", "--axis", "X"];
    let ended = desk.answers(&words, &mut |question| match question {
        q if q.starts_with("Driver") => None,
        q => Some(sees(&mut pump, q, "16")),
    });
    assert_eq!(ended.code, 0, "{}{}", ended.out, ended.err);
    assert_eq!(ended.asked.iter().filter(|question| question.starts_with("Port")).count(), 1);
    assert!(ended.err.contains("the board answers, and its settings fit the pump"), "{}", ended.err);
    // A script is told, and moves nothing.
    let script = ["setup", "base", "--like", "acid", "--port", "/dev/null", "--axis", "Y", "--yes"];
    let refused = desk.types(&[&script[..], &["--turned", "1", "--direction", "forward"]].concat());
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("/dev/null cannot be opened as a serial port"), "{}", refused.err);
    assert_eq!(desk.configured("pumps/base.toml"), None);
}

#[test]
fn a_script_hears_why_no_board_is_at_its_port_before_anything_is_written() {
    let silent = Options { defects: Defects { silent: Some(0), ..Defects::default() }, ..Options::default() };
    let silent = Simulated::start(silent).unwrap();
    let words =
        [&ACID[..], &["--microsteps", "16", "--driver", "grbl", "--altitude", "0m", "--port"]].concat();
    for (port, why) in [
        (silent.path().to_str().unwrap(), NEITHER),
        ("/dev/null", "it is no serial line; "),
        ("/dev/ttyUSB99", "it is not there; "),
    ] {
        for axis in [&["--axis", "Z"][..], &[]] {
            let desk = Desk::new();
            let refused = desk.types(&[&words[..], &[port], axis].concat());
            assert!(refused.code == 2 && refused.err.contains(why), "{port}: {}", refused.err);
            assert!(!refused.err.contains("--turned 1"), "{port}: {}", refused.err);
            let written = [desk.configured("pumps/acid.toml"), desk.configured("config.toml")];
            assert_eq!(written, [None, None], "{port}");
        }
        // A board may come later. The warning comes once, whatever the driver.
        for (driver, axis) in [("grbl", &["--axis", "Z"][..]), ("grbl", &[]), ("node", &[])] {
            let desk = Desk::new();
            let words = words.iter().map(|word| if *word == "grbl" { driver } else { word });
            let words: Vec<_> =
                words.chain([port]).chain(axis.iter().copied()).chain(["--no-motion"]).collect();
            let alone = desk.types(&words);
            assert!(alone.code == 0 && desk.configured("pumps/acid.toml").is_some(), "{port}: {}", alone.err);
            let is_told = alone.err.contains("the pump file names this port all the same");
            assert!(is_told && alone.err.matches("no board answers at").count() == 1, "{}", alone.err);
        }
    }
}

#[test]
fn a_port_that_is_none_is_named_with_what_is_wrong_and_what_to_do() {
    let desk = Desk::new();
    for driver in ["grbl", "node"] {
        for (port, said) in [("/dev/null", "it is no serial line; "), ("/dev/ttyUSB99", "it is not there; ")]
        {
            let refused = desk.types(&["1mL", "--driver", driver, "--port", port, "--confirm-pump"]);
            let named = format!("{port} cannot be opened as a serial port: {said}");
            assert!(refused.code == 2 && refused.err.contains(&named), "{driver}: {}", refused.err);
            assert!(refused.err.contains("`dose setup` finds the boards that answer"), "{}", refused.err);
        }
    }
}

#[test]
fn a_typed_port_without_a_board_is_asked_for_before_the_axis_and_the_file() {
    let desk = Desk::new();
    let mut pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let words = ["setup", "acid", "--no-motion", "--driver", "grbl", "--port", "/dev/null"];
    let ended = desk.answers(&words, &mut |question| Some(sees(&mut pump, question, "16")));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let at = |start: &str| ended.asked.iter().position(|question| question.starts_with(start));
    assert!(at("Port").is_some() && at("Port") < at("Axis"), "{:?}", ended.asked);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains(&pump.port()));
}
