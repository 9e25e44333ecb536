//! Segments on their way to the executor.

use core::iter::Peekable;

use super::segment::Segment;
use super::tick_rate::TickRate;

/// Segments on their way to the executor, and the rate of the timer that they are made for.
///
/// [`crate::plan::Segments::feed`] makes the feed of a plan. A feed of other segments may join several plans
/// of the same timer.
///
/// ```
/// use pump_ctl::plan::Motor;
/// use pump_ctl::step::{Feed, PushError, Segment, Stepper, TickRate};
///
/// let [megahertz, kilohertz] = [1_000_000, 1_000].map(|hz| TickRate::from_hz(hz).unwrap());
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let mut stepper = Stepper::<4>::new(motor.brake(megahertz)?);
/// let steps = [Segment { count: 5, interval: 2000, add: 0, frac: 0 }];
/// let refused = stepper.fill(&mut Feed::new(kilohertz, steps));
/// assert_eq!(refused, Err(PushError::TickRate { segments: kilohertz, brake: megahertz }));
/// assert_eq!(stepper.fill(&mut Feed::new(megahertz, steps)), Ok(true));
/// # Ok::<(), pump_ctl::step::BrakeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Feed<I: Iterator<Item = Segment>> {
    tick_rate: TickRate,
    segments: Peekable<I>,
    /// Steps of the segments still to come, signed, if they are known.
    steps: Option<i64>,
}

impl<I: Iterator<Item = Segment>> Feed<I> {
    /// Makes a feed of segments that are made for a timer of this rate.
    pub fn new(tick_rate: TickRate, segments: impl IntoIterator<IntoIter = I>) -> Self {
        Self { tick_rate, segments: segments.into_iter().peekable(), steps: None }
    }

    /// Returns the feed of segments that make `steps` in all, signed and in one direction.
    ///
    /// [`super::Stepper::fill`] tells the executor from them where the plan ends. A feed that several plans are
    /// joined in has no such number: each plan ends for itself.
    #[must_use]
    pub fn with_steps(self, steps: i64) -> Self {
        Self { steps: Some(steps), ..self }
    }

    /// Returns the steps of the segments still to come, signed, if they are known.
    pub fn steps(&self) -> Option<i64> {
        self.steps
    }

    /// Returns the rate of the timer that the segments are made for.
    pub fn tick_rate(&self) -> TickRate {
        self.tick_rate
    }

    /// Returns the next segment and leaves it in the feed.
    pub fn peek(&mut self) -> Option<&Segment> {
        self.segments.peek()
    }
}

impl<I: Iterator<Item = Segment>> Iterator for Feed<I> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        let segment = self.segments.next()?;
        self.steps = self.steps.map(|steps| steps.saturating_sub(i64::from(segment.count)));
        Some(segment)
    }
}
