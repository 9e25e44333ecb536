//! The abilities of a drive.

/// Way in which motions of several axes go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Together {
    /// They begin at one tick of their board, or at one instant if each has a board of its own. Each keeps its own
    /// times.
    Begin,
    /// They are one line: they begin together, keep the ratio of their steps, and end together. No axis moves while
    /// others do otherwise.
    Line,
}

/// Abilities of a drive. Anything else is refused before the motor moves, never approximated in silence.
///
/// ```
/// use pump_bench::drives::Abilities;
///
/// let abilities = Abilities::new().with_step_times(true).with_angle_dependent_speed(true);
/// assert!(abilities.step_times && !abilities.index);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Abilities {
    /// True if the drive makes each step at the plan's time. Otherwise the device has ramps of its own and
    /// keeps to the cruise speed.
    pub step_times: bool,
    /// True if the speed may follow the rollers' angle.
    pub angle_dependent_speed: bool,
    /// True if the drive runs a flow over time ([`Drive::run_flow`](super::Drive::run_flow)).
    pub flow_over_time: bool,
    /// True if the drive finds an index mark by a sensor.
    pub index: bool,
    /// True if the drive reads the device's own step count.
    pub readback: bool,
    /// True if the drive tells each reset of the device ([`Drive::disturbed`](super::Drive::disturbed)). A count of
    /// zero is then one as any other, and otherwise that of a device which was just switched on.
    pub tells_resets: bool,
    /// True if the device may be reset as it is met, with the other motors of its board. It is then met only for a
    /// motion that the record does not refuse.
    pub resets_as_met: bool,
    /// True if the drive can let go of the rotor ([`Drive::release`](super::Drive::release)).
    pub release: bool,
    /// Way in which the drive makes a motion together with those of other axes of its board, or of other boards
    /// ([`Drive::begin_with`](super::Drive::begin_with)). `None` if it makes each by itself.
    pub together: Option<Together>,
}

impl Abilities {
    /// Abilities of a board that speaks grbl's protocol.
    pub(super) const GRBL: Self =
        Self::new().with_index(true).with_readback(true).with_release(true).with_together(Together::Line);

    /// Abilities of a node: a board that makes each step at the plan's time.
    pub(super) const NODE: Self = Self::GRBL
        .with_step_times(true)
        .with_angle_dependent_speed(true)
        .with_flow_over_time(true)
        .with_tells_resets(true)
        .with_together(Together::Begin);

    /// Abilities of a motor at a board with the Klipper firmware, which makes each step at the plan's time. It begins
    /// together with motors of other such boards.
    pub(super) const KLIPPER: Self = Self::new()
        .with_index(true)
        .with_readback(true)
        .with_release(true)
        .with_step_times(true)
        .with_angle_dependent_speed(true)
        .with_flow_over_time(true)
        .with_tells_resets(true)
        .with_resets_as_met(true)
        .with_together(Together::Begin);

    /// Returns the abilities of a drive that runs at constant speed on ramps of its own, and has neither a sensor
    /// nor a count.
    pub const fn new() -> Self {
        Self {
            step_times: false,
            angle_dependent_speed: false,
            flow_over_time: false,
            index: false,
            readback: false,
            tells_resets: false,
            resets_as_met: false,
            release: false,
            together: None,
        }
    }

    /// Returns the abilities with or without steps at the plan's times.
    #[must_use]
    pub const fn with_step_times(self, step_times: bool) -> Self {
        Self { step_times, ..self }
    }

    /// Returns the abilities with or without a speed that follows the rollers' angle.
    #[must_use]
    pub const fn with_angle_dependent_speed(self, angle_dependent_speed: bool) -> Self {
        Self { angle_dependent_speed, ..self }
    }

    /// Returns the abilities with or without flows over time.
    #[must_use]
    pub const fn with_flow_over_time(self, flow_over_time: bool) -> Self {
        Self { flow_over_time, ..self }
    }

    /// Returns the abilities with or without an index sensor.
    #[must_use]
    pub const fn with_index(self, index: bool) -> Self {
        Self { index, ..self }
    }

    /// Returns the abilities with or without a step count of the device.
    #[must_use]
    pub const fn with_readback(self, readback: bool) -> Self {
        Self { readback, ..self }
    }

    /// Returns the abilities of a drive that tells each reset of the device, or may not hear of one.
    #[must_use]
    pub const fn with_tells_resets(self, tells_resets: bool) -> Self {
        Self { tells_resets, ..self }
    }

    /// Returns the abilities of a drive whose device may be reset as it is met, or is not.
    #[must_use]
    pub const fn with_resets_as_met(self, resets_as_met: bool) -> Self {
        Self { resets_as_met, ..self }
    }

    /// Returns the abilities with or without a way to let go of the rotor.
    #[must_use]
    pub const fn with_release(self, release: bool) -> Self {
        Self { release, ..self }
    }

    /// Returns the abilities with motions that go together with those of other axes in this way.
    #[must_use]
    pub const fn with_together(self, together: Together) -> Self {
        Self { together: Some(together), ..self }
    }
}
