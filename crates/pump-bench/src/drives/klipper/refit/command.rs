//! The numbers of one `queue_step` command.

/// Steps whose intervals change evenly, in the words of `queue_step` (Klipper, docs/MCU_Commands.md).
///
/// The first step comes `interval` ticks after the step before the command, and each further interval is `add` ticks
/// longer than the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct StepCommand {
    /// First interval, in ticks.
    pub(in crate::drives::klipper) interval: u32,
    /// Number of steps. It is not 0.
    pub(in crate::drives::klipper) count: u16,
    /// Change of the interval from step to step, in ticks.
    pub(in crate::drives::klipper) add: i16,
}

impl StepCommand {
    /// Returns the time from the step before the command to its step `k` (from 1), in ticks.
    pub(in crate::drives::klipper) fn due(&self, k: u16) -> i64 {
        let k = i64::from(k);
        k * i64::from(self.interval) + i64::from(self.add) * (k * (k - 1) / 2)
    }

    /// Returns the time from the step before the command to its last step, in ticks.
    pub(in crate::drives::klipper) fn span(&self) -> u64 {
        u64::try_from(self.due(self.count)).unwrap_or(0)
    }

    /// Returns the shorter of the first interval and the last, in ticks: no interval is shorter.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn shortest_interval(&self) -> i64 {
        i64::from(self.interval).min(self.interval_before(self.count))
    }

    /// Returns the interval before step `k` (from 1), in ticks.
    fn interval_before(&self, k: u16) -> i64 {
        i64::from(self.interval) + i64::from(self.add) * (i64::from(k) - 1)
    }

    /// Cuts the command after its first `count` steps. The times of all steps remain.
    ///
    /// The rest is `None` if the command has no more than `count` steps.
    pub(super) fn cut(self, count: u16) -> (Self, Option<Self>) {
        if count == 0 || count >= self.count {
            return (self, None);
        }
        let interval = u32::try_from(self.interval_before(count + 1)).unwrap_or(self.interval);
        (Self { count, ..self }, Some(Self { interval, count: self.count - count, add: self.add }))
    }
}
