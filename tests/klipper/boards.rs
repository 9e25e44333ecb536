//! Boards and pump files that are refused, each with one message. Nothing moves.

use pump_bench::drives::Drive;
use pump_bench::pump_file::{DriveTable, DriverName};

use crate::rig::{Rig, command, dose, ended, run, said, socket, with_driver};
use crate::simulated_klipper::Character;

fn board(character: Character) -> Rig {
    Rig::new(character)
}

#[test]
fn boards_that_cannot_be_used_are_refused_with_one_message() {
    let lacks = |name: &str| Character { lacks: Some(name.to_owned()), ..Character::default() };
    for (character, words) in [
        (Character { app: "Marlin", ..Character::default() }, "runs the firmware \"Marlin\""),
        (lacks("queue_step"), "lacks the command `queue_step oid=%c interval=%u count=%hu add=%hi`"),
        (lacks("trsync_start"), "lacks the command `trsync_start"),
    ] {
        let rig = board(character);
        let said = rig.refusal(&rig.table());
        assert!(said.contains(words), "{said}");
        assert_eq!((rig.board.truth().steps, rig.board.truth().configured), ([0; 4], false));
    }
}

#[test]
fn pins_that_are_absent_in_use_or_not_named_are_refused() {
    let rig = board(Character::default());
    for (step, words) in [
        ("PE9", "has no pin `PE9`; its pins are PA0 to PA15, "),
        ("PA9", "the board's firmware uses the pin `PA9` as serial"),
    ] {
        let mut pins = socket("X");
        pins.step = step.parse().unwrap();
        let said = rig.refusal(&rig.table().with_klipper(pins));
        assert!(said.contains(words), "{said}");
    }
    let without = DriveTable::of(DriverName::Klipper).with_port(rig.board.path());
    let said = rig.refusal(&without);
    assert!(said.contains("no pins of the board are named for this pump"), "{said}");
    assert!(!rig.board.truth().configured);
}

#[test]
fn a_port_that_is_missing_in_use_or_of_another_pump_is_refused() {
    let rig = board(Character::default());
    let said = rig.refusal(&rig.table().with_port("/dev/ttyNONE0"));
    assert!(said.contains("/dev/ttyNONE0 cannot be opened as a serial port"), "{said}");
    let drive = rig.open();
    let said = rig.refusal(&rig.table().with_klipper(socket("Y")));
    assert!(said.contains("is configured without the pins of this one"), "{said}");
    drop(drive);
    rig.open_by(&rig.table().with_klipper(socket("Y"))).unwrap();
}

#[test]
fn a_board_of_another_program_is_refused_unless_a_person_accepts_it() {
    let rig = board(Character::default());
    drop(rig.open());
    // Nothing on record tells that the configuration is this bench's.
    std::fs::remove_dir_all(rig.folder.path().join("pump")).unwrap();
    let words = rig.refusal(&rig.table());
    assert!(words.contains("another program may use it"), "{words}");
    let mut opening = rig.opening();
    opening.accept_settings = true;
    let mut drive = pump_bench::drives::Klipper::open(&rig.table(), &crate::rig::motor(), &opening).unwrap();
    let plan = dose(0.5, 2.0, false);
    run(&mut drive, &plan).unwrap();
    assert_eq!(rig.board.truth().steps[0], plan.steps());
}

#[test]
fn a_board_with_the_configuration_of_other_pins_of_this_pump_is_configured_anew() {
    let rig = board(Character::default());
    let (plan, mut drive) = (dose(0.5, 2.0, false), rig.open());
    run(&mut drive, &plan).unwrap();
    drop(drive);
    let mut drive = rig.open_by(&rig.table().with_klipper(socket("Y"))).unwrap();
    assert_eq!(drive.count(), Some(0));
    run(&mut drive, &plan).unwrap();
    assert_eq!(rig.board.truth().steps, [plan.steps(), plan.steps(), 0, 0]);
}

