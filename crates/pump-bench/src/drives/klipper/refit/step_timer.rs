//! The clock of a board, as far as the times of steps need it.

use super::error::RefitError;

/// Slowest clock, in Hz. The time of a step is then told to half a microsecond.
const SLOWEST_HZ: u32 = 1_000_000;

/// Longest interval, in ticks.
///
/// A board compares its times as signed numbers of 32 bits (Klipper, src/sched.c, the sentinel timer at 2^31 ticks).
/// Half of that reach remains for a command that comes late.
pub(super) const LONGEST: u32 = 1 << 30;

/// Distance of a step from its time that is aimed at, in ticks, where the bounds in microseconds allow it.
///
/// An addition in whole ticks is wrong by half a tick at most, which bends a run of n steps by n²/16 ticks. So
/// 64 ticks either way hold 45 steps whatever the fraction is.
const NEAR_TICKS: f64 = 64.0;

/// Bounds of that distance, in us. Half of the second is where commands are few and steps near: a quarter of it makes
/// a fifth more commands. The second keeps all steps within 2 us of the plan, with a tenth for the rounding of times.
const NEAR_US: (f64, f64) = (0.95, 1.9);

/// Clock of a board whose steps are refitted.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::klipper) struct StepTimer {
    hz: u32,
    shortest: u32,
}

impl StepTimer {
    /// Makes the clock of a board with `hz` ticks a second, which makes steps `shortest` ticks apart and no closer.
    ///
    /// # Errors
    ///
    /// Refuses a clock below 1 MHz, and a shortest interval of no tick or of more than 2^30 ticks.
    pub(in crate::drives::klipper) fn new(hz: u32, shortest: u32) -> Result<Self, RefitError> {
        if hz < SLOWEST_HZ {
            return Err(RefitError::Clock { hz, slowest_hz: SLOWEST_HZ });
        }
        if shortest == 0 || shortest > LONGEST {
            return Err(RefitError::Shortest { ticks: shortest, longest: LONGEST });
        }
        Ok(Self { hz, shortest })
    }

    /// Returns the most steps a second that the board makes.
    pub(in crate::drives::klipper) fn most_steps_s(&self) -> f64 {
        self.hz() / f64::from(self.shortest)
    }

    /// Returns the ticks of a second.
    pub(in crate::drives::klipper) fn hz(&self) -> f64 {
        f64::from(self.hz)
    }

    /// Returns the shortest interval, in ticks.
    pub(super) fn shortest(&self) -> u32 {
        self.shortest
    }

    /// Returns the distance of a step from its time that is aimed at, and the largest one that is allowed, in ticks.
    pub(super) fn tolerances(&self) -> (f64, f64) {
        let us = self.hz() * 1e-6;
        (NEAR_TICKS.clamp(NEAR_US.0 * us, NEAR_US.1 * us), NEAR_US.1 * us)
    }
}
