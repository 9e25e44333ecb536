//! The steps of a flow over time as runs of integers for the executor.

use libm::floor;

use super::motion::FlowMotion;
use crate::step::{Direction, Segment, TickRate};

/// Largest distance of a step's time from the flow's before it is rounded to a tick, ticks.
const FIT_TICKS: f64 = 0.25;

/// Fractions of the executor in a tick, 2^32.
const FRACTIONS: f64 = 4_294_967_296.0;

/// Most steps of a segment. Every one of them is looked at.
const MOST: u64 = 256;

/// The [`Segment`]s of a flow over time in order, computed one by one.
///
/// The step times of a segment are a parabola in the step's number. Each segment is as long as its parabola stays
/// within a quarter of a tick of every step, and starts where the last one ended, in whole fractions.
#[derive(Debug, Clone)]
pub struct FlowSegments<'a> {
    motion: FlowMotion<'a>,
    tick_hz: f64,
    /// Number of the knot up to which steps were made.
    knot: usize,
    made: u64,
    /// Time at which the last step made is due, 2^-32 tick since the start.
    at: i128,
    /// Number of steps that the next segment tries to hold.
    guess: u64,
}

impl<'a> FlowMotion<'a> {
    /// Returns the segments for a timer of this rate. Every step comes within one tick of its time.
    pub fn segments(&self, tick_rate: TickRate) -> FlowSegments<'a> {
        let tick_hz = f64::from(tick_rate.hz());
        FlowSegments { motion: *self, tick_hz, knot: 0, made: 0, at: 0, guess: MOST }
    }
}

impl FlowSegments<'_> {
    /// Returns the time at which step `number` is due, ticks since the start.
    fn due(&self, number: u64) -> f64 {
        let stretch = self.motion.stretch(self.knot);
        stretch.map_or(0.0, |stretch| stretch.step(number).time_s) * self.tick_hz
    }

    /// Fits a parabola through the last step made, the middle and the end of `count` steps. `count` is even or 1.
    fn fit(&self, count: u64) -> Segment {
        let half = (count / 2) as f64;
        let elapsed = |k: u64| self.due(self.made + k) - self.at as f64 / FRACTIONS;
        let (interval, add) = if count < 2 {
            (elapsed(1), 0.0)
        } else {
            let (middle, end) = (elapsed(count / 2), elapsed(count));
            let add = (end - 2.0 * middle) / (half * half);
            (middle / half - 0.5 * add * (half - 1.0), add)
        };
        let fixed = (interval * FRACTIONS + 0.5) as i128;
        Segment {
            count: i32::try_from(count).unwrap_or(i32::MAX),
            interval: (fixed >> 32) as u64,
            frac: fixed as u32,
            add: floor(add * FRACTIONS + 0.5) as i64,
        }
    }

    /// Returns true if every step of the segment is due within a quarter of a tick of the flow's.
    fn holds(&self, segment: &Segment) -> bool {
        segment.is_valid()
            && (1..=segment.steps()).all(|k| {
                let due = (self.at + segment.span(k)) as f64 / FRACTIONS;
                (due - self.due(self.made + u64::from(k))).abs() <= FIT_TICKS.max(2.0 * f64::EPSILON * due)
            })
    }
}

impl Iterator for FlowSegments<'_> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        if self.made >= self.motion.all() {
            return None;
        }
        self.knot = self.motion.knot_of(self.made + 1)?;
        let ends = self.motion.knots.get(self.knot)?.steps;
        let mut count = self.guess.min(ends - self.made).min(MOST);
        let mut segment = loop {
            count = if count < 2 { 1 } else { count & !1 };
            let segment = self.fit(count);
            if count == 1 || self.holds(&segment) {
                break segment;
            }
            count /= 2;
        };
        self.guess = 2 * count;
        self.made += count;
        self.at += segment.span(segment.steps());
        if self.motion.direction == Direction::Reverse {
            segment.count = -segment.count;
        }
        Some(segment)
    }
}
