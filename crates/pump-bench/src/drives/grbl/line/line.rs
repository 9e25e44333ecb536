//! A line of several axes: one sequence of jogs, with a share of the steps for each.

use crate::drives::grbl::board::Board;
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::jogs::{Follower, Task};
use crate::drives::grbl::recovery::Made;

/// End of a line for one axis.
#[derive(Debug)]
pub(in crate::drives::grbl) struct AxisEnd {
    /// Steps made, or the error with the bounds of the net steps.
    pub(in crate::drives::grbl) result: Result<u64, (GrblError, Made)>,
    /// Last step that was sent.
    pub(in crate::drives::grbl) sent: u64,
    /// Rests before the end.
    pub(in crate::drives::grbl) rests: u32,
}

/// Line of several axes. The first has the most steps, and the jogs are counted in its steps.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) axes: Vec<Follower>,
    /// Task of the first axis, on the ramps of the line.
    pub(super) task: Task,
}

impl Line {
    /// Makes the line of axes, the one with the most steps first. The slowest by its own plan sets the time, and the
    /// ramps are those at which no axis is steeper than its own settings: grbl keeps to them by itself.
    pub(super) fn of(mut axes: Vec<Follower>) -> Self {
        let Some(first) = axes.first().copied() else { unreachable!("a line has two axes or more") };
        let all = first.task.steps.max(1) as f64;
        let time_s = axes.iter().map(|axis| axis.task.steps as f64 / axis.task.steps_s).fold(0.0, f64::max);
        let mut task = first.task;
        for axis in &mut axes {
            let steps = axis.task.steps as f64;
            if time_s > 0.0 {
                axis.task.steps_s = steps / time_s;
            }
            if steps > 0.0 {
                task.steps_s2 = task.steps_s2.min(axis.task.steps_s2 * all / steps);
                task.most_steps_s = task.most_steps_s.min(axis.task.most_steps_s * all / steps);
            }
        }
        task.steps_s = axes.first().map_or(task.steps_s, |axis| axis.task.steps_s);
        Self { axes, task }
    }

    /// Returns the end of the line for each axis, by that of the first.
    pub(super) fn ends(
        &self,
        board: &Board,
        outcome: &Result<u64, (GrblError, Made)>,
        sent: u64,
        rests: u32,
    ) -> Vec<AxisEnd> {
        let all = self.task.steps;
        let of = |(number, axis): (usize, &Follower)| {
            let result = match outcome {
                _ if number == 0 => outcome.clone(),
                Ok(0) if sent == 0 => Ok(0),
                Ok(made) => {
                    let net = axis.net(board).and_then(|net| u64::try_from(net).ok());
                    Ok(net.unwrap_or(axis.share(*made, all)))
                }
                Err((error, made)) => Err((error.clone(), self.made(board, axis, *made, sent))),
            };
            AxisEnd { result, sent: axis.share(sent, all), rests }
        };
        self.axes.iter().enumerate().map(of).collect()
    }

    /// Returns the bounds of the steps of a follower after a fault, by those of the first axis. The board's own count
    /// tells them where it is on the line.
    fn made(&self, board: &Board, axis: &Follower, first: Made, sent: u64) -> Made {
        let all = self.task.steps;
        if sent == 0 && first.known() == Some(0) {
            return first;
        }
        if let Some(net) = first.known().and_then(|net| u64::try_from(net).ok())
            && axis.is_on_line(board, net, all)
            && let Some(net) = axis.net(board)
        {
            return Made::exactly(net);
        }
        let (least, most) = axis.bounds(first.least, first.most, all);
        // No step is made that was not sent, unless the motor went astray.
        let least = if first.least >= 0 { least.max(0) } else { least };
        let most = if first.most <= sent as i64 { most.min(axis.share(sent, all) as i64) } else { most };
        let (least, most) = (least.min(most), most);
        // A follower that left the line by itself, as by a pendant, stands where its own count says. An axis that leads
        // at a known place has been read at rest; otherwise a count on the line may be an old one.
        let is_read = first.known().is_some();
        let astray = axis.net(board).filter(|net| !(least..=most).contains(net));
        match astray.filter(|net| is_read || *net > most || *net < 0) {
            Some(net) => Made { least: least.min(net), most: most.max(net), lost: true },
            None => Made { least, most, lost: first.lost },
        }
    }
}
