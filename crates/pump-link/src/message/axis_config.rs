//! The configuration of an axis.

use serde::{Deserialize, Serialize};

use crate::timing::ns_in_ticks;

/// The configuration of an axis: the times of its driver, the polarity of its pins, and what is connected.
///
/// The default has the times of a DRV8825, as `pump_ctl::drive::Timing` does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct AxisConfig {
    /// Time for which the step pin is active, ns.
    pub step_high_ns: u32,
    /// Time for which the step pin is inactive before the next step, ns.
    pub step_low_ns: u32,
    /// Time from a change of direction to the next step, ns.
    pub direction_setup_ns: u32,
    /// Time from a step to the next change of direction, ns.
    pub direction_hold_ns: u32,
    /// Time from enable to the first step, ns.
    pub enable_setup_ns: u32,
    /// True if the motor steps when the step pin falls.
    pub step_active_low: bool,
    /// True if the motor is energised while the enable pin is low.
    pub enable_active_low: bool,
    /// True if a low direction pin is forward.
    pub reversed: bool,
    /// True if an index sensor is connected.
    pub has_index: bool,
    /// True if the index sensor is active while its pin is low.
    pub index_active_low: bool,
    /// Output by which the driver reports a fault.
    pub driver_fault: FaultOutput,
    /// True if the motor is energised as soon as the axis is configured. If not, it is let go until its next move.
    pub energised: bool,
    /// Time at rest after which the motor is let go, ms. It is 0 for a motor that is held for ever.
    pub idle_release_ms: u32,
    /// Number of entries of the brake, 1 to 32.
    pub brake_entries: u8,
}

/// Output by which a stepper driver reports a fault, as it is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultOutput {
    /// Nothing is connected.
    None,
    /// The output is low in a fault, as nFAULT of a DRV8825.
    ActiveLow,
    /// The output is high in a fault, as DIAG of a TMC2209.
    ActiveHigh,
}

/// Longest time of a step pulse that a node waits for in its interrupt, ns.
const LONGEST_PULSE_NS: u32 = 100_000;

/// Longest time from enable to the first step, ns.
const LONGEST_SETUP_NS: u32 = 1_000_000_000;

impl AxisConfig {
    /// Makes the configuration of a DRV8825 whose motor is energised by its first move and held from then on.
    pub const fn new(brake_entries: u8) -> Self {
        Self {
            step_high_ns: 1900,
            step_low_ns: 1900,
            direction_setup_ns: 650,
            direction_hold_ns: 650,
            enable_setup_ns: 1_700_000,
            step_active_low: false,
            enable_active_low: true,
            reversed: false,
            has_index: false,
            index_active_low: false,
            driver_fault: FaultOutput::None,
            energised: false,
            idle_release_ms: 0,
            brake_entries,
        }
    }

    /// Returns the ticks for which a node keeps the step pin active, and inactive before the next step, on a timer of
    /// this rate, Hz.
    pub const fn pulse_ticks(&self, tick_hz: u32) -> [u64; 2] {
        // A tick more: the pin changes between two ticks.
        [ns_in_ticks(self.step_high_ns, tick_hz) + 1, ns_in_ticks(self.step_low_ns, tick_hz) + 1]
    }

    /// Returns the shortest interval of two steps that the pulses of the step pin allow, ticks of a timer of this
    /// rate, Hz. The node refuses a move with a shorter one.
    ///
    /// ```
    /// // 1.9 us are 2 ticks of a timer of 1 MHz.
    /// assert_eq!(pump_link::message::AxisConfig::new(1).least_interval(1_000_000), 6);
    /// ```
    pub const fn least_interval(&self, tick_hz: u32) -> u64 {
        let [active, inactive] = self.pulse_ticks(tick_hz);
        active + inactive
    }

    /// Returns true if a node can use the configuration: pulses and set-up times of the direction pin of 100 us
    /// at most, 1 s at most from enable to the first step, and a brake of 1 to 32 entries.
    pub fn is_valid(&self) -> bool {
        let short = [self.step_high_ns, self.step_low_ns, self.direction_setup_ns, self.direction_hold_ns];
        short.iter().all(|ns| *ns <= LONGEST_PULSE_NS)
            && self.enable_setup_ns <= LONGEST_SETUP_NS
            && (1..=pump_ctl::step::BRAKE_ENTRIES).contains(&usize::from(self.brake_entries))
    }
}
