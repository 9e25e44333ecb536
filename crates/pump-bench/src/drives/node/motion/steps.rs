//! The segments of a motion: those of the plan from its begin, and those of its rest after a pause.

use std::iter;

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Segment, TickRate, Ticks};

use crate::drives::stepped::{Lead, steps_from};

/// Most steps of a segment that is gathered.
const MOST: usize = 64;

/// Largest distance of a gathered step from its time, 2^-32 tick: half a tick.
const FIT: i128 = 1 << 31;

/// Most by which a gathered segment is faster than the fastest of its steps, 2^-32 tick: a sixteenth of a tick. The
/// board is told the shortest interval before.
const FASTER: i128 = 1 << 28;

/// Segments of a motion, cut to the steps that may be sent.
pub(super) struct Steps<'a> {
    segments: Box<dyn Iterator<Item = Segment> + Send + 'a>,
    /// Rest of a segment that was cut.
    rest: Option<Segment>,
}

impl<'a> Steps<'a> {
    /// Returns the segments of `plan` after the first `made` steps, from rest. `lead` has leave for all steps. A flow
    /// over time that has begun has none, since its times have passed.
    pub(super) fn new(plan: PlannedMotion<'a>, tick_rate: TickRate, lead: &'a Lead, made: u64) -> Self {
        let segments: Box<dyn Iterator<Item = Segment> + Send + 'a> = match plan {
            plan if made == 0 => Box::new(plan.segments(tick_rate)),
            PlannedMotion::Dose(plan) => Box::new(gathered(steps_from(plan, tick_rate, lead, made))),
            PlannedMotion::Flow(_) => Box::new(iter::empty()),
        };
        Self { segments, rest: None }
    }

    /// Returns the next segment, cut to `most` steps.
    pub(super) fn next(&mut self, most: u64) -> Option<Segment> {
        let segment = self.rest.take().or_else(|| self.segments.next())?;
        let most = u32::try_from(most).unwrap_or(u32::MAX);
        if segment.steps() <= most {
            return Some(segment);
        }
        let Ticks { whole, frac } = segment.interval_before(most + 1);
        let sign = segment.count.signum();
        let first = i32::try_from(most).unwrap_or(i32::MAX).saturating_mul(sign);
        self.rest = Some(Segment { count: segment.count - first, interval: whole, frac, add: segment.add });
        Some(Segment { count: first, ..segment })
    }
}

/// Gathers single steps into segments whose intervals change evenly.
fn gathered(steps: impl Iterator<Item = Segment> + Send) -> impl Iterator<Item = Segment> + Send {
    let mut steps = steps.fuse();
    let mut waiting: Vec<Segment> = Vec::with_capacity(MOST);
    iter::from_fn(move || {
        waiting.extend(steps.by_ref().take(MOST - waiting.len()));
        let mut count = waiting.len();
        while count > 1 {
            if let Some(segment) = waiting.get(..count).and_then(even) {
                waiting.drain(..count);
                return Some(segment);
            }
            count = count * 3 / 4;
        }
        (!waiting.is_empty()).then(|| waiting.remove(0))
    })
}

/// Returns the segment of these single steps, or `None` if their intervals do not change evenly.
fn even(steps: &[Segment]) -> Option<Segment> {
    let n = i128::try_from(steps.len()).ok()?;
    let interval = |segment: &Segment| (i128::from(segment.interval) << 32) | i128::from(segment.frac);
    let (first, last) = (interval(steps.first()?), interval(steps.last()?));
    let add = (last - first) / (n - 1);
    let all: i128 = steps.iter().map(interval).sum();
    // The segment ends with its last step.
    let begin = (all - add * (n * (n - 1) / 2)) / n;
    let shortest = steps.iter().map(interval).min()?;
    if begin.min(begin + add * (n - 1)) < shortest - FASTER {
        return None;
    }
    let (mut due, mut made) = (0, 0);
    for (k, step) in (0..).zip(steps) {
        due += interval(step);
        made += begin + add * k;
        if (due - made).abs() > FIT {
            return None;
        }
    }
    let segment = Segment {
        count: steps.first()?.count.signum() * i32::try_from(n).ok()?,
        interval: u64::try_from(begin >> 32).ok()?,
        frac: begin as u32,
        add: i64::try_from(add).ok()?,
    };
    segment.is_valid().then_some(segment)
}
