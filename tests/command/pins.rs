//! The pins of a step driver at a node or at a Klipper board, as a pump file gives them.

use std::fs;

use crate::user::User;

/// Writes a pump file with these lines after `[drive]`. Returns what `dose pumps check` says.
fn check(user: &User, drive: &str) -> (i32, String) {
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    fs::write(user.path("own.toml"), format!("{shown}\n[drive]\n{drive}")).unwrap();
    let answer = user.types(&["pumps", "check", "own.toml"]);
    (answer.code, answer.out + &answer.err)
}

const NODE: &str = "driver = \"node\"\nport = \"/dev/ttyUSB0\"\n";

#[test]
fn the_pins_are_those_of_a_drv8825_unless_the_file_gives_others() {
    let user = User::new();
    // Texas Instruments, SLVSA73F, section 6.6: 1.9 us high and low, 650 ns set-up and hold, 1.7 ms to wake.
    let (code, said) = check(&user, NODE);
    assert_eq!(code, 0, "{said}");
    let usual = "step high for 1.9 us, then 1.9 us off; direction 0.65 us before and 0.65 us after a step; enable low, \
                 1.7 ms before a step; index sensor not connected; \
                 stepper driver's fault not connected; dead-man 500 ms";
    assert!(said.contains(usual), "{said}");
    let assumed = said.lines().find(|line| line.trim_start().starts_with("assumed")).unwrap();
    assert!(assumed.contains("step pulse, step pause") && assumed.contains("dead-man time"), "{assumed}");

    let pins = "dead_man_ms = 300\n[drive.pins]\nstep_pulse_us = 0.2\nenable_active_low = false\ndriver_fault = true\n";
    let (code, said) = check(&user, &format!("{NODE}{pins}"));
    assert_eq!(code, 0, "{said}");
    for text in
        ["step high for 0.2 us", "enable high", "stepper driver's fault low in a fault", "dead-man 300 ms"]
    {
        assert!(said.contains(text), "{text}: {said}");
    }
    let given = said.lines().find(|line| line.trim_start().starts_with("given")).unwrap();
    for value in ["step pulse", "enable level", "stepper driver's fault", "dead-man time"] {
        assert!(given.contains(value), "{value}: {given}");
    }
    for (value, said) in [
        ("\"high\"", "fault high in a fault"),
        ("\"low\"", "fault low in a fault"),
        ("false", "not connected"),
    ] {
        let (code, told) = check(&user, &format!("{NODE}[drive.pins]\ndriver_fault = {value}\n"));
        assert!(code == 0 && told.contains(said), "{value}: {told}");
    }
    let (code, told) = check(&user, &format!("{NODE}[drive.pins]\ndriver_fault = \"maybe\"\n"));
    assert!(code == 2 && told.contains("allowed: true or \"low\", \"high\", false"), "{told}");
}

#[test]
fn a_value_of_the_pins_out_of_range_is_one_message() {
    let user = User::new();
    for (drive, said) in [
        (
            format!("{NODE}[drive.pins]\nstep_pulse_us = 200.0\n"),
            "[drive.pins] step_pulse_us is 200; allowed: 0.1 to 100",
        ),
        (
            format!("{NODE}[drive.pins]\nstep_pause_us = 0.0\n"),
            "[drive.pins] step_pause_us is 0; allowed: 0.1 to 100",
        ),
        (
            format!("{NODE}[drive.pins]\nenable_setup_ms = -1.0\n"),
            "[drive.pins] enable_setup_ms is -1; allowed: 0 to 1000",
        ),
        (format!("{NODE}dead_man_ms = 50\n"), "[drive] dead_man_ms is 50; allowed: 100 to 10000"),
        (format!("{NODE}[drive.pins]\nstep_us = 1.0\n"), "step_us"),
        (
            format!("{NODE}axis = \"B\"\n"),
            "[drive] axis is B; allowed: X, Y, Z or A beside driver = \"node\"",
        ),
        (
            "driver = \"sim\"\n[drive.pins]\nstep_pulse_us = 2.0\n".to_owned(),
            "[drive.pins] is given; allowed: beside driver = \"node\"",
        ),
    ] {
        let (code, answer) = check(&user, &drive);
        assert!(code == 2 && answer.contains(said), "{said}: {answer}");
    }
}

