//! The end of the plan, beyond which no step leads.

use super::braking::WayDown;
use super::direction::Direction;
use super::error::PushError;
use super::state::StepperState;
use super::stepper::Stepper;

impl<const Q: usize> Stepper<Q> {
    /// Tells the position at which the plan comes to rest, signed steps as [`Self::position`].
    ///
    /// No step leads beyond it: neither a stop, nor a queue that runs dry, nor a segment. Tell it before or with the
    /// first segment if the plan may be longer than the queue. [`Self::fill`] tells it where the feed knows it, as
    /// that of a plan does. The move is complete when the motor comes there, with or without [`Self::finish`].
    ///
    /// After [`Self::retarget`] the end of the old plan holds until the new one is told. A plan that turns round has
    /// an end for each direction: tell the next end when the segments up to the last one are pushed. Without an end
    /// the motor may be stopped beyond the segments that are queued.
    ///
    /// # Errors
    ///
    /// Fails with [`PushError::Finished`] after [`Self::finish`] and with [`PushError::Stopped`] after a stop.
    ///
    /// ```
    /// use pump_ctl::plan::Motor;
    /// use pump_ctl::step::{PushError, Segment, Stepper, TickRate};
    ///
    /// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
    /// let mut stepper = Stepper::<4>::new(Motor::new(12_800.0, 17.8, 1.0).brake(tick_rate)?);
    /// let fast = Segment { count: 900, interval: 50, add: 0, frac: 0 };
    /// stepper.set_end(1000)?;
    /// stepper.push(fast, tick_rate)?;
    /// assert_eq!(stepper.push(fast, tick_rate), Err(PushError::Beyond { end: 1000, reaches: 1800 }));
    /// stepper.start(0)?;
    /// // The brake would take thousands of steps.
    /// assert_eq!(stepper.stop(0).final_count, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_end(&mut self, end: i64) -> Result<(), PushError> {
        self.takes_segments()?;
        self.end = Some(end);
        Ok(())
    }

    /// Returns the position at which the plan comes to rest, if it was told. A move that is complete has none.
    pub fn end(&self) -> Option<i64> {
        self.end
    }

    /// Refuses segments of a move that is complete or that was stopped.
    pub(super) fn takes_segments(&self) -> Result<(), PushError> {
        match self.state {
            StepperState::Ready | StepperState::Moving if self.finished => Err(PushError::Finished),
            StepperState::Ready | StepperState::Moving => Ok(()),
            StepperState::Ending { .. }
            | StepperState::Braking { .. }
            | StepperState::Stopped
            | StepperState::Starved => Err(PushError::Stopped),
        }
    }

    /// Returns true if the plan ends where the queued segments end.
    pub(super) fn is_whole(&self) -> bool {
        self.finished || self.end == Some(self.queued_to)
    }

    /// Returns the steps from `position` to the end in `direction`, or `None` if there is no end. It is 0 where the
    /// plan turns round.
    pub(super) fn steps_to_end(&self, position: i64, direction: Direction) -> Option<u64> {
        let way = self.end?.wrapping_sub(position).saturating_mul(i64::from(direction.sign()));
        Some(u64::try_from(way).unwrap_or(0))
    }

    /// Returns the way to rest from `position` for a motor whose last interval was `interval`, 2^-32 tick. The result
    /// is `None` if the motor can stand at once or must, because it is at the plan's end.
    ///
    /// The way is down the brake, or the ramp to the plan's end if the brake leads beyond. The plan's own ramp is
    /// then steeper than the brake.
    pub(super) fn way_down(&self, interval: i128, position: i64, direction: Direction) -> Option<WayDown> {
        let descent = self.brake.descent_from(interval)?;
        match self.steps_to_end(position, direction) {
            Some(left) if left < u64::from(self.brake.steps_down(&descent)) => {
                WayDown::to_end(interval, u32::try_from(left).unwrap_or(u32::MAX))
            }
            _ => Some(WayDown::Brake(descent)),
        }
    }
}
