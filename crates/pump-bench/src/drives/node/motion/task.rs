//! The task of a plan for the board, and the check that the board and the link can do it.

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Brake, Ticks};
use pump_link::message::{AxisConfig, Identity};
use pump_link::sender::TooFast;
use pump_link::timing::rate_hz;

use super::asked::{Asked, CUT, LastAsked, LineTo, SHORTER, demand};
use crate::drives::BoardShare;
use crate::drives::node::error::NodeError;
use crate::drives::node::line::Lane;

/// Part of the line's rate that segments may take. The rest is for the state of the axis, which is asked for every
/// 20 ms (some 2 kB/s), and for frames that are sent again.
const SHARE: f64 = 0.8;

/// Bits of a byte on a serial line: 8, a start and a stop.
const BITS: u32 = 10;

/// Part of the line and of the board's steps that a plan may have.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::node) struct Room {
    /// Bytes a second that the segments of all axes may take.
    all_bytes_s: u32,
    /// Bytes a second that the other axes leave.
    free_bytes_s: u32,
    /// Number of axes that share the line.
    sharers: u32,
    /// Steps a second that the other axes leave.
    free_steps_s: u32,
    /// Shortest interval that the pulses of the stepper driver allow, ticks.
    pulse: u64,
}

impl Room {
    /// Returns the part of a line of `baud`, and of the board's steps, that the other axes leave to one with this
    /// configuration.
    pub(in crate::drives::node) fn new<'a>(
        baud: u32,
        board: &Identity,
        config: &AxisConfig,
        others: impl Iterator<Item = &'a Lane>,
    ) -> Self {
        let all_bytes_s = (f64::from(baud / BITS) * SHARE) as u32;
        let mut room = Self {
            all_bytes_s,
            free_bytes_s: all_bytes_s,
            sharers: 1,
            free_steps_s: board.max_step_hz,
            pulse: config.least_interval(board.tick_hz),
        };
        for other in others {
            room.free_bytes_s = room.free_bytes_s.saturating_sub(other.needs_bytes_s);
            room.free_steps_s = room.free_steps_s.saturating_sub(other.needs_steps_s);
            room.sharers += 1;
        }
        room
    }
}

/// Task of a plan for the board.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::node) struct Task {
    /// Shortest interval between two steps, ticks.
    pub(in crate::drives::node) shortest_interval: u32,
    /// Number of axes that share the line in this motion.
    pub(in crate::drives::node) sharers: u32,
    /// Most steps in which the motor stops by its brake.
    pub(in crate::drives::node) brake_steps: u64,
    /// Bytes a second that the plan takes of the line, by no more than a part in 64 of the line too many.
    pub(in crate::drives::node) needs_bytes_s: u32,
    /// Steps a second that the board counts for the plan.
    pub(in crate::drives::node) needs_steps_s: u32,
}

impl Task {
    /// Returns the task of `plan` in its room, or refuses it before anything moves. `last` knows the plan that was
    /// looked at last.
    pub(in crate::drives::node) fn new(
        plan: PlannedMotion<'_>,
        brake: &Brake,
        board: &Identity,
        room: Room,
        last: &LastAsked,
    ) -> Result<Self, NodeError> {
        let Room { all_bytes_s, free_bytes_s, .. } = room;
        let line = LineTo { tick_rate: brake.tick_rate(), queue: board.queue, all_bytes_s };
        let Asked { shortest_interval, bytes_s } = last.of(plan, line)?;
        let needs_steps_s = rate_hz(shortest_interval, board.tick_hz);
        check_steps(plan, shortest_interval, board, room)?;
        let demanded = |bytes_s: u32| demand(plan, line, bytes_s);
        let needs_bytes_s = match bytes_s {
            Some(bytes_s) if bytes_s <= free_bytes_s => bytes_s,
            _ if demanded(free_bytes_s).is_ok() => free_bytes_s,
            _ => return Err(refusal(&demanded, free_bytes_s, all_bytes_s)),
        };
        let fastest = Ticks { whole: shortest_interval.into(), frac: 0 };
        let way = brake.descent(fastest, plan.direction()).map(|segment| u64::from(segment.steps()));
        let (sharers, brake_steps) = (room.sharers, way.sum());
        Ok(Self { shortest_interval, sharers, brake_steps, needs_bytes_s, needs_steps_s })
    }

