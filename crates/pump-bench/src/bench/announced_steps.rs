//! The steps of a motion that the disk has announced, and the leave for them.

use std::time::{Duration, Instant};

use super::stretches::{AnnouncedStretches, Stretch};
use crate::drives::Leave;
use crate::record::{Announcer, Entry, JournalError};

/// Longest wait for the disk before the drive is told to wait.
const PATIENCE: Duration = Duration::from_millis(5);

/// Longest wait for one announcement. A disk that takes longer is a fault.
const LONGEST: Duration = Duration::from_secs(30);

/// Reason for which a motion may not go on.
#[derive(Debug)]
pub(super) enum Halt {
    /// The next stretch cannot be recorded.
    Unwritten(JournalError),
    /// The next stretch is not recorded in time.
    Late,
}

/// Begin of a motion, and the times that the disk took meanwhile.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DiskTimes {
    /// Instant of the first leave.
    left_at: Option<Instant>,
    /// Steps that the drive said first to be made, and the instant at which it did.
    first_made: Option<(u64, Instant)>,
    /// Longest time that the disk took for an announcement.
    pub(super) slowest: Duration,
    /// Number of times that the motor paused for the disk.
    pub(super) pauses: u8,
}

impl DiskTimes {
    /// Returns the time since the motor began to turn, in s. A drive may wait for others once it has leave, so the time
    /// counts from the first steps that it says are made, and from the plan's time of those, `time_of` in s.
    pub(super) fn took_s(&self, time_of: impl Fn(u64) -> f64) -> f64 {
        let Some(left_at) = self.left_at else { return 0.0 };
        let all_s = left_at.elapsed().as_secs_f64();
        self.first_made.map_or(all_s, |(made, at)| all_s.min(time_of(made) + at.elapsed().as_secs_f64()))
    }
}

/// Announced steps of a motion under way. No step beyond them gets leave.
#[derive(Debug)]
pub(super) struct AnnouncedSteps<'a> {
    stretches: AnnouncedStretches<'a>,
    announcer: &'a Announcer,
    /// Last step of the stretch that the disk has.
    pub(super) end: u64,
    /// Stretch that the disk is to have next, and the instant at which it was given to the journal.
    asked: Option<(Stretch, Instant)>,
    /// Last step that has leave.
    left: u64,
    /// True while the motor pauses, or decelerates to a pause.
    pausing: bool,
    /// True if the motor may pause for the disk.
    may_pause: bool,
    pub(super) disk_times: DiskTimes,
    /// Reason for which no step has leave any more.
    pub(super) halt: Option<Halt>,
}

impl<'a> AnnouncedSteps<'a> {
    /// Begins with no step announced. A motor that may not pause stops for good where it would.
    pub(super) fn new(stretches: AnnouncedStretches<'a>, announcer: &'a Announcer, may_pause: bool) -> Self {
        Self {
            stretches,
            announcer,
            end: 0,
            asked: None,
            left: 0,
            pausing: false,
            may_pause,
            disk_times: DiskTimes::default(),
            halt: None,
        }
    }

    /// Tells if the steps up to `about_to` may be made once `made` are made. Announces further steps when it
    /// is time.
    pub(super) fn leave(&mut self, made: u64, about_to: u64) -> Leave {
        if made > 0 {
            self.disk_times.first_made.get_or_insert_with(|| (made, Instant::now()));
        }
        self.hear(Duration::ZERO);
        self.ask(made, about_to);
        if about_to > self.end {
            self.hear(PATIENCE);
        }
        if self.halt.is_some() {
            return Leave::Stop;
        }
        if about_to > self.end {
            return self.wait(made);
        }
        if about_to > self.left {
            self.left = about_to;
            self.pausing = false;
        }
        if self.left > 0 {
            self.disk_times.left_at.get_or_insert_with(Instant::now);
        }
        Leave::Go
    }

    /// Gives the next stretch to the journal if it is due and the disk is free.
    fn ask(&mut self, made: u64, about_to: u64) {
        if self.asked.is_none()
            && let Some(stretch) = self.stretches.due(made, about_to, self.end)
        {
            self.announcer.announce(Entry::Progress { made, may: stretch.may });
            self.asked = Some((stretch, Instant::now()));
        }
    }

    /// Takes in the news from the disk.
    fn hear(&mut self, wait: Duration) {
        let Some((stretch, since)) = self.asked else { return };
        match self.announcer.told(wait) {
            Some(Ok(took)) => {
                self.end = stretch.end;
                self.asked = None;
                self.disk_times.slowest = self.disk_times.slowest.max(took);
            }
            Some(Err(error)) => self.halt = Some(Halt::Unwritten(error)),
            None if since.elapsed() > LONGEST => {
                self.disk_times.slowest = since.elapsed();
                self.halt = Some(Halt::Late);
            }
            None => {}
        }
    }

    /// Has the drive wait. A motor with no more steps ahead than its stop needs begins to pause.
    fn wait(&mut self, made: u64) -> Leave {
        let pauses = self.stretches.real && self.left > 0 && self.left <= made + self.stretches.stop;
        if pauses && !self.pausing {
            self.pausing = true;
            self.disk_times.pauses = self.disk_times.pauses.saturating_add(1);
            if !self.may_pause {
                let since = self.asked.map_or(Duration::ZERO, |(_, since)| since.elapsed());
                self.disk_times.slowest = self.disk_times.slowest.max(since);
                self.halt = Some(Halt::Late);
                return Leave::Stop;
            }
        }
        Leave::Wait
    }
}
