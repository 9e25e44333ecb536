//! A printer board with the Klipper firmware: it is found, and its socket and the motor's current are asked for.

use pump_bench::drives::{StopRequest, find_boards};
use pump_bench::pump_file::{DriverName, PumpFile};

use crate::person::Desk;
use crate::simulated_klipper::{Character, SimulatedKlipper};

/// Answers to the questions before that for the socket, and after it.
fn says(question: &str, port: &str, sockets: &mut dyn Iterator<Item = &'static str>) -> Option<String> {
    let answer = match question {
        q if q.starts_with("Head:") => "0.5mL",
        q if q.starts_with("Rollers") => "4",
        q if q.starts_with("Microsteps") => "16",
        // The board says that it is none.
        q if q.starts_with("Driver") => "grbl",
        q if q.starts_with("Port") => port,
        q if q.starts_with("Board and socket") => return sockets.next().map(str::to_owned),
        q if q.starts_with("Current") => "0.5A",
        q if q.starts_with("Altitude") => "500m",
        _ => "",
    };
    Some(answer.to_owned())
}

#[test]
fn a_klipper_board_is_found_and_its_socket_is_asked_for() {
    let desk = Desk::new();
    let board = SimulatedKlipper::start_as(Character { drivers: 4, ..Character::default() }).unwrap();
    let port = board.path().display().to_string();
    let mut sockets = ["ramps:X", "skr-mini-e3-v2:8", "skr-mini-e3-v2:Y"].into_iter();
    let ended =
        desk.answers(&["setup", "acid", "--no-motion"], &mut |question| says(question, &port, &mut sockets));
    assert_eq!(ended.code, 0, "{}", ended.err);
    for said in [
        "a Klipper board (stm32f103xe), firmware v0.12.0-simulated is at this port, so the driver is klipper",
        "skr-mini-e3-v2: the BIGTREETECH SKR Mini E3 V2.0, with the sockets X, Y, Z, E",
        "no board `ramps` is known; it is one of skr-mini-e3-v3, ",
        "the skr-mini-e3-v2 has no socket `8`; it has X, Y, Z, E",
        "socket skr-mini-e3-v2:Y, 0.5 A",
    ] {
        assert!(ended.err.contains(said), "{said}: {}", ended.err);
    }
    // The other boards have other microcontrollers.
    assert!(!ended.err.contains("SKR Mini E3 V3.0, with"), "{}", ended.err);
    let file = PumpFile::parse(&desk.configured("pumps/acid.toml").unwrap(), "of setup").unwrap();
    let drive = file.drive.unwrap();
    let pins = drive.klipper.unwrap();
    let tmc = pins.tmc.unwrap();
    assert_eq!((drive.driver, pins.step.to_string().as_str()), (DriverName::Klipper, "PB10"));
    assert_eq!((tmc.address, tmc.run_a, tmc.uart.to_string().as_str()), (2, 0.5, "PC11"));
    // Another pump is told who has the socket, and a script is refused.
    let script = ["setup", "base", "--like", "acid", "--no-motion", "--yes", "--socket"];
    let taken = desk.types(&[&script[..], &["skr-mini-e3-v2:Y"]].concat());
    assert_eq!(taken.code, 2, "{}", taken.err);
    assert!(taken.err.contains("turns the pump `acid` already; choose another socket"), "{}", taken.err);
    let free = desk.types(&[&script[..], &["skr-mini-e3-v2:Z"]].concat());
    assert_eq!(free.code, 0, "{}", free.err);
    let truth = board.truth();
    assert_eq!((truth.steps, truth.configured, truth.shutdown), ([0; 4], false, None));
}

#[test]
fn a_relative_of_the_firmware_is_named() {
    let board = SimulatedKlipper::start_as(Character { app: "Kalico", ..Character::default() }).unwrap();
    let found = find_boards(&[board.path().to_owned()], &StopRequest::new(|| false));
    let said = found[0].1.as_ref().unwrap_err().to_string();
    let source = std::error::Error::source(found[0].1.as_ref().unwrap_err()).map(ToString::to_string);
    let said = format!("{said} {}", source.unwrap_or_default());
    assert!(said.contains("runs the firmware \"Kalico\", and this driver needs Klipper's"), "{said}");
}

#[test]
fn a_first_run_turns_the_motor_at_its_socket_alone() {
    let desk = Desk::new();
    let board = SimulatedKlipper::start_as(Character { drivers: 4, ..Character::default() }).unwrap();
    let port = board.path().display().to_string();
    let words = "setup acid --rollers 4 --ml-per-rev 0.5mL --yes --driver klipper --microsteps 16 --altitude 0m \
                 --socket skr-mini-e3-v2:E --current 0.4A --turned 1 --direction forward --prime 0 --volume 0.5mL";
    let words: Vec<_> = words.split_whitespace().chain(["--port", &port]).collect();
    let ended = desk.types(&words);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let truth = board.truth();
    // A revolution, and a dose of another one.
    assert_eq!((truth.steps, truth.stray, truth.shutdown), ([0, 0, 0, 6400], 0, None));
    // CHOPCONF of E: 16 microsteps without interpolation, on the sensitive scale.
    assert_eq!(truth.drivers[3][2] >> 17, 0x0402_0000 >> 17);
}
