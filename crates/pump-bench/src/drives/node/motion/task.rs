//! The task of a plan for the board, and the check that the board and the link can do it.

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Brake, Segment, TickRate, Ticks};
use pump_link::message::{AxisConfig, Identity, PROMPT_PACKED};
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, Rounder};
use pump_link::sender::{Demand, FRAME_OVERHEAD, StreamError, TooFast};
use pump_link::timing::rate_hz;

use super::walk::{LeftOut, Walk};
use crate::drives::BoardShare;
use crate::drives::node::error::NodeError;
use crate::drives::node::line::Lane;

/// Part of the line's rate that segments may take. The rest is for the state of the axis, which is asked for every
/// 20 ms (some 2 kB/s), and for frames that are sent again.
const SHARE: f64 = 0.8;

/// Bits of a byte on a serial line: 8, a start and a stop.
const BITS: u32 = 10;

/// Most by which an interval that is sent is shorter than the plan's, 2^-32 tick: a quarter of a tick. The rounding of
/// segments takes less than a sixth, and the gathering of steps after a pause a sixteenth ([`super::steps`]).
const SHORTER: u128 = 1 << 30;

/// Most by which a segment of a plan is faster than the plan's speed, 2^-32 tick: an eighth of a tick. Its parabola
/// keeps the steps to their times, and the intervals at its ends may be some shorter. 0.06 tick were seen.
const CUT: u128 = 1 << 29;

/// Part of the rate that a long cruise needs beyond its mean, for turns that need more than those that were looked at.
const SPARE: u64 = 32;

/// Number of halvings by which the rate is found that a plan takes of the line.
const HALVINGS: u32 = 6;

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
    /// Bytes a second that the plan takes of the line, by no more than a part in 64 of the free part too many.
    pub(in crate::drives::node) needs_bytes_s: u32,
    /// Steps a second that the board counts for the plan.
    pub(in crate::drives::node) needs_steps_s: u32,
}

impl Task {
    /// Returns the task of `plan` in its room, or refuses it before anything moves.
    pub(in crate::drives::node) fn new(
        plan: PlannedMotion<'_>,
        brake: &Brake,
        board: &Identity,
        room: Room,
    ) -> Result<Self, NodeError> {
        let tick_rate = brake.tick_rate();
        let shortest_interval = shortest_interval(plan, tick_rate);
        let needs_steps_s = rate_hz(shortest_interval, board.tick_hz);
        check_steps(plan, shortest_interval, board, room)?;
        let demanded = |bytes_s: u32| match board.queue {
            256.. => demand::<256>(plan, tick_rate, bytes_s),
            128.. => demand::<128>(plan, tick_rate, bytes_s),
            64.. => demand::<64>(plan, tick_rate, bytes_s),
            _ => demand::<16>(plan, tick_rate, bytes_s),
        };
        let Room { all_bytes_s, free_bytes_s, .. } = room;
        if demanded(free_bytes_s).is_err() {
            return Err(refusal(&demanded, free_bytes_s, all_bytes_s));
        }
        let needs_bytes_s = least(&demanded, 0, free_bytes_s, free_bytes_s >> HALVINGS);
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

/// Returns the shortest interval of two steps that the board is told, whole ticks. No segment of the plan is faster,
/// however it is cut and rounded.
fn shortest_interval(plan: PlannedMotion<'_>, tick_rate: TickRate) -> u32 {
    let fractions = |Ticks { whole, frac }: Ticks| (u128::from(whole) << 32) | u128::from(frac);
    let ends = |segment: Segment| [1, segment.steps()].map(|step| fractions(segment.interval_before(step)));
    let walked = Walk::new(plan, tick_rate).flat_map(|(_, segment)| ends(segment)).min().unwrap_or(0);
    // Segments that the walk leaves out are no faster than the plan is anywhere.
    let at_peak = LeftOut::of(plan).map_or(u128::MAX, |_| {
        let ticks = f64::from(tick_rate.hz()) * plan.step_rad() / plan.peak_rad_s();
        ((ticks * 2_f64.powi(32)) as u128).saturating_sub(CUT)
    });
    let shortest = walked.min(at_peak);
    u32::try_from(shortest.saturating_sub(SHORTER) >> 32).unwrap_or(u32::MAX).max(1)
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

/// Checks that the segments of `plan` reach a queue of `Q` segments in time over so many bytes a second.
fn demand<const Q: usize>(
    plan: PlannedMotion<'_>,
    tick_rate: TickRate,
    bytes_s: u32,
) -> Result<(), NodeError> {
    let mut demand = Demand::<Q>::new(tick_rate.hz(), bytes_s);
    let (mut rounder, mut codec) = (Rounder::default(), Codec::new(Grain::Fine));
    let left_out = LeftOut::of(plan);
    let (mut told_bytes, mut told_ticks) = (0, 0);
    for (made, segment) in Walk::new(plan, tick_rate) {
        let segment = rounder.round(segment).map_err(StreamError::Pack)?;
        let mut bytes = [0; MAX_PACKED_SEGMENT];
        let mut room = &mut bytes[..];
        codec.write(&segment, &mut room).map_err(StreamError::Pack)?;
        let used = MAX_PACKED_SEGMENT - room.len();
        // Each segment takes its share of the frame around it.
        let bytes = used + (used * FRAME_OVERHEAD).div_ceil(PROMPT_PACKED);
        demand.segment(&segment, bytes as u32).map_err(|error: TooFast| NodeError::from(error))?;
        if left_out.as_ref().is_some_and(|left_out| left_out.told.contains(&made)) {
            told_bytes += bytes as u64;
            told_ticks += segment.duration().whole;
        }
    }
    // A cruise that needs a little more than the line carries comes too late only after many turns.
    let mean_bytes_s = (told_bytes * u64::from(tick_rate.hz())).div_ceil(told_ticks.max(1));
    let needed_bytes_s = mean_bytes_s + mean_bytes_s / SPARE;
    let allowed_bytes_s = u64::from(bytes_s);
    if needed_bytes_s > allowed_bytes_s {
        return Err(TooFast::Link { needed_bytes_s, allowed_bytes_s }.into());
    }
    Ok(())
}