#[test]
fn a_queue_that_is_too_small_and_a_motor_that_is_too_fast_are_refused_before_they_move() {
    let rig = board(Character { slots: 24, ..Character::default() });
    let mut drive = rig.open();
    let words = said(&drive.check(&dose(6.0, 8.0, true)).unwrap_err());
    assert!(words.contains("commands within 0.3 s, and the board's queue of 24 has room for 8"), "{words}");
    assert_eq!(rig.board.truth().steps[0], 0);
}

#[test]
fn a_socket_or_a_driver_turns_one_pump_on_record_until_a_person_says_otherwise() {
    let rig = Rig::of(Character { drivers: 4, ..Character::default() }, with_driver("X", 0));
    let runs = |id: &str, pins, words: &[&str]| {
        let pump = rig.pump_at(id, pins);
        ended(command(rig.folder.path(), &pump, rig.board.path(), words).spawn().unwrap())
    };
    let dose = ["1mL", "--confirm-pump", "--start-angle", "0deg"];
    let (code, said) = runs("red", with_driver("X", 0), &dose);
    assert_eq!(code, Some(0), "{said}");
    let made = rig.board.truth().steps;
    for (pins, words) in [
        (with_driver("X", 0), "the pin PB13 of the board"),
        (with_driver("Y", 0), "the TMC2209 at address 0 of PC11 of the board"),
    ] {
        let (code, said) = runs("blue", pins, &dose);
        assert!(code == Some(2) && said.contains(words) && said.contains("pump `red`"), "{code:?}: {said}");
        assert!(said.contains("`--accept-settings` gives it to this pump, once"), "{said}");
        assert_eq!(rig.board.truth().steps, made, "nothing moves");
    }
    let (code, said) = runs("blue", with_driver("Y", 2), &dose);
    let told =
        "the board was reset to configure it for this pump: it turns `red` too, without current meanwhile";
    assert!(code == Some(0) && said.contains(told), "{code:?}: {said}");
    let (code, said) = runs("red", with_driver("X", 0), &["status"]);
    assert!(code == Some(0) && said.contains("may have moved unseen once"), "{code:?}: {said}");
    // Two full steps of 1.8 deg, also in a plan that is not made.
    let (code, said) = runs("red", with_driver("X", 0), &["0.2mL", "--dry-run", "--format", "json"]);
    let width = said.split("\"half_width_deg\":").nth(1).and_then(|rest| rest.split(['}', ',']).next());
    let width: f64 = width.unwrap().parse().unwrap();
    assert!(code == Some(0) && width >= 3.6, "{code:?} {width}: {said}");
    let (code, said) = runs("red", with_driver("X", 0), &["0.2mL"]);
    let told = "the board was reset to configure it for pump `blue` since";
    let is_told = said.contains("this program has reset the board to configure it") && said.contains(told);
    assert!(code == Some(0) && is_told, "{said}");
    // A pump that is refused after the reset says what that has cost, and claims no pin.
    let made = rig.board.truth().steps;
    let (code, said) = runs("violet", with_driver("Z", 3), &dose);
    let told = "the board was reset to configure it for this pump: it turns `blue`, `red` too";
    assert!(code != Some(0) && said.contains("at address 3") && said.contains(told), "{code:?}: {said}");
    assert_eq!(rig.board.truth().steps, made, "nothing moves");
    // An address is no part of the configuration: once it is right, no other pump is reset for it.
    let (code, said) = runs("violet", with_driver("Z", 1), &dose);
    assert_eq!(code, Some(0), "{said}");
    for (number, (id, pins)) in
        [("red", ("X", 0)), ("violet", ("Z", 1)), ("red", ("X", 0))].into_iter().enumerate()
    {
        let (code, said) = runs(id, with_driver(pins.0, pins.1), &["0.2mL"]);
        // The first is told of the reset for the pump that was refused.
        assert!(code == Some(0) && said.contains("was reset") == (number == 0), "{number} {code:?}: {said}");
    }
    let (code, said) = runs("orange", socket("E"), &dose);
    assert!(code == Some(0) && !said.contains("on record claims"), "{code:?}: {said}");
    let (code, said) = runs("green", with_driver("X", 0), &["1mL", "--confirm-pump", "--accept-settings"]);
    assert!(code == Some(0) && said.contains("the socket turned pump `red`"), "{code:?}: {said}");
    let (code, said) = runs("red", with_driver("X", 0), &dose);
    assert!(code == Some(2) && said.contains("pump `green`"), "{code:?}: {said}");
}

