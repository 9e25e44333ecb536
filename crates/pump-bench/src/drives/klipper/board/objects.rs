//! The objects of a motor at a board, by their numbers.

/// Objects of a motor, by their numbers. Those of the motor at a place among the motors of a board never change, so
/// that any configuration of this drive can be brought to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Objects {
    /// Stepper.
    pub(in crate::drives::klipper) stepper: u8,
    /// Trigger group that stops the stepper when this computer falls silent.
    pub(in crate::drives::klipper) dead_man: u8,
    /// Output that gives the motor current.
    pub(in crate::drives::klipper) enable: u8,
    /// Input of the index sensor.
    pub(in crate::drives::klipper) index: u8,
    /// Trigger group that tells of the index sensor, and stops nothing.
    pub(in crate::drives::klipper) index_group: u8,
    /// Line to the stepper driver. Motors whose drivers share a line share the object.
    pub(in crate::drives::klipper) driver_line: u8,
}

impl Objects {
    /// Number of objects of a motor.
    pub(super) const COUNT: u8 = 6;

    /// Returns the objects of the motor at a place, whose stepper driver is at the line of the motor at place `line`.
    pub(super) const fn of(place: u8, line: u8) -> Self {
        let first = place * Self::COUNT;
        Self {
            stepper: first,
            dead_man: first + 1,
            enable: first + 2,
            index: first + 3,
            index_group: first + 4,
            driver_line: line * Self::COUNT + 5,
        }
    }
}
