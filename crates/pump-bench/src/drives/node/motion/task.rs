//! The task of a plan for the board, and the check that the board and the link can do it.

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Brake, Segment, TickRate, Ticks};
use pump_link::message::{Identity, MAX_PACKED};
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, Rounder};
use pump_link::sender::{Demand, FRAME_OVERHEAD, StreamError, TooFast};

use crate::drives::node::error::NodeError;

/// Part of the line's rate that segments may take. The rest is for the state of the axis, which is asked for every
/// 20 ms (some 2 kB/s), and for frames that are sent again.
const SHARE: f64 = 0.8;

/// Bits of a byte on a serial line: 8, a start and a stop.
const BITS: u32 = 10;

/// Part of the shortest interval of the plan that the board is told. Steps after a pause, and the rounding of
/// segments, are no faster than the plan by more than the rest.
const INTERVAL_SHARE: f64 = 0.98;

/// Task of a plan for the board.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::node) struct Task {
    /// Shortest interval between two steps, ticks.
    pub(in crate::drives::node) shortest_interval: u32,
    /// Number of axes that share the line in this motion.
    pub(in crate::drives::node) sharers: u32,
    /// Most steps in which the motor stops by its brake.
    pub(in crate::drives::node) brake_steps: u64,
}

impl Task {
    /// Returns the task of `plan` on a line of `baud` that so many axes share, or refuses it before anything moves.
    pub(in crate::drives::node) fn new(
        plan: PlannedMotion<'_>,
        brake: &Brake,
        board: &Identity,
        (baud, sharers): (u32, u32),
    ) -> Result<Self, NodeError> {
        let (tick_rate, baud) = (brake.tick_rate(), baud / sharers.max(1));
        let steps_s = plan.peak_rad_s() / plan.step_rad();
        if steps_s > f64::from(board.max_step_hz) {
            return Err(NodeError::Fast { steps_s, most_s: board.max_step_hz });
        }
        match board.queue {
            256.. => demand::<256>(plan, tick_rate, baud)?,
            128.. => demand::<128>(plan, tick_rate, baud)?,
            64.. => demand::<64>(plan, tick_rate, baud)?,
            _ => demand::<16>(plan, tick_rate, baud)?,
        }
        let ends = |segment: Segment| {
            segment.interval_before(1).whole.min(segment.interval_before(segment.steps()).whole)
        };
        let shortest = plan.segments(tick_rate).map(ends).min().unwrap_or(1) as f64 * INTERVAL_SHARE;
        let shortest_interval = (shortest as u32).max(1);
        let fastest = Ticks { whole: shortest_interval.into(), frac: 0 };
        let way = brake.descent(fastest, plan.direction()).map(|segment| u64::from(segment.steps()));
        Ok(Self { shortest_interval, sharers, brake_steps: way.sum() })
    }
}

/// Checks that the segments of `plan` reach a queue of `Q` segments in time.
fn demand<const Q: usize>(plan: PlannedMotion<'_>, tick_rate: TickRate, baud: u32) -> Result<(), NodeError> {
    let allowed = (f64::from(baud / BITS) * SHARE) as u32;
    let mut demand = Demand::<Q>::new(tick_rate.hz(), allowed);
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
