//! A pump as Rust constants: `dose pumps show NAME --format rust`, compiled.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_dose::built_in;
use pump_dose::rust_source::rust_source;

#[path = "../examples/firmware/src/pump.rs"]
mod pump;

#[test]
fn the_firmwares_constants_are_the_pump_to_the_last_bit() {
    let file = built_in("three-roller").unwrap();
    assert_eq!(pump::PUMP, file.model().unwrap());
    assert_eq!(pump::LIMITS, file.limits());
}

#[test]
fn the_firmwares_constants_are_what_the_command_prints() {
    let printed = rust_source(&built_in("three-roller").unwrap()).unwrap();
    assert_eq!(printed, include_str!("../examples/firmware/src/pump.rs"));
}
