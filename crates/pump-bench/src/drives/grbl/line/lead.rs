//! The motion of a line by the axis that leads it. The others give their leave before each jog.

use std::time::{Duration, Instant};

use super::line::{AxisEnd, Line};
use super::meeting::{Share, Word};
use crate::drives::grbl::board::Board;
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::jogs::{Follower, Jogs};
use crate::drives::{BeginPlace, Gate, Leave};

/// Longest wait for the leaves of the other axes. They come once those axes have their steps on record. A disk that
/// takes longer stops the line.
const LEAVE: Duration = Duration::from_secs(10);

/// Makes the line of `own` axis and those of the `others`, whose places are at the meeting of `place`.
///
/// # Errors
///
/// [`GrblError::Far`] if the line ends beyond the coordinates of an axis. Nothing has moved.
pub(in crate::drives::grbl) fn lead(
    board: &mut Board,
    own: Follower,
    others: &[Share],
    gate: &mut Gate<'_>,
    place: &mut BeginPlace,
) -> Result<AxisEnd, GrblError> {
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
    // Nothing refuses the line any more.
    place.has_begun();
    board.attend_axis(first.scale.axis.number());
    let ends = board.undisturbed(|board| {
        let mut jogs = Jogs::new(board, &first.scale, line.task, followers);
        let outcome = match jogs.run(&mut ask) {
            Ok(()) => Ok(jogs.made),
            Err(error) => Err(jogs.recover(error)),
        };
        let (sent, rests) = (jogs.sent, jogs.rests.count());
        if sent > 0 {
            place.note_told();
        }
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
