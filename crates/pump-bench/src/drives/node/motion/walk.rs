//! The walk through the segments of a plan, to find what they ask of the board and of the link.
//!
//! A smooth run until it is stopped has a million parts and more, all alike. So the walk leaves out the middle of a
//! long cruise, and the time that it takes does not grow with the plan.

use std::f64::consts::TAU;
use std::ops::Range;

use pump_ctl::plan::{MotionSegments, PlannedMotion};
use pump_ctl::step::{Segment, TickRate};

/// Turns of a cruise after which its segments repeat, whatever the ramp has left.
const SETTLED_TURNS: f64 = 1.0;

/// Turns of a cruise that tell what it asks for.
const TOLD_TURNS: f64 = 2.0;

/// Steps of a long plan that the walk leaves out, and those that stand for them.
#[derive(Debug, Clone)]
pub(super) struct LeftOut {
    /// Whole turns of the cruise, just before the steps left out.
    pub(super) told: Range<u64>,
    steps: Range<u64>,
}

impl LeftOut {
    /// Returns what the walk leaves out of a plan, unless it is short.
    pub(super) fn of(plan: PlannedMotion<'_>) -> Option<Self> {
        let PlannedMotion::Dose(dose) = plan else { return None };
        let cruise = dose.cruise_steps();
        let turns = |turns: f64| (turns * TAU / dose.step_rad()).round() as u64;
        let told_from = cruise.start + turns(SETTLED_TURNS);
        let from = told_from + turns(TOLD_TURNS);
        let to = cruise.end.saturating_sub(turns(SETTLED_TURNS));
        (from < to).then_some(Self { told: told_from..from, steps: from..to })
    }
}

/// Segments of a plan, each with the number of steps that are made before it.
#[derive(Debug)]
pub(super) struct Walk<'a> {
    segments: MotionSegments<'a>,
    made: u64,
    left_out: Option<LeftOut>,
}

impl<'a> Walk<'a> {
    /// Begins the walk through a plan.
    pub(super) fn new(plan: PlannedMotion<'a>, tick_rate: TickRate) -> Self {
        Self { segments: plan.segments(tick_rate), made: 0, left_out: LeftOut::of(plan) }
    }
}

impl Iterator for Walk<'_> {
    type Item = (u64, Segment);

    fn next(&mut self) -> Option<Self::Item> {
        // At a constant speed one segment may go beyond all of them.
        if let Some(left_out) = &self.left_out
            && left_out.steps.contains(&self.made)
            && let MotionSegments::Dose(segments) = &self.segments
        {
            self.segments = MotionSegments::Dose(segments.clone().after(left_out.steps.end));
            self.made = left_out.steps.end;
        }
        let segment = self.segments.next()?;
        let before = self.made;
        self.made += u64::from(segment.steps());
        Some((before, segment))
    }
}
