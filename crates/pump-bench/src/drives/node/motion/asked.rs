//! The needs of a plan from the board and the line, found by one walk through its segments.

use std::cell::RefCell;

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Segment, TickRate, Ticks};
use pump_link::message::PROMPT_PACKED;
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, Rounder};
use pump_link::sender::{Demand, FRAME_OVERHEAD, StreamError, TooFast};

use super::walk::{LeftOut, Walk};
use crate::drives::node::error::NodeError;

/// Most by which an interval that is sent is shorter than the plan's, 2^-32 tick: a quarter of a tick. The rounding of
/// segments takes less than a sixth, and the gathering of steps after a pause a sixteenth ([`super::steps`]).
pub(super) const SHORTER: u128 = 1 << 30;

/// Most by which a segment of a plan is faster than the plan's speed, 2^-32 tick: an eighth of a tick. Its parabola
/// keeps the steps to their times, and the intervals at its ends may be some shorter. 0.06 tick were seen.
pub(super) const CUT: u128 = 1 << 29;

/// Part of the rate that a long cruise needs beyond its mean, for turns that need more than those that were looked at.
const SPARE: u64 = 32;

/// Parts of the line's rate in which the rate is told that a plan takes of it.
const PARTS: u32 = 64;

/// Moments of a plan by which it is known again.
const MOMENTS: u64 = 64;

/// Line over which a plan is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LineTo {
    /// Rate of the board's timer.
    pub(super) tick_rate: TickRate,
    /// Segments that the board's queue holds.
    pub(super) queue: u16,
    /// Bytes a second that the segments of all axes may take.
    pub(super) all_bytes_s: u32,
}

/// The needs of a plan from the board and the line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    /// Shortest interval of two steps that the board is told, whole ticks. No segment of the plan is faster, however it
    /// is cut and rounded.
    pub(super) shortest_interval: u32,
    /// Bytes a second that are enough for the segments, by no more than a part in 64 of the line too many. `None` if
    /// they need more than the line carries.
    pub(super) bytes_s: Option<u32>,
}

/// The needs of the last plan. A plan is looked at before a rack begins, before its motion is announced and as it
/// begins, and a long flow over time takes seconds each time.
#[derive(Debug, Default)]
pub(in crate::drives::node) struct LastAsked(RefCell<Option<(Mark, LineTo, Asked)>>);

impl LastAsked {
    /// Returns what `plan` asks for.
    pub(super) fn of(&self, plan: PlannedMotion<'_>, line: LineTo) -> Result<Asked, NodeError> {
        let mark = Mark::of(plan);
        if let Some((before, to, asked)) = &*self.0.borrow()
            && (*before, *to) == (mark, line)
        {
            return Ok(*asked);
        }
        let asked = match line.queue {
            256.. => asked::<256>(plan, line),
            128.. => asked::<128>(plan, line),
            64.. => asked::<64>(plan, line),
            _ => asked::<16>(plan, line),
        }?;
        self.0.replace(Some((mark, line, asked)));
        Ok(asked)
    }
}

/// Times of a plan at many moments, by which it is told from any other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Mark {
    steps: i64,
    bits: [u64; 3],
    times: [u64; MOMENTS as usize],
}

impl Mark {
    fn of(plan: PlannedMotion<'_>) -> Self {
        let all = plan.steps().unsigned_abs();
        let (start_rad, peak_rad_s) = (plan.start().angle_rad(), plan.peak_rad_s());
        let place = |n: usize| (u128::from(all) * (n as u128 + 1) / u128::from(MOMENTS)) as u64;
        Self {
            steps: plan.steps(),
            bits: [start_rad, peak_rad_s, plan.step_rad()].map(f64::to_bits),
            times: std::array::from_fn(|n| plan.time_of(place(n)).to_bits()),
        }
    }
}

/// Walks through a plan once, for a queue of `Q` segments.
fn asked<const Q: usize>(plan: PlannedMotion<'_>, line: LineTo) -> Result<Asked, NodeError> {
    let part = |part: u32| (u64::from(line.all_bytes_s) * u64::from(part) / u64::from(PARTS)) as u32;
    let demand = |n| Demand::<Q>::new(line.tick_rate.hz(), part(n));
    // The slower the line, the sooner a segment is too late: those that fail are the first.
    let mut demands: Vec<Demand<Q>> = (1..=PARTS).map(demand).collect();
    let mut failed = 0;
    let (mut sizes, mut mean) = (Sizes::new(), Mean::of(plan));
    let mut shortest = mean.at_peak(plan, line.tick_rate);
    for (made, segment) in Walk::new(plan, line.tick_rate) {
        for step in [1, segment.steps()] {
            shortest = shortest.min(fractions(segment.interval_before(step)));
        }
        if failed < demands.len() {
            let (segment, bytes) = sizes.next(segment)?;
            let left = demands.iter_mut().skip(failed);
            failed += left.map(|demand| demand.segment(&segment, bytes)).filter(Result::is_err).count();
            mean.note(made, &segment, bytes);
        }
    }
    let shortest_interval = u32::try_from(shortest.saturating_sub(SHORTER) >> 32).unwrap_or(u32::MAX).max(1);
    let mut enough = (1..=PARTS).map(part).skip(failed);
    let bytes_s = enough.find(|bytes_s| mean.is_within(line.tick_rate, *bytes_s).is_ok());
    Ok(Asked { shortest_interval, bytes_s })
}

