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
        q if q.starts_with("Current of the motor at rest") => "0.3A",
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
    let pico = "step=gpio11,dir=gpio10,enable=!gpio12";
    let mut sockets =
        ["ramps:X", "skr-mini-e3-v2:8", "skr-mini-e3-v3:X", "skr-pico-v1:X", pico, "skr-mini-e3-v2:Y"]
            .into_iter();
    let ended =
        desk.answers(&["setup", "acid", "--no-motion"], &mut |question| says(question, &port, &mut sockets));
    assert_eq!(ended.code, 0, "{}", ended.err);
    for said in [
        "a Klipper board (stm32f103xe), firmware v0.12.0-simulated is at this port, so the driver is klipper",
        "skr-mini-e3-v2: the BIGTREETECH SKR Mini E3 V2.0, with the sockets X, Y, Z, E",
        "no board `ramps` is known; it is one of skr-mini-e3-v3, ",
        "the skr-mini-e3-v2 has no socket `8`; it has X, Y, Z, E",
        "the BIGTREETECH SKR Mini E3 V3.0 comes with stm32g0b1xx, and the board at this port has stm32f103xe",
        "the BIGTREETECH SKR Pico V1.0 comes with rp2040, and the board at this port has stm32f103xe",
        "the board (stm32f103xe) has no pin `gpio11`; its pins are PA0 to PA15, ",
        "socket skr-mini-e3-v2:Y, 0.5 A, 0.3 A at rest",
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
    assert_eq!(tmc.hold_a, Some(0.3));
    assert_eq!((tmc.address, tmc.run_a, tmc.uart.to_string().as_str()), (2, 0.5, "PC11"));
    // Another pump is told who has the socket, and a script is refused.
    let script = ["setup", "base", "--like", "acid", "--no-motion", "--yes", "--socket"];
    let taken = desk.types(&[&script[..], &["skr-mini-e3-v2:Y"]].concat());
    assert_eq!(taken.code, 2, "{}", taken.err);
    assert!(taken.err.contains("turns the pump `acid` already; choose another socket"), "{}", taken.err);
    let free = desk.types(&[&script[..], &["skr-mini-e3-v2:Z"]].concat());
    let first =
        "The first motion of `base` resets the board, so that it knows its pins: the motors of `acid`";
    let said = free.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(free.code == 0 && said.contains(first), "{}", free.err);
    let mut sockets = ["skr-mini-e3-v2:X"].into_iter();
    let ended =
        desk.answers(&["setup", "feed", "--no-motion"], &mut |question| says(question, &port, &mut sockets));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let said = "acid has the motor at skr-mini-e3-v2:Y (PB10) of this board";
    assert!(ended.err.contains(said), "{}", ended.err);
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

#[test]
fn what_the_board_cannot_have_is_refused_before_a_file_is_written() {
    let desk = Desk::new();
    let board = SimulatedKlipper::start_as(Character { drivers: 4, ..Character::default() }).unwrap();
    let port = board.path().display().to_string();
    let words =
        "setup acid --rollers 4 --ml-per-rev 0.5mL --yes --driver klipper --altitude 0m --no-motion --port";
    let words: Vec<_> = words.split_whitespace().chain([port.as_str()]).collect();
    for (rest, said) in [
        ("--microsteps 16", "say --socket skr-mini-e3-v2:X"),
        ("--microsteps 16 --socket skr-mini-e3-v2:X", "say --current 0.5A"),
        (
            "--microsteps 16 --socket skr-pico-v1:X --current 0.4A",
            "comes with rp2040, and the board at this port has",
        ),
        (
            "--microsteps 16 --axis Y --socket skr-mini-e3-v2:X --current 0.4A",
            "a Klipper board has no axes: the socket says which motor turns; leave --axis out",
        ),
        ("--microsteps 16 --socket step=PE9,dir=PB12", "has no pin `PE9`; its pins are PA0 to PA15, "),
        (
            "--microsteps 16 --socket step=PB13,dir=PB12 --current 0.4A",
            "the current is 0.4 A; allowed: no current, because the socket names no wire to a TMC2209",
        ),
        (
            "--microsteps 16 --socket skr-mini-e3-v2:X --current 1.9A",
            "the current is 1.9 A; allowed: 0.031 to 1.768 A (RMS) with [drive.klipper.tmc] sense_ohm of 0.11 Ohm",
        ),
        (
            "--microsteps 16 --socket skr-mini-e3-v2:X --current 0.4A --hold-current 0.6A",
            "the current at rest is 0.6 A; allowed: 0.031 A to that of the turning motor, 0.4 A",
        ),
        (
            "--microsteps 15 --socket skr-mini-e3-v2:X --current 0.4A",
            "15 microsteps of 200 full steps are none that a TMC2209 makes",
        ),
    ] {
        let rest: Vec<_> = rest.split_whitespace().collect();
        let ended = desk.types(&[&words[..], &rest].concat());
        assert!(ended.code == 2 && ended.err.contains(said), "{said}: {}", ended.err);
        assert_eq!(desk.configured("pumps/acid.toml"), None);
    }
    assert!(!board.truth().configured);
}

/// Answers of somebody who sees half a turn, whatever the pump makes.
fn sees_half(question: &str, causes: &mut dyn Iterator<Item = &'static str>) -> Option<String> {
    let answer = match question {
        q if q.starts_with("May the motor move") => "yes",
        q if q.starts_with("Did the line come back") => "1/2",
        q if q.starts_with("Cause") => return causes.next().map(str::to_owned),
        _ => "",
    };
    Some(answer.to_owned())
}

#[test]
fn a_turn_that_falls_short_never_changes_microsteps_that_the_board_sets() {
    let desk = Desk::new();
    let board = SimulatedKlipper::start_as(Character { drivers: 4, ..Character::default() }).unwrap();
    let port = board.path().display().to_string();
    let words = "setup acid --rollers 4 --ml-per-rev 0.5mL --driver klipper --microsteps 16 --altitude 0m --gear 1 \
                 --socket skr-mini-e3-v2:X --current 0.4A --hold-current 0.3A --full-steps 200 --rate 0.1mL/s";
    let words: Vec<_> = words.split_whitespace().chain(["--port", &port]).collect();
    let mut causes = ["200", "soon", "400"].into_iter();
    let ended = desk.answers(&words, &mut |question| sees_half(question, &mut causes));
    assert_ne!(ended.code, 0, "{}", ended.err);
    for said in [
        "It made 0.5 turns in place of 1, with 200 full steps, 16 microsteps and a gear of 1. The board sets the",
        "a motor of 400 full steps (0.9 deg) in place of 200, a gear of 2 in place of 1, or a motor that stalls",
        "the motor has 200 full steps already",
        "the second revolution was wrong too: 0.5 turns in place of 1, with 400 full steps, 16 microsteps",
        "`dose setup acid --gear 2`",
    ] {
        assert!(ended.err.replace("\n  ", " ").contains(said), "{said}: {}", ended.err);
    }
    assert_eq!(causes.next(), None);
    // A revolution with 200 full steps, and one with 400, each of 16 microsteps.
    let truth = board.truth();
    assert_eq!((truth.steps, truth.shutdown), ([3200 + 6400, 0, 0, 0], None));
    assert_eq!(truth.drivers[0][2] >> 17, 0x0402_0000 >> 17);
    // The person who looks at the gearbox goes on with it.
    let file = PumpFile::parse(&desk.configured("pumps/acid.toml").unwrap(), "of setup").unwrap();
    assert_eq!((file.motor.steps_per_rev, file.motor.full_steps_per_rev), (6400, 400));
    // Nobody is asked: the cause is not guessed.
    let script = ["setup", "acid", "--yes", "--turned", "1/2", "--direction", "forward"];
    let ended = desk.types(&script);
    assert!(
        ended.code != 0 && ended.err.contains("say --full-steps 400, --gear 2 or --current"),
        "{}",
        ended.err
    );
}
