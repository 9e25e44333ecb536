//! The silences of a host while a motor turns, in the host's own time. The board's time stands in a long one, so that a
//! slow computer is no lost link. The host is held to its keep-alive here instead.

use std::collections::BTreeMap;
use std::fs;
use std::time::Duration;

/// Longest silence of a host while a motor turns: a pause that nobody sees (NODE.md, rule 5). The host asks for the
/// state every 20 ms and repeats after 50 ms what was not answered, so it speaks far more often.
pub(super) const LONGEST: Duration = Duration::from_millis(200);

/// Time for which each thread of a process was ready and had no processor, by the thread's number.
#[derive(Debug, Clone, Default)]
pub(super) struct Waits(BTreeMap<u32, Duration>);

impl Waits {
    /// Returns the longest time for which one thread waited since `before`. Threads wait at the same time, so their
    /// sum may be longer than the time that has passed.
    fn longest_since(&self, before: &Self) -> Duration {
        let waited = |(thread, now): (&u32, &Duration)| {
            now.saturating_sub(before.0.get(thread).copied().unwrap_or_default())
        };
        self.0.iter().map(waited).max().unwrap_or_default()
    }
}

/// A finding of a look at the line.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// Time of the look, and the times for which the host's threads had waited for a processor by then.
    pub(super) at: Duration,
    pub(super) queued: Waits,
    /// Time for which the computer had carried no bytes by then.
    pub(super) uncarried: Duration,
    /// True if a frame has come.
    pub(super) has_frame: bool,
    /// Time of the last step of a motor that turns. There is none for one that stands.
    pub(super) stepped_ns: Option<f64>,
}

/// Silences of a host, by looks at its line. A silence is judged once it has ended, by a frame or with the motion: only
/// then the system tells for how long the host had waited for a processor. It counts as far as the motor makes a step
/// after it: a host may be silent after the last one.
#[derive(Debug, Default)]
pub(super) struct Silences {
    before: Option<Look>,
    /// Look that found the last frame, or a motor at rest.
    spoke: Option<Look>,
    /// Time of the look that found the last step.
    stepped_at: Duration,
    /// Longest silence since the last step, and the longest one that counts.
    unsure: Duration,
    longest: Duration,
}

impl Silences {
    /// Notes a look at the line. One that finds a frame ends the silence at the look before it, for the frame came
    /// since.
    ///
    /// The time in which a thread of the host has no processor is the computer's silence, not the host's, and so is the
    /// time in which the computer carries no bytes. They may be one time, so the longest counts.
    pub(super) fn look(&mut self, look: Look) {
        let Some(before) = self.before.replace(look.clone()) else { return };
        let spoke = self.spoke.get_or_insert_with(|| before.clone());
        let stands = look.stepped_ns.is_none();
        if look.stepped_ns > before.stepped_ns {
            self.longest = self.longest.max(self.unsure);
            self.unsure = Duration::ZERO;
            self.stepped_at = look.at;
        }
        if stands || look.has_frame {
            let uncarried = look.uncarried.saturating_sub(spoke.uncarried);
            let is_computer = look.queued.longest_since(&spoke.queued).max(uncarried);
            let until = |end: Duration| end.saturating_sub(spoke.at).saturating_sub(is_computer);
            self.longest = self.longest.max(until(before.at.min(self.stepped_at)));
            self.unsure = if stands { Duration::ZERO } else { self.unsure.max(until(before.at)) };
            *spoke = look;
        }
    }

    /// Returns the longest silence.
    pub(super) fn longest(&self) -> Duration {
        self.longest
    }
}