fn fractions(Ticks { whole, frac }: Ticks) -> u128 {
    (u128::from(whole) << 32) | u128::from(frac)
}

/// Sizes of segments as they are sent.
struct Sizes(Rounder, Codec);

impl Sizes {
    fn new() -> Self {
        Self(Rounder::default(), Codec::new(Grain::Fine))
    }

    /// Returns the next segment as it is sent, and its bytes on the line.
    fn next(&mut self, segment: Segment) -> Result<(Segment, u32), StreamError> {
        let segment = self.0.round(segment).map_err(StreamError::Pack)?;
        let mut bytes = [0; MAX_PACKED_SEGMENT];
        let mut room = &mut bytes[..];
        self.1.write(&segment, &mut room).map_err(StreamError::Pack)?;
        let used = MAX_PACKED_SEGMENT - room.len();
        // Each segment takes its share of the frame around it.
        Ok((segment, (used + (used * FRAME_OVERHEAD).div_ceil(PROMPT_PACKED)) as u32))
    }
}

/// Mean rate of a long cruise, of which the walk leaves out the middle. A cruise that needs a little more than the line
/// carries comes too late only after many turns.
struct Mean {
    left_out: Option<LeftOut>,
    bytes: u64,
    ticks: u64,
}

impl Mean {
    fn of(plan: PlannedMotion<'_>) -> Self {
        Self { left_out: LeftOut::of(plan), bytes: 0, ticks: 0 }
    }

    /// Returns the shortest interval of segments that the walk leaves out, 2^-32 tick: they are no faster than the plan
    /// is anywhere.
    fn at_peak(&self, plan: PlannedMotion<'_>, tick_rate: TickRate) -> u128 {
        self.left_out.as_ref().map_or(u128::MAX, |_| {
            let ticks = f64::from(tick_rate.hz()) * plan.step_rad() / plan.peak_rad_s();
            ((ticks * 2_f64.powi(32)) as u128).saturating_sub(CUT)
        })
    }

    /// Notes a segment before which so many steps are made.
    fn note(&mut self, made: u64, segment: &Segment, bytes: u32) {
        if self.left_out.as_ref().is_some_and(|left_out| left_out.told.contains(&made)) {
            self.bytes += u64::from(bytes);
            self.ticks += segment.duration().whole;
        }
    }

    /// Refuses a rate of the line that is less than the mean.
    fn is_within(&self, tick_rate: TickRate, bytes_s: u32) -> Result<(), TooFast> {
        let mean_bytes_s = (self.bytes * u64::from(tick_rate.hz())).div_ceil(self.ticks.max(1));
        let (needed_bytes_s, allowed_bytes_s) = (mean_bytes_s + mean_bytes_s / SPARE, bytes_s.into());
        match needed_bytes_s <= allowed_bytes_s {
            true => Ok(()),
            false => Err(TooFast::Link { needed_bytes_s, allowed_bytes_s }),
        }
    }
}

/// Checks that the segments of `plan` reach the board's queue in time over so many bytes a second.
pub(super) fn demand(plan: PlannedMotion<'_>, line: LineTo, bytes_s: u32) -> Result<(), NodeError> {
    match line.queue {
        256.. => demand_of::<256>(plan, line.tick_rate, bytes_s),
        128.. => demand_of::<128>(plan, line.tick_rate, bytes_s),
        64.. => demand_of::<64>(plan, line.tick_rate, bytes_s),
        _ => demand_of::<16>(plan, line.tick_rate, bytes_s),
    }
}

fn demand_of<const Q: usize>(
    plan: PlannedMotion<'_>,
    tick_rate: TickRate,
    bytes_s: u32,
) -> Result<(), NodeError> {
    let mut demand = Demand::<Q>::new(tick_rate.hz(), bytes_s);
    let (mut sizes, mut mean) = (Sizes::new(), Mean::of(plan));
    for (made, segment) in Walk::new(plan, tick_rate) {
        let (segment, bytes) = sizes.next(segment)?;
        demand.segment(&segment, bytes)?;
        mean.note(made, &segment, bytes);
    }
    Ok(mean.is_within(tick_rate, bytes_s)?)
}
