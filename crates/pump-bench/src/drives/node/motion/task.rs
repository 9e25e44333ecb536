//! The task of a plan for the board, and the check that the board and the link can do it.

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Brake, Segment, TickRate, Ticks};
use pump_link::message::{Identity, MAX_PACKED};
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, Rounder};
use pump_link::sender::{Demand, FRAME_OVERHEAD, StreamError, TooFast};

use crate::drives::node::error::NodeError;
use crate::drives::node::line::Lane;

/// Part of the line's rate that segments may take. The rest is for the state of the axis, which is asked for every
/// 20 ms (some 2 kB/s), and for frames that are sent again.
const SHARE: f64 = 0.8;

/// Bits of a byte on a serial line: 8, a start and a stop.
const BITS: u32 = 10;

/// Part of the shortest interval of the plan that the board is told. Steps after a pause, and the rounding of
/// segments, are no faster than the plan by more than the rest.
const INTERVAL_SHARE: f64 = 0.98;

/// Number of halvings by which the rate is found that a plan takes of the line.
const HALVINGS: u32 = 6;

/// Part of the line that a plan may have.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::node) struct LineRoom {
    /// Bytes a second that the segments of all axes may take.
    all_bytes_s: u32,
    /// Bytes a second that the other axes leave.
    free_bytes_s: u32,
    /// Number of axes that share the line.
    sharers: u32,
}

impl LineRoom {
    /// Returns the part of a line of `baud` that the other axes leave.
    pub(in crate::drives::node) fn new<'a>(baud: u32, others: impl Iterator<Item = &'a Lane>) -> Self {
        let all_bytes_s = (f64::from(baud / BITS) * SHARE) as u32;
        let mut room = Self { all_bytes_s, free_bytes_s: all_bytes_s, sharers: 1 };
        for other in others {
            room.free_bytes_s = room.free_bytes_s.saturating_sub(other.needs_bytes_s);
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
    /// Bytes a second that the plan takes of the line, by no more than a part in 64 of the free part too many.
    pub(in crate::drives::node) needs_bytes_s: u32,
}

impl Task {
    /// Returns the task of `plan` on its part of the line, or refuses it before anything moves.
    pub(in crate::drives::node) fn new(
        plan: PlannedMotion<'_>,
        brake: &Brake,
        board: &Identity,
        room: LineRoom,
    ) -> Result<Self, NodeError> {
        let tick_rate = brake.tick_rate();
        let steps_s = plan.peak_rad_s() / plan.step_rad();
        if steps_s > f64::from(board.max_step_hz) {
            return Err(NodeError::Fast { steps_s, most_s: board.max_step_hz });
        }
        let demanded = |bytes_s: u32| match board.queue {
            256.. => demand::<256>(plan, tick_rate, bytes_s),
            128.. => demand::<128>(plan, tick_rate, bytes_s),
            64.. => demand::<64>(plan, tick_rate, bytes_s),
            _ => demand::<16>(plan, tick_rate, bytes_s),
        };
        let LineRoom { all_bytes_s, free_bytes_s, .. } = room;
        if demanded(free_bytes_s).is_err() {
            return Err(refusal(&demanded, free_bytes_s, all_bytes_s));
        }
        let needs_bytes_s = least(&demanded, 0, free_bytes_s, free_bytes_s >> HALVINGS);
        let ends = |segment: Segment| {
            segment.interval_before(1).whole.min(segment.interval_before(segment.steps()).whole)
        };
        let shortest = plan.segments(tick_rate).map(ends).min().unwrap_or(1) as f64 * INTERVAL_SHARE;
        let shortest_interval = (shortest as u32).max(1);
        let fastest = Ticks { whole: shortest_interval.into(), frac: 0 };
        let way = brake.descent(fastest, plan.direction()).map(|segment| u64::from(segment.steps()));
        Ok(Self { shortest_interval, sharers: room.sharers, brake_steps: way.sum(), needs_bytes_s })
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

/// Checks that the segments of `plan` reach a queue of `Q` segments in time over so many bytes a second.
fn demand<const Q: usize>(
    plan: PlannedMotion<'_>,
    tick_rate: TickRate,
    bytes_s: u32,
) -> Result<(), NodeError> {
    let mut demand = Demand::<Q>::new(tick_rate.hz(), bytes_s);
    let (mut rounder, mut codec) = (Rounder::default(), Codec::new(Grain::Fine));
    for segment in plan.segments(tick_rate) {
        let segment = rounder.round(segment).map_err(StreamError::Pack)?;
        let mut bytes = [0; MAX_PACKED_SEGMENT];
        let mut room = &mut bytes[..];
        codec.write(&segment, &mut room).map_err(StreamError::Pack)?;
        let used = MAX_PACKED_SEGMENT - room.len();
        // Each segment takes its share of the frame around it.
        let bytes = used + (used * FRAME_OVERHEAD).div_ceil(MAX_PACKED);
        demand.segment(&segment, bytes as u32).map_err(|error: TooFast| NodeError::from(error))?;
    }
    Ok(())
}
