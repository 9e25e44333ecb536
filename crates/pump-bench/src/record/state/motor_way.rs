//! The way in which a pump's motor is turned: its steps, its place at the board and its direction.

use crate::pump_file::{DriveTable, DriverName, MotorTable};

use crate::cut_text::CutText;

/// Way in which a motor is turned, in words. The record keeps it, so that a changed pump file is seen before the motor
/// moves by it.
pub(crate) type MotorWay = CutText<120>;

/// Returns the way in which `motor` is turned by the board of `drive`.
pub(crate) fn motor_way(motor: &MotorTable, drive: &DriveTable) -> MotorWay {
    let place = match (&drive.klipper, drive.driver) {
        (Some(pins), DriverName::Klipper) => {
            let enable = pins.enable.as_ref().map_or("none".to_owned(), ToString::to_string);
            format!("pins {} (step), {} (direction) and {enable} (enable)", pins.step, pins.dir)
        }
        _ => format!("axis {:?}", drive.axis),
    };
    let inverted = if drive.invert { ", inverted" } else { "" };
    MotorWay::new(&format!(
        "{} steps per revolution, gear {}, {place}{inverted}",
        motor.steps_per_rev, motor.gear
    ))
}
