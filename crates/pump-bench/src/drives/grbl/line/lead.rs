//! The line of several axes, by the axis that leads it: one sequence of jogs, with a share of the steps for each.

use std::time::{Duration, Instant};

use super::meeting::{Share, Word};
use crate::drives::grbl::board::Board;
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::jogs::{Follower, Jogs, Task};
use crate::drives::grbl::recovery::Made;
use crate::drives::{Gate, Leave};

/// Longest wait for the leaves of the other axes. They come once those axes have their steps on record. A disk that
/// takes longer stops the line.
const LEAVE: Duration = Duration::from_secs(10);

/// End of a line for one axis.
#[derive(Debug)]
pub(in crate::drives::grbl) struct Ended {
    /// Steps made, or the error with the bounds of the net steps.
    pub(in crate::drives::grbl) result: Result<u64, (GrblError, Made)>,
    /// Last step that was sent.
    pub(in crate::drives::grbl) sent: u64,
    /// Rests before the end.
    pub(in crate::drives::grbl) rests: u32,
}

/// Line of several axes. The first has the most steps, and the jogs are counted in its steps.
#[derive(Debug)]
struct Line {
    axes: Vec<Follower>,
    /// Task of the first axis, on the ramps of the line.
    task: Task,
}

impl Line {
    /// Makes the line of axes, the one with the most steps first. The slowest by its own plan sets the time, and the
    /// ramps are those at which no axis is steeper than its own settings: grbl keeps to them by itself.
    fn of(mut axes: Vec<Follower>) -> Self {
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
    fn ends(
        &self,
        board: &Board,
        outcome: &Result<u64, (GrblError, Made)>,
        sent: u64,
        rests: u32,
    ) -> Vec<Ended> {
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
            Ended { result, sent: axis.share(sent, all), rests }
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

/// Makes the line of `own` axis and those of the `others`. Calls `begins` before the first step is asked for, once
/// nothing can refuse the line any more.
///
/// # Errors
///
/// [`GrblError::Far`] if the line ends beyond the coordinates of an axis. Nothing has moved.
pub(in crate::drives::grbl) fn lead(
    board: &mut Board,
    own: Follower,
    others: &[Share],
    gate: &mut Gate<'_>,
    begins: impl FnOnce(),
) -> Result<Ended, GrblError> {
    // The place of the axis in `others`; none is that of this thread.
    let mut order: Vec<(Option<usize>, Follower)> = vec![(None, own)];
    order.extend(others.iter().enumerate().map(|(place, share)| (Some(place), share.axis)));
    order.sort_by_key(|(_, axis)| std::cmp::Reverse(axis.task.steps));
    let line = Line::of(order.iter().map(|(_, axis)| *axis).collect());
    let (Some(first), followers) = (line.axes.first(), line.axes.get(1..).unwrap_or_default()) else {
        unreachable!("a line has two axes or more")
    };
    line.task.check(&first.scale, followers)?;
    let all = line.task.steps;
    let asked = |axis: &Follower, made: u64, last: u64| {
        let surely = if axis.scale.axis == first.scale.axis { made } else { axis.surely(made, all) };
        (surely, axis.share(last, all))
    };
    let mut ask = |made: u64, last: u64| {
        for (share, axis) in order.iter().filter_map(|(place, axis)| Some((others.get((*place)?)?, axis))) {
            let (made, last) = asked(axis, made, last);
            // An axis that does not hear it does not answer, and that is a stop.
            let _ = share.words.send(Word::MayGo(made, last));
        }
        let (made, last) = asked(&own, made, last);
        let (since, own) = (Instant::now(), gate(made, last));
        others.iter().fold(own, |leave, share| {
            let left = LEAVE.saturating_sub(since.elapsed());
            both(leave, share.leaves.recv_timeout(left).unwrap_or(Leave::Stop))
        })
    };
    begins();
    board.attend_axis(first.scale.axis.number());
    let ends = board.undisturbed(|board| {
        let mut jogs = Jogs::new(board, &first.scale, line.task, followers);
        let outcome = match jogs.run(&mut ask) {
            Ok(()) => Ok(jogs.made),
            Err(error) => Err(jogs.recover(error)),
        };
        let (sent, rests) = (jogs.sent, jogs.rests.count());
        line.ends(board, &outcome, sent, rests)
    });
    let mut own_end = None;
    for (end, (place, _)) in ends.into_iter().zip(&order) {
        match place.and_then(|place| others.get(place)) {
            Some(share) => drop(share.words.send(Word::Ended(end))),
            None => own_end = Some(end),
        }
    }
    let Some(own_end) = own_end else { unreachable!("the line has this axis") };
    Ok(own_end)
}

/// Returns the leave that two gates give together.
fn both(one: Leave, other: Leave) -> Leave {
    match (one, other) {
        (Leave::Stop, _) | (_, Leave::Stop) => Leave::Stop,
        (Leave::Wait, _) | (_, Leave::Wait) => Leave::Wait,
        (Leave::Go, Leave::Go) => Leave::Go,
    }
}
