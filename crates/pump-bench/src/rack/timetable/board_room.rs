//! The room of a board: axes that run at once share its steps and the line to it, which are added up before the first
//! one moves.

use super::timetable::{GIVEN_S, Timetable, Timing};
use crate::drives::BoardShare;
use crate::rack::error::RackError;
use crate::rack::rack::Rack;
use crate::rack::sharing::is_one_board;

/// Part of a pump that takes a part of its board, from the time at which it is given to the board on.
struct Taker {
    pump: usize,
    /// Number of the step, from 1.
    step: usize,
    given_s: f64,
    end_s: f64,
    share: BoardShare,
}

/// Refuses the first parts that together take more than their board has.
///
/// # Errors
///
/// [`RackError::BoardFull`].
pub(in crate::rack) fn check_boards(
    rack: &Rack,
    timetable: &Timetable,
    timings: &[Vec<Timing>],
) -> Result<(), RackError> {
    let takers = takers(rack, timetable, timings);
    let members = rack.members();
    // The most is taken at a time at which a part begins.
    for begins in &takers {
        let at_once: Vec<&Taker> = takers
            .iter()
            .filter(|taker| (taker.given_s..taker.end_s).contains(&begins.given_s))
            .filter(|taker| is_one_board(&members[taker.pump].bench, &members[begins.pump].bench))
            // A pump gives the part before back when it begins another one.
            .filter(|taker| taker.pump != begins.pump || taker.step == begins.step)
            .collect();
        let full = |of: fn(&BoardShare) -> u32, all: u32, unit| {
            let needed = at_once.iter().map(|taker| u64::from(of(&taker.share))).sum::<u64>();
            (needed > all.into()).then(|| RackError::BoardFull {
                port: members[begins.pump].bench.board_port().map(ToOwned::to_owned).unwrap_or_default(),
                pumps: at_once.iter().map(|taker| named(rack, taker, of(&taker.share))).collect(),
                needed,
                all,
                unit,
            })
        };
        let BoardShare { all_steps_s, all_bytes_s, .. } = begins.share;
        let refused = full(|share| share.steps_s, all_steps_s, "steps/s")
            .or_else(|| full(|share| share.bytes_s, all_bytes_s, "bytes/s of the line"));
        refused.map_or(Ok(()), Err)?;
    }
    Ok(())
}

/// Returns the parts that take a part of a board, in the order of their begins.
fn takers(rack: &Rack, timetable: &Timetable, timings: &[Vec<Timing>]) -> Vec<Taker> {
    let mut takers = Vec::new();
    for (pump, timings) in timings.iter().enumerate() {
        for (step, timing) in rack.parts(pump).zip(timings) {
            let begin_s = timetable.begins_s[step];
            takers.extend(timing.share.map(|share| Taker {
                pump,
                step: step + 1,
                given_s: begin_s - GIVEN_S,
                end_s: begin_s + timing.motion_s,
                share,
            }));
        }
    }
    takers.sort_by(|one, two| one.given_s.total_cmp(&two.given_s));
    takers
}

/// Returns the name of a pump with its step and its part of the board, for a message.
fn named(rack: &Rack, taker: &Taker, taken: u32) -> String {
    format!("`{}` in step {} {taken}", rack.members()[taker.pump].name, taker.step)
}
