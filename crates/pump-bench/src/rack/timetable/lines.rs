//! The lines of a rack: parts of pumps on one grbl board begin and end together, or one after another.

use super::timetable::Timing;
use crate::rack::error::RackError;
use crate::rack::member::Member;
use crate::rack::sharing::{is_one_line, not_one_line};

/// Largest part of its time by which a dose may be longer than another that begins with it. On a line both take the
/// time of the longer one. Ramps and pulsation make doses of one time differ by a part of a pitch of the rollers. The
/// shares of a ratio may differ by more, since they are asked to go together.
const LONGER: f64 = 0.2;

/// Part of a step that one pump runs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) pump: usize,
    /// Number of the step, from 1.
    pub(super) step: usize,
    pub(super) begin_s: f64,
    pub(super) timing: Timing,
}

/// Parts of a rack so far.
#[derive(Debug, Default)]
pub(super) struct Lines(Vec<Part>);

impl Lines {
    /// Adds a part.
    ///
    /// # Errors
    ///
    /// [`RackError::Shared`] if another axis of its grbl board moves then, and not on one line with it.
    pub(super) fn add(&mut self, members: &[Member], part: Part) -> Result<(), RackError> {
        for other in &self.0 {
            let (one, two) = (&members[other.pump], &members[part.pump]);
            if other.pump == part.pump || !is_one_line(&one.bench, &two.bench) {
                continue;
            }
            if let Some(why) = apart(other, &part) {
                return Err(not_one_line(one, two, &why));
            }
        }
        self.0.push(part);
        Ok(())
    }
}

/// Returns the reason why two parts are not on one line although they overlap. `other` begins first.
fn apart(other: &Part, part: &Part) -> Option<String> {
    let done_s = other.timing.done_s(other.begin_s);
    if other.begin_s != part.begin_s {
        let overlaps = part.begin_s < done_s;
        return overlaps.then(|| {
            format!(
                "step {} begins at {:.3} s, while step {} is under way until its line has settled at {done_s:.3} s",
                part.step, part.begin_s, other.step
            )
        });
    }
    let (one_s, two_s) = (other.timing.motion_s, part.timing.motion_s);
    let differ = (one_s - two_s).abs() > LONGER * one_s.max(two_s);
    (differ && other.step != part.step).then(|| {
        format!(
            "steps {} and {} begin together and take {one_s:.3} s and {two_s:.3} s",
            other.step, part.step
        )
    })
}