    /// Returns the part of `board`, and of the line in `room`, that the task takes.
    pub(in crate::drives::node) fn share(&self, board: &Identity, room: Room) -> BoardShare {
        BoardShare {
            steps_s: self.needs_steps_s,
            all_steps_s: board.max_step_hz,
            bytes_s: self.needs_bytes_s,
            all_bytes_s: room.all_bytes_s,
        }
    }
}

/// Returns the most steps a second to which a plan is made for an axis with this configuration, while no other axis
/// moves.
pub(in crate::drives::node) fn most_steps_s(board: &Identity, config: &AxisConfig) -> f64 {
    let least =
        config.least_interval(board.tick_hz).max(board.tick_hz.div_ceil(board.max_step_hz.max(1)).into());
    (f64::from(board.tick_hz) / (least as f64 + as_ticks(SHORTER + CUT))).floor()
}

/// Returns the most whole steps a second of a plan whose intervals are this long, in ticks, or longer.
fn most_of(board: &Identity, interval: u64) -> u32 {
    (f64::from(board.tick_hz) / (interval as f64 + as_ticks(SHORTER))) as u32
}

fn as_ticks(fractions: u128) -> f64 {
    fractions as f64 / 2_f64.powi(32)
}

/// Refuses a plan whose shortest interval, in ticks, is one that the board would refuse.
fn check_steps(
    plan: PlannedMotion<'_>,
    shortest_interval: u32,
    board: &Identity,
    room: Room,
) -> Result<(), NodeError> {
    let steps_s = plan.peak_rad_s() / plan.step_rad();
    let most_beside = |free_steps_s: u32| match free_steps_s {
        0 => 0,
        free_steps_s => most_of(board, board.tick_hz.div_ceil(free_steps_s).into()),
    };
    let (all_s, free_s) = (most_beside(board.max_step_hz), most_beside(room.free_steps_s));
    match rate_hz(shortest_interval, board.tick_hz) {
        rate if rate > board.max_step_hz => Err(NodeError::Fast { steps_s, most_s: all_s }),
        _ if u64::from(shortest_interval) < room.pulse => {
            Err(NodeError::Pulse { steps_s, most_s: most_of(board, room.pulse) })
        }
        rate if rate > room.free_steps_s => Err(NodeError::StepsTaken { steps_s, free_s, all_s }),
        _ => Ok(()),
    }
}

/// Returns the refusal of a plan that needs more than the free part of the line, with the least rate that is enough.
fn refusal(
    demanded: &impl Fn(u32) -> Result<(), NodeError>,
    free_bytes_s: u32,
    all_bytes_s: u32,
) -> NodeError {
    // A queue that is too short for the plan is so at any rate.
    if let Err(error) = demanded(u32::MAX) {
        return error;
    }
    let (mut too_few, mut enough) = (free_bytes_s, free_bytes_s.max(1).saturating_mul(2));
    while demanded(enough).is_err() {
        (too_few, enough) = (enough, enough.saturating_mul(2));
    }
    let needed_bytes_s = least(demanded, too_few, enough, 1);
    if needed_bytes_s <= all_bytes_s {
        return NodeError::LineFull { needed_bytes_s, free_bytes_s, all_bytes_s };
    }
    let (needed_bytes_s, allowed_bytes_s) = (needed_bytes_s.into(), all_bytes_s.into());
    TooFast::Link { needed_bytes_s, allowed_bytes_s }.into()
}

/// Returns a rate between one that is too low and one that is enough: it is enough, and by no more than `within`
/// above the least that is. All are bytes a second.
fn least(
    demanded: &impl Fn(u32) -> Result<(), NodeError>,
    mut too_few: u32,
    mut enough: u32,
    within: u32,
) -> u32 {
    while enough - too_few > within.max(1) {
        let middle = too_few + (enough - too_few) / 2;
        let bound = if demanded(middle).is_ok() { &mut enough } else { &mut too_few };
        *bound = middle;
    }
    enough
}