#[test]
fn a_step_rate_beyond_that_of_the_microcontroller_is_refused_before_anything_moves() {
    let slow = board(Character { chip: "unheard-of", ..Character::default() });
    let path = slow.pump();
    let text = std::fs::read_to_string(&path).unwrap();
    let steps = text.lines().find(|line| line.starts_with("steps_per_rev")).unwrap();
    std::fs::write(&path, text.replace(steps, "steps_per_rev = 51200")).unwrap();
    let file = pump_bench::PumpFile::read(&path).unwrap();
    let rpm = 0.95 * file.motor.max_speed_rpm;
    let rate = format!("{}mL/s", file.model().unwrap().revolution_ml() * rpm / 60.0);
    let doses = |rig: &Rig| {
        let words = ["2mL", "--rate", &rate, "--confirm-pump", "--start-angle", "0deg"];
        ended(command(slow.folder.path(), &path, rig.board.path(), &words).spawn().unwrap())
    };
    let needed = rpm / 60.0 * 51_200.0;
    // A 1024th of 72 MHz, less some room for whole ticks.
    let limit = 0.95 * 72e6 / 1024.0;
    assert!(needed > limit && needed < 250_000.0, "{needed} steps/s");
    let (code, said) = doses(&slow);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("the klipper driver makes 667"), "{said}");
    assert!(
        said.contains("steps/s at most") && said.contains("dose slower, or with fewer microsteps"),
        "{said}"
    );
    assert_eq!(slow.board.truth().steps, [0; 4]);
    // An STM32F103 makes them, and keeps to each.
    let fast = board(Character::default());
    let (code, said) = doses(&fast);
    assert_eq!((code, fast.board.truth().shutdown), (Some(0), None), "{said}");
    assert!(fast.board.truth().steps[0] > 0);
}

#[test]
fn a_pump_whose_driver_is_not_reached_takes_no_place_and_one_that_is_takes_the_shared_part() {
    let rig = Rig::of(Character::default(), with_driver("X", 0));
    let runs = |id: &str, pins, words: &[&str]| {
        let pump = rig.pump_at(id, pins);
        ended(command(rig.folder.path(), &pump, rig.board.path(), words).spawn().unwrap())
    };
    let (dose, accepts) = (["1mL", "--confirm-pump"], ["1mL", "--confirm-pump", "--accept-settings"]);
    let (code, said) = runs("red", with_driver("X", 0), &dose);
    assert_eq!(code, Some(0), "{said}");
    let made = rig.board.truth().steps;
    // The wire that it writes is none: the chip never answers.
    let mut unwired = with_driver("Y", 0);
    unwired.tmc.as_mut().unwrap().tx = Some("PC9".parse().unwrap());
    let (code, said) = runs("blue", unwired, &accepts);
    assert!(code != Some(0) && said.contains("no TMC2209 answers"), "{code:?}: {said}");
    let (code, said) = runs("green", with_driver("X", 2), &dose);
    assert!(code == Some(2) && said.contains("pump `red`"), "the pin is still that of red: {code:?}: {said}");
    assert_eq!(rig.board.truth().steps, made, "nothing moves");
    // The driver at that address is not switched on by the enable pin of another socket.
    let (code, said) = runs("blue", with_driver("Y", 0), &accepts);
    assert!(code == Some(2) && said.contains("its enable input is off"), "{code:?}: {said}");
    // A pump that is reached takes the driver's address, and leaves the pins.
    let mut reached = with_driver("Y", 0);
    reached.enable = Some("!PB14".parse().unwrap());
    let (code, said) = runs("blue", reached, &accepts);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = runs("green", with_driver("X", 2), &dose);
    assert!(code == Some(2) && said.contains("the pin PB13"), "{code:?}: {said}");
}
