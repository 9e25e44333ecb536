//! The times of a stepper driver and the polarity of its pins.

/// Times that a stepper driver needs, ns, and the polarity of its pins.
///
/// The default is that of a DRV8825, the slowest of the common drivers. Its times are 1.9 us high and low,
/// 650 ns set-up and hold, and 1.7 ms from sleep to step (Texas Instruments, SLVSA73F, section 6.6).
///
/// ```
/// use pump_ctl::drive::Timing;
///
/// let timing = Timing::new().with_step_high_ns(1000).with_step_low_ns(1000).with_reversed(true);
/// assert_eq!((timing.step_high_ns, timing.direction_setup_ns), (1000, 650));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Timing {
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
    /// True if the motor is energised while the enable pin is low.
    pub enable_active_low: bool,
    /// True if a low direction pin is forward.
    pub reversed: bool,
    /// True if the index sensor is active while its pin is low.
    pub index_active_low: bool,
}

impl Timing {
    /// Makes the default timing, that of a DRV8825.
    pub const fn new() -> Self {
        Self {
            step_high_ns: 1900,
            step_low_ns: 1900,
            direction_setup_ns: 650,
            direction_hold_ns: 650,
            enable_setup_ns: 1_700_000,
            enable_active_low: true,
            reversed: false,
            index_active_low: false,
        }
    }

    /// Returns the timing with another time for which the step pin is active, ns.
    #[must_use]
    pub const fn with_step_high_ns(self, step_high_ns: u32) -> Self {
        Self { step_high_ns, ..self }
    }

    /// Returns the timing with another time for which the step pin is inactive before the next step, ns.
    #[must_use]
    pub const fn with_step_low_ns(self, step_low_ns: u32) -> Self {
        Self { step_low_ns, ..self }
    }

    /// Returns the timing with another time from a change of direction to the next step, ns.
    #[must_use]
    pub const fn with_direction_setup_ns(self, direction_setup_ns: u32) -> Self {
        Self { direction_setup_ns, ..self }
    }

    /// Returns the timing with another time from a step to the next change of direction, ns.
    #[must_use]
    pub const fn with_direction_hold_ns(self, direction_hold_ns: u32) -> Self {
        Self { direction_hold_ns, ..self }
    }

    /// Returns the timing with another time from enable to the first step, ns.
    #[must_use]
    pub const fn with_enable_setup_ns(self, enable_setup_ns: u32) -> Self {
        Self { enable_setup_ns, ..self }
    }

    /// Returns the timing with a motor that is energised while the enable pin is low, or while it is high.
    #[must_use]
    pub const fn with_enable_active_low(self, enable_active_low: bool) -> Self {
        Self { enable_active_low, ..self }
    }

    /// Returns the timing with a low direction pin that is forward, or reverse.
    #[must_use]
    pub const fn with_reversed(self, reversed: bool) -> Self {
        Self { reversed, ..self }
    }

    /// Returns the timing with an index sensor that is active while its pin is low, or while it is high.
    #[must_use]
    pub const fn with_index_active_low(self, index_active_low: bool) -> Self {
        Self { index_active_low, ..self }
    }
}

impl Default for Timing {
    fn default() -> Self {
        Self::new()
    }
}
