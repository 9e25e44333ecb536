//! A pump as Rust constants: `dose pumps show NAME --format rust`, compiled.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_bench::built_in;
use pump_bench::export::rust_source;

#[path = "../examples/firmware/src/pump.rs"]
#[allow(unreachable_pub, reason = "written by the command, for a module or a crate")]
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

#[test]
fn a_torque_that_the_pump_file_knows_is_printed_too() {
    let mut file = built_in("three-roller").unwrap();
    file.motor.torque_curve_rpm_n_m = Some(vec![(0.0, 1.2), (170.0, 0.9)]);
    (file.motor.occlusion_torque_n_m, file.motor.inertia_kg_m2) = (Some(0.4), Some(2e-4));
    let printed = rust_source(&file).unwrap();
    assert!(
        printed.contains(
            "use pump_ctl::plan::{Limits, Lowest, Motor, PressureLimits, SetBy, Torque, TorqueCurve};"
        ),
        "{printed}"
    );
    let motor = file.limits().torque.unwrap().motor;
    assert!(printed.contains(&format!("motor: TorqueCurve::precomputed({:?})", motor.precomputed_points())));
    assert!(printed.contains("occlusion_n_m: 0.4,") && printed.contains("inertia_kg_m2: 0.0002,"));
}