const KLIPPER: &str = "driver = \"klipper\"\nport = \"/dev/ttyACM0\"\n";
const PINS: &str = "[drive.klipper]\nstep = \"PB13\"\ndir = \"PB12\"\nenable = \"!PB14\"\n";
const TMC: &str = "[drive.klipper.tmc]\nuart = \"PC11\"\ntx = \"PC10\"\nrun_a = 0.5\n";

#[test]
fn the_pins_and_the_stepper_driver_of_a_klipper_board_are_listed() {
    let user = User::new();
    let (code, said) = check(&user, &format!("{KLIPPER}{PINS}"));
    assert_eq!(code, 0, "{said}");
    for text in [
        "step PB13 for 2 us, then 2 us off at least; direction PB12; enable !PB14; no index sensor; dead-man 500 ms",
        "stays as its jumpers and its trimmer set it",
        " steps/s",
    ] {
        assert!(said.contains(text), "{text}: {said}");
    }
    let (code, said) = check(&user, &format!("{KLIPPER}{PINS}{TMC}hold_a = 0.3\n"));
    assert_eq!(code, 0, "{said}");
    let stepper = "TMC2209 at PC11, written by PC10, address 0; 0.490 A (RMS) of run_a = 0.5 A while the motor turns, \
                   0.275 A at rest, by the chip's scale with 0.11 Ohm; ";
    assert!(said.contains(stepper) && said.contains("which the board sets"), "{said}");
    let given = said.lines().find(|line| line.trim_start().starts_with("given")).unwrap();
    assert!(given.contains("current at rest"), "{given}");
}

#[test]
fn a_check_refuses_what_the_drive_of_a_klipper_board_would_refuse() {
    let user = User::new();
    let range = "allowed: 0.031 to 1.768 A (RMS) with [drive.klipper.tmc] sense_ohm of 0.11 Ohm";
    for (drive, said) in [
        (format!("{KLIPPER}{PINS}{TMC}hold_a = 0.9\n"), "hold_a is 0.9 A; allowed: 0.031 A to run_a, 0.5 A"),
        (format!("{KLIPPER}{PINS}{}", TMC.replace("0.5", "1.9")), range),
        (format!("{KLIPPER}{PINS}{}", TMC.replace("0.5", "0.01")), range),
        (format!("{KLIPPER}{PINS}{TMC}sense_ohm = 0.05\n"), "sense_ohm is 0.05 Ohm; allowed: 0.075 to 1 Ohm"),
        (format!("{KLIPPER}{PINS}{TMC}address = 4\n"), "address is 4; allowed: 0 to 3"),
        (
            format!("{KLIPPER}axis = \"Y\"\n{PINS}"),
            "[drive] axis is Y; allowed: no axis beside driver = \"klipper\"",
        ),
    ] {
        let (code, answer) = check(&user, &drive);
        assert!(code == 2 && answer.contains(said), "{said}: {answer}");
    }
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    let steps = shown.lines().find(|line| line.starts_with("steps_per_rev")).unwrap();
    let shown = shown.replace(steps, "steps_per_rev = 3000");
    fs::write(user.path("micro.toml"), format!("{shown}\n[drive]\n{KLIPPER}{PINS}{TMC}")).unwrap();
    let answer = user.types(&["pumps", "check", "micro.toml"]);
    let said =
        "steps_per_rev is 3000 beside full_steps_per_rev = 200; allowed: full_steps_per_rev times 1, 2, 4, 8";
    assert!(answer.code == 2 && answer.err.contains(said), "{}", answer.err);
}

#[test]
fn a_plan_without_a_board_keeps_to_the_pulses_of_a_klipper_boards_pins() {
    let user = User::new();
    let (code, said) = check(&user, &format!("{KLIPPER}{PINS}step_pulse_us = 100.0\n"));
    assert_eq!(code, 0, "{said}");
    let plans = |rate: &str| {
        let words = ["2mL", "--rate", rate, "--pump", "own.toml", "--dry-run", "--start-angle", "0deg"];
        user.types(&words)
    };
    // 5000 steps/s at most: pulse and pause of 100 us.
    let fast = plans("9mL/s");
    assert!(
        fast.code == 2 && fast.err.contains("the klipper driver makes 5000 steps/s at most"),
        "{}",
        fast.err
    );
    let slow = plans("1mL/s");
    assert_eq!(slow.code, 0, "{}", slow.err);
}