/// Returns the waits of a process. A process that has ended has none.
pub(super) fn queued(process: u32) -> Waits {
    let Ok(tasks) = fs::read_dir(format!("/proc/{process}/task")) else { return Waits::default() };
    let wait = |task: fs::DirEntry| {
        // Time on a processor, time ready for one, and times it got one (proc(5), schedstat).
        let text = fs::read_to_string(task.path().join("schedstat")).ok()?;
        let queued_ns = text.split_whitespace().nth(1)?.parse().ok()?;
        Some((task.file_name().to_str()?.parse().ok()?, Duration::from_nanos(queued_ns)))
    };
    Waits(tasks.flatten().filter_map(wait).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the waits of threads, in ms.
    fn waits<const N: usize>(ms: [u64; N]) -> Waits {
        Waits((0..).zip(ms.map(Duration::from_millis)).collect())
    }

    const BETWEEN: Duration = Duration::from_millis(10);

    /// Returns the longest silence in ms of a host that speaks at these looks of so many, and waits for a processor for
    /// so many ms of each look. The motor makes a step before each look up to this one.
    fn longest_ms(looks: u32, spoke: &[u32], queued_ms: u64, last_step: u32) -> u128 {
        let mut silences = Silences::default();
        for look in 0..=looks {
            silences.look(Look {
                at: BETWEEN * look,
                uncarried: Duration::ZERO,
                queued: waits([queued_ms * u64::from(look)]),
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
        // From 100 to 180 ms, less 63 ms from the look at the first frame to that at the second.
        assert_eq!(longest_ms(20, &[2, 4, 10, 19], 7, 20), 17);
    }

    #[test]
    fn a_wait_for_a_processor_that_is_told_at_its_end_is_no_silence_of_the_host() {
        let mut silences = Silences::default();
        for (at_ms, queued_ms, has_frame) in
            [(0, 0, true), (150, 0, false), (300, 0, false), (310, 290, true)]
        {
            let (at, queued) = (Duration::from_millis(at_ms), waits([queued_ms]));
            silences.look(Look {
                at,
                queued,
                uncarried: Duration::ZERO,
                has_frame,
                stepped_ns: Some(at_ms as f64),
            });
        }
        assert_eq!(silences.longest().as_millis(), 10);
    }

    #[test]
    fn waits_of_several_threads_at_the_same_time_count_once() {
        let mut silences = Silences::default();
        for (at_ms, queued_ms, has_frame) in
            [(0, [5, 0, 9], true), (290, [65, 60, 69], false), (300, [65, 60, 69], true)]
        {
            let (at, queued) = (Duration::from_millis(at_ms), waits(queued_ms));
            silences.look(Look {
                at,
                queued,
                uncarried: Duration::ZERO,
                has_frame,
                stepped_ns: Some(at_ms as f64),
            });
        }
        assert_eq!(silences.longest().as_millis(), 290 - 60);
    }

    #[test]
    fn time_in_which_the_computer_carries_no_bytes_is_no_silence_of_the_host() {
        let mut silences = Silences::default();
        for (at_ms, uncarried_ms, has_frame) in [(0, 0, true), (500, 480, false), (510, 480, true)] {
            let [at, uncarried] = [at_ms, uncarried_ms].map(Duration::from_millis);
            silences.look(Look {
                at,
                queued: waits([30]),
                uncarried,
                has_frame,
                stepped_ns: Some(at_ms as f64),
            });
        }
        assert_eq!(silences.longest().as_millis(), 20);
    }

    #[test]
    fn a_host_that_never_speaks_again_is_silent_until_the_motors_last_step() {
        let mut silences = Silences::default();
        for (at_ms, stepped_ns) in [(0, Some(0.0)), (400, Some(1.0)), (600, Some(1.0)), (700, None)] {
            let at = Duration::from_millis(at_ms);
            silences.look(Look {
                at,
                queued: Waits::default(),
                uncarried: Duration::ZERO,
                has_frame: at_ms == 0,
                stepped_ns,
            });
        }
        assert_eq!(silences.longest().as_millis(), 400);
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
            silences.look(Look {
                at,
                queued: Waits::default(),
                uncarried: Duration::ZERO,
                has_frame,
                stepped_ns: Some(stepped_ns),
            });
        }
        assert_eq!(silences.longest().as_millis(), 300);
    }
}
