//! The timetable of a rack: the begin of each step, and the check that no pump is asked for two at once.

use super::lines::{Lines, Part};
use crate::drives::BoardShare;
use crate::rack::error::RackError;
use crate::rack::member::Member;
use crate::rack::step::{Begin, RackStep};

/// Time between two steps in which the second one is planned and announced, in s. A board has room for it, since it is
/// longer than [`GIVEN_S`].
const PLANNING_S: f64 = 0.35;

/// Time before its begin at which a motion is given to a real drive, in s.
pub(in crate::rack) const GIVEN_S: f64 = 0.3;

/// Times of one pump's part of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::rack) struct Timing {
    /// Time of the motion, in s.
    pub(in crate::rack) motion_s: f64,
    /// Time in which the line settles, in s.
    pub(in crate::rack) settle_s: f64,
    /// Planned volume, in mL. Negative in reverse.
    pub(in crate::rack) planned_ml: f64,
    /// Angle of all steps, in rad, positive.
    pub(in crate::rack) turn_rad: f64,
    /// Time of all steps at the fastest speed of the plan, in s. A line takes that of its slowest axis.
    pub(in crate::rack) at_peak_s: f64,
    /// Part of its board that the motion takes. `None` if it takes none, or no board was asked.
    pub(in crate::rack) share: Option<BoardShare>,
}

impl Timing {
    pub(super) fn done_s(self, begin_s: f64) -> f64 {
        begin_s + self.motion_s + self.settle_s
    }
}

/// Times of a rack.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::rack) struct Timetable {
    /// Begin of each step, in s.
    pub(in crate::rack) begins_s: Vec<f64>,
    /// End of the last motion, in s.
    pub(in crate::rack) ends_s: f64,
}

impl Timetable {
    /// Lays out the steps. `timings` are those of each pump's parts in their order.
    ///
    /// # Errors
    ///
    /// [`RackError::TimeGoesBack`] and [`RackError::Overlap`]. [`RackError::Shared`] for axes of a grbl board that are
    /// to move at other times than as one line.
    pub(in crate::rack) fn of(
        steps: &[RackStep],
        members: &[Member],
        timings: &[Vec<Timing>],
    ) -> Result<Self, RackError> {
        let mut left: Vec<_> = timings.iter().map(|timings| timings.iter()).collect();
        // Last step of each pump, with its end.
        let mut done: Vec<Option<(usize, f64)>> = vec![None; members.len()];
        let mut lines = Lines::default();
        let (mut begins_s, mut ends_s, mut settled_s) = (Vec::new(), 0.0_f64, 0.0_f64);
        for (number, step) in (1..).zip(steps) {
            let before_s = begins_s.last().copied().unwrap_or(0.0);
            let begin_s = match step.begin {
                Begin::At { time_s } if time_s < before_s => {
                    return Err(RackError::TimeGoesBack {
                        step: number,
                        at_s: time_s,
                        before: number - 1,
                        before_s,
                    });
                }
                Begin::At { time_s } => time_s,
                Begin::After { time_s } if number == 1 => time_s,
                Begin::After { time_s } => settled_s + PLANNING_S.max(time_s),
            };
            settled_s = begin_s;
            for flow in &step.flows {
                if let Some((before, done_s)) = done[flow.pump].filter(|(_, done_s)| *done_s > begin_s) {
                    let pump = members[flow.pump].name.clone();
                    return Err(RackError::Overlap { pump, step: number, at_s: begin_s, before, done_s });
                }
                let Some(timing) = left[flow.pump].next() else { continue };
                lines.add(members, Part { pump: flow.pump, step: number, begin_s, timing: *timing })?;
                let done_s = timing.done_s(begin_s);
                done[flow.pump] = Some((number, done_s));
                (settled_s, ends_s) = (settled_s.max(done_s), ends_s.max(begin_s + timing.motion_s));
            }
            begins_s.push(begin_s);
        }
        Ok(Self { begins_s, ends_s })
    }
}
