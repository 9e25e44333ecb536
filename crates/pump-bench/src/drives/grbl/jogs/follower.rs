//! The axes that follow the one that leads a sequence of jogs: all move on one line, each by its share of the steps.

use super::Task;
use crate::drives::grbl::board::Board;
use crate::drives::grbl::scale::Scale;

/// Farthest distance of a follower from the line in a report, in steps: half a step by the rounding of a jog's end, one
/// by the board's own steps on the way, and one by a report that is made between the steps of two axes.
const OFF_LINE: i64 = 3;

/// Axis that follows. Its task has the steps of its whole share.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::grbl) struct Follower {
    pub(in crate::drives::grbl) scale: Scale,
    pub(in crate::drives::grbl) task: Task,
}

impl Follower {
    /// Returns the steps of this axis once the leading one has made `made` of its `all` steps.
    pub(in crate::drives::grbl) fn share(&self, made: u64, all: u64) -> u64 {
        let (made, all) = (u128::from(made), u128::from(all.max(1)));
        ((2 * made * u128::from(self.task.steps) + all) / (2 * all)) as u64
    }

    /// Returns the steps that this axis has surely made once the leading one has made `made` of its `all` steps.
    pub(in crate::drives::grbl) fn surely(&self, made: u64, all: u64) -> u64 {
        self.share(made, all).saturating_sub(OFF_LINE.unsigned_abs())
    }

    /// Returns the bounds of the net steps of this axis, by those of the leading one.
    pub(in crate::drives::grbl) fn bounds(&self, least: i64, most: i64, all: u64) -> (i64, i64) {
        let part = self.task.steps as f64 / all.max(1) as f64;
        let (least, most) = ((least as f64 * part).floor() as i64, (most as f64 * part).ceil() as i64);
        (least - OFF_LINE, most + OFF_LINE)
    }

    /// Returns the word of this axis in the jog that takes the leading one to step `last` of `all`.
    pub(super) fn word(&self, last: u64, all: u64) -> Option<String> {
        let count = self.task.count_after(self.share(last, all));
        let text = self.scale.text(count).filter(|_| count.abs() <= self.scale.most_count())?;
        Some(format!("{}{text}", self.scale.axis.letter()))
    }

    /// Returns the speed of the axis in its units, in 1/s.
    pub(super) fn units_s(&self) -> f64 {
        self.task.steps_s / self.scale.steps_per_unit
    }

    /// Returns the net steps of this axis by the board's last report. `None` if that tells none.
    pub(in crate::drives::grbl) fn net(&self, board: &Board) -> Option<i64> {
        let place = board.place_of(self.scale.axis.number())?;
        Some((self.scale.count(self.scale.reported_mm(place)) - self.task.start) * self.task.direction)
    }

    /// Returns true if the axis is on the line by the board's last report.
    pub(in crate::drives::grbl) fn is_on_line(&self, board: &Board, made: u64, all: u64) -> bool {
        let due = self.share(made, all) as i64;
        self.net(board).is_none_or(|net| net.abs_diff(due) <= OFF_LINE.unsigned_abs())
    }

    /// Returns true if the axis stands at its share by the board's last report.
    pub(super) fn has_arrived(&self, board: &Board, made: u64, all: u64) -> bool {
        self.net(board).is_none_or(|net| net == self.share(made, all) as i64)
    }
}
