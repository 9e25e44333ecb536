//! `[drive.pins]`: the times and the polarity of a step driver's pins, which a node keeps to.

use serde::{Deserialize, Serialize};

use super::driver_fault::DriverFault;
use crate::pump_file::range::{WrongValue, within_if_given};

/// Longest time of a pulse, and of the direction pin before and after a step, in us. A node waits for it in its
/// interrupt.
const LONGEST_PULSE_US: f64 = 100.0;

/// Shortest pulse that any common driver takes, in us: 100 ns of a TMC2209 (Trinamic, TMC2209 datasheet rev. 1.09,
/// section 12.1).
const SHORTEST_PULSE_US: f64 = 0.1;

/// Longest time from enable to the first step, in ms.
const LONGEST_SETUP_MS: f64 = 1000.0;

/// The table `[drive.pins]`. A value that it leaves out is as for a DRV8825, the slowest of the common drivers (Texas
/// Instruments, SLVSA73F, section 6.6), with nothing at its fault output.
///
/// ```
/// use pump_bench::pump_file::PinsTable;
///
/// let mut pins = PinsTable::default();
/// pins.step_pulse_us = Some(0.2);
/// let used = pins.or_usual();
/// assert_eq!((used.step_pulse_us, used.step_pause_us, used.enable_setup_ms), (0.2, 1.9, 1.7));
/// assert!(used.enable_active_low && !used.step_active_low);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct PinsTable {
    /// Time for which the step pin is active, in us.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_pulse_us: Option<f64>,
    /// Time for which the step pin is inactive before the next step, in us.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_pause_us: Option<f64>,
    /// Time from a change of direction to the next step, in us.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_setup_us: Option<f64>,
    /// Time from a step to the next change of direction, in us.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_hold_us: Option<f64>,
    /// Time from enable to the first step, in ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub enable_setup_ms: Option<f64>,
    /// True if the motor steps when the step pin falls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_active_low: Option<bool>,
    /// True if the motor is energised while the enable pin is low.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub enable_active_low: Option<bool>,
    /// True if the index sensor is active while its pin is low.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index_active_low: Option<bool>,
    /// Fault output of the stepper driver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver_fault: Option<DriverFault>,
}

/// Times and polarity of a step driver's pins, none of which is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pins {
    /// Time for which the step pin is active, in us.
    pub step_pulse_us: f64,
    /// Time for which the step pin is inactive before the next step, in us.
    pub step_pause_us: f64,
    /// Time from a change of direction to the next step, in us.
    pub direction_setup_us: f64,
    /// Time from a step to the next change of direction, in us.
    pub direction_hold_us: f64,
    /// Time from enable to the first step, in ms.
    pub enable_setup_ms: f64,
    /// True if the motor steps when the step pin falls.
    pub step_active_low: bool,
    /// True if the motor is energised while the enable pin is low.
    pub enable_active_low: bool,
    /// True if the index sensor is active while its pin is low.
    pub index_active_low: bool,
    /// Fault output of the stepper driver.
    pub driver_fault: DriverFault,
}

impl PinsTable {
    /// Returns the values that are given, and the usual ones in place of those that are not.
    pub fn or_usual(&self) -> Pins {
        Pins {
            step_pulse_us: self.step_pulse_us.unwrap_or(1.9),
            step_pause_us: self.step_pause_us.unwrap_or(1.9),
            direction_setup_us: self.direction_setup_us.unwrap_or(0.65),
            direction_hold_us: self.direction_hold_us.unwrap_or(0.65),
            enable_setup_ms: self.enable_setup_ms.unwrap_or(1.7),
            step_active_low: self.step_active_low.unwrap_or(false),
            enable_active_low: self.enable_active_low.unwrap_or(true),
            index_active_low: self.index_active_low.unwrap_or(false),
            driver_fault: self.driver_fault.unwrap_or(DriverFault::None),
        }
    }

    /// Refuses the first value outside its range.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        let pulse = SHORTEST_PULSE_US..=LONGEST_PULSE_US;
        within_if_given("[drive.pins] step_pulse_us", self.step_pulse_us, pulse.clone())?;
        within_if_given("[drive.pins] step_pause_us", self.step_pause_us, pulse)?;
        let short = 0.0..=LONGEST_PULSE_US;
        within_if_given("[drive.pins] direction_setup_us", self.direction_setup_us, short.clone())?;
        within_if_given("[drive.pins] direction_hold_us", self.direction_hold_us, short)?;
        within_if_given("[drive.pins] enable_setup_ms", self.enable_setup_ms, 0.0..=LONGEST_SETUP_MS)
    }
}
