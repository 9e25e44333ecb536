//! The steps of a motion by jogs, with their speeds and the lines that ask for them.

use std::time::Duration;

use libm::hypot;

use super::Follower;
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::scale::Scale;

/// Time at the cruise that is sent ahead of the motor, beyond the way in which it stops, in s: ten polls.
const AHEAD_S: f64 = 0.5;

/// Number of jogs that are sent ahead. grbl plans 15 ahead.
const JOGS_AHEAD: f64 = 8.0;

/// Time without a step after which a board is stopped, in s, beyond twice the time of its next step.
const STALL_S: f64 = 2.0;

/// Steps to make, with their speeds.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::grbl) struct Task {
    /// Count before the first step.
    pub(in crate::drives::grbl) start: i64,
    /// Direction of the count: 1 if it rises, -1 if it falls.
    pub(in crate::drives::grbl) direction: i64,
    /// Steps in all.
    pub(in crate::drives::grbl) steps: u64,
    /// Steps per second at the cruise.
    pub(in crate::drives::grbl) steps_s: f64,
    /// Steps per second² of the board's ramps.
    pub(in crate::drives::grbl) steps_s2: f64,
    /// Most steps per second of the board.
    pub(in crate::drives::grbl) most_steps_s: f64,
}

impl Task {
    /// Returns the count after `made` steps.
    pub(in crate::drives::grbl) fn count_after(&self, made: u64) -> i64 {
        self.start + self.direction * made as i64
    }

    /// Returns the line that jogs to the end of step `last`, with the axes that follow. `None` if an axis has no
    /// coordinate for it. The feed is the speed along the line, as grbl takes it.
    pub(super) fn line(&self, scale: &Scale, followers: &[Follower], last: u64) -> Option<String> {
        let mut words = format!("{}{}", scale.axis.letter(), scale.text(self.count_after(last))?);
        let mut units_s = self.steps_s / scale.steps_per_unit;
        for follower in followers {
            words += &follower.word(last, self.steps)?;
            units_s = hypot(units_s, follower.units_s());
        }
        Some(format!("$J=G53G90G21{words}F{}", feed_text(units_s * 60.0)))
    }

    /// Returns the number of steps to send ahead of the motor.
    pub(super) fn ahead(&self) -> u64 {
        let stop = self.steps_s * self.steps_s / (2.0 * self.steps_s2);
        ((stop + AHEAD_S * self.steps_s).ceil() as u64).max(2)
    }

    /// Returns the number of steps of a jog.
    pub(super) fn jog(&self) -> u64 {
        ((self.ahead() as f64 / JOGS_AHEAD).ceil() as u64).max(1)
    }

    /// Returns the last step of the jog after step `sent`. No jog is shorter than half of the others.
    pub(super) fn next_end(&self, sent: u64) -> u64 {
        let jog = self.jog();
        if self.steps - sent < jog + jog / 2 { self.steps } else { sent + jog }
    }

    /// Checks that every jog of the task ends on a step, before anything moves.
    pub(in crate::drives::grbl) fn check(
        &self,
        scale: &Scale,
        followers: &[Follower],
    ) -> Result<(), GrblError> {
        let mut sent = 0;
        while sent < self.steps {
            sent = self.next_end(sent);
            let count = self.count_after(sent);
            if count.abs() > scale.most_count() || self.line(scale, followers, sent).is_none() {
                return Err(GrblError::Far { count, most: scale.most_count() });
            }
        }
        Ok(())
    }

    /// Returns the time that the motion needs at the board's own ramps, in s.
    pub(super) fn needs_s(&self) -> f64 {
        self.steps as f64 / self.steps_s + self.steps_s / self.steps_s2
    }

    /// Returns the time that the watchdog waits for a step.
    pub(super) fn patience(&self) -> Duration {
        let step_s = 1.0 / self.steps_s + (2.0 / self.steps_s2).sqrt();
        Duration::from_secs_f64(STALL_S + 2.0 * step_s)
    }
}

/// Formats a feed in units/min with at most eight digits, the most that grbl reads.
pub(in crate::drives::grbl) fn feed_text(units_min: f64) -> String {
    let whole = units_min.max(1.0).log10() as usize + 1;
    format!("{units_min:.*}", 7_usize.saturating_sub(whole).min(6))
}
