//! The silences of a host while a motor turns, in the host's own time. The board's time stands in a long one, so that a
//! slow computer is no lost link. The host is held to its keep-alive here instead.

use std::fs;
use std::time::Duration;

/// Longest silence of a host while a motor turns: a pause that nobody sees (NODE.md, rule 5). The host asks for the
/// state every 20 ms and repeats after 50 ms what was not answered, so it speaks far more often.
pub(super) const LONGEST: Duration = Duration::from_millis(200);

/// What a look at the line found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// Time of the look, and the time for which the host had waited for a processor by then.
    pub(super) at: Duration,
    pub(super) queued: Duration,
    /// True if a frame has come.
    pub(super) has_frame: bool,
    /// Time of the last step of a motor that turns. There is none for one that stands.
    pub(super) stepped_ns: Option<f64>,
}

/// Silences of a host, by looks at its line. A silence counts once the motor makes a step after it: a host may be
/// silent after the last one.
#[derive(Debug, Default)]
pub(super) struct Silences {
    before: Option<Look>,
    /// Silence until now, the longest one since the last step, and the longest one that counts.
    now: Duration,
    unsure: Duration,
    longest: Duration,
}

impl Silences {
    /// Notes a look at the line. One that finds a frame ends the silence at the look before it, for the frame came
    /// since.
    ///
    /// The time in which the host has no processor is the computer's silence, not the host's.
    pub(super) fn look(&mut self, look: Look) {
        let Some(before) = self.before.replace(look) else { return };
        if look.stepped_ns.is_none() || look.has_frame {
            self.now = Duration::ZERO;
        } else {
            let is_computer = look.queued.saturating_sub(before.queued);
            self.now += look.at.saturating_sub(before.at).saturating_sub(is_computer);
        }
        if look.stepped_ns.is_none() {
            self.unsure = Duration::ZERO;
        } else if look.stepped_ns > before.stepped_ns {
            self.longest = self.longest.max(self.unsure);
            self.unsure = Duration::ZERO;
        }
        self.unsure = self.unsure.max(self.now);
    }

    /// Returns the longest silence.
    pub(super) fn longest(&self) -> Duration {
        self.longest
    }
}

/// Returns the time for which the threads of a process were ready and had no processor. It is zero for a process that
/// has ended.
pub(super) fn queued(process: u32) -> Duration {
    let Ok(tasks) = fs::read_dir(format!("/proc/{process}/task")) else { return Duration::ZERO };
    let queued_ns = |path| {
        // Time on a processor, time ready for one, and times it got one (proc(5), schedstat).
        let text = fs::read_to_string(path).ok()?;
        text.split_whitespace().nth(1)?.parse::<u64>().ok()
    };
    let tasks = tasks.flatten().filter_map(|task| queued_ns(task.path().join("schedstat")));
    Duration::from_nanos(tasks.sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BETWEEN: Duration = Duration::from_millis(10);

    /// Returns the longest silence in ms of a host that speaks at these looks of so many, and waits for a processor for
    /// so many ms of each look. The motor makes a step before each look up to this one.
    fn longest_ms(looks: u32, spoke: &[u32], queued_ms: u64, last_step: u32) -> u128 {
        let mut silences = Silences::default();
        for look in 0..=looks {
            silences.look(Look {
                at: BETWEEN * look,
                queued: Duration::from_millis(queued_ms) * look,
                has_frame: spoke.contains(&look),
                stepped_ns: Some(f64::from(look.min(last_step))),
            });
        }
        silences.longest().as_millis()
    }

    #[test]
    fn the_longest_silence_is_that_between_two_frames() {
        assert_eq!(longest_ms(20, &[2, 4, 10, 19], 0, 20), 80);
    }

    #[test]
    fn time_without_a_processor_is_no_silence_of_the_host() {
        assert_eq!(longest_ms(20, &[2, 4, 10, 19], 7, 20), 24);
    }

    #[test]
    fn a_host_may_be_silent_after_the_last_step() {
        assert_eq!(longest_ms(20, &[2, 4, 10], 0, 11), 50);
    }

    #[test]
    fn a_silence_in_which_the_boards_time_stands_counts_with_the_next_step() {
        let mut silences = Silences::default();
        for (at_ms, has_frame, stepped_ns) in
            [(0, true, 1.0), (300, false, 1.0), (301, true, 1.0), (302, false, 2.0)]
        {
            let at = Duration::from_millis(at_ms);
            silences.look(Look { at, queued: Duration::ZERO, has_frame, stepped_ns: Some(stepped_ns) });
        }
        assert_eq!(silences.longest().as_millis(), 300);
    }
}
