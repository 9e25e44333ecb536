//! The executor: the steps that are made when the timer fires.

use super::action::Action;
use super::braking::Brake;
use super::direction::Direction;
use super::error::{PushError, StartError};
use super::feed::Feed;
use super::queue::Queue;
use super::segment::{Segment, ValidSegment};
use super::state::StepperState;
use super::tick_rate::TickRate;
use super::ticks::Ticks;

/// The executor, which makes the steps of queued segments, each at its own absolute time.
///
/// `Q` segments fit, the segment under way included. Fewer than 2 do not compile. A segment that is done
/// stays for [`Self::position_at`] until its place is needed.
///
/// Share the executor between thread and interrupt behind a critical section. Most calls take a few hundred
/// instructions at most. [`Self::stop`], [`Self::retarget`] and [`Self::position_at`] take some thousands,
/// and [`Self::fill`] takes more.
///
/// ```
/// use pump_ctl::plan::Motor;
/// use pump_ctl::step::{Action, Direction, Segment, Stepper, TickRate};
///
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
/// let mut stepper = Stepper::<2>::new(motor.brake(tick_rate)?);
/// stepper.push(Segment { count: 2, interval: 2000, add: 0, frac: 0 }, tick_rate)?;
/// stepper.finish();
/// assert_eq!(stepper.start(500)?, 2500);
/// assert_eq!(stepper.on_deadline(2499), Action::Wait);
/// assert_eq!(stepper.on_deadline(2500), Action::Step { direction: Direction::Forward, next: 4500 });
/// assert_eq!(stepper.on_deadline(4500), Action::Step { direction: Direction::Forward, next: 4500 });
/// assert_eq!(stepper.on_deadline(4500), Action::Done);
/// assert_eq!(stepper.position(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
// The fields of every step come first: an instruction reaches only the first 4 kB behind a pointer.
#[derive(Debug, Clone)]
#[repr(C)]
pub struct Stepper<const Q: usize> {
    /// Time at which the next step is due. While the motor stands, it is the time of the last step.
    pub(super) next: Ticks,
    /// Interval from the last step to the next.
    pub(super) interval: Ticks,
    /// Change of the interval from step to step, 2^-32 tick.
    pub(super) add: i64,
    /// Position: the steps made, signed.
    pub(super) position: i64,
    /// Steps left of the segment, the step due included. It is 0 while the motor stands.
    pub(super) left: u32,
    pub(super) direction: Direction,
    /// Direction of the last step, `None` before the first step of a move. Where the motor turns round,
    /// `direction` is already that of the next step.
    pub(super) last_direction: Option<Direction>,
    /// True if no segment will follow the queued segments.
    pub(super) finished: bool,
    pub(super) state: StepperState,
    /// Position after the queued segments of the plan.
    pub(super) queued_to: i64,
    /// Position at which the plan comes to rest, if it was told.
    pub(super) end: Option<i64>,
    pub(super) brake: Brake,
    pub(super) queue: Queue<Q>,
}

impl<const Q: usize> Stepper<Q> {
    /// Makes an executor of a motor at rest at position 0.
    pub fn new(brake: Brake) -> Self {
        Self {
            brake,
            queue: Queue::new(),
            state: StepperState::Ready,
            position: 0,
            next: Ticks::ZERO,
            interval: Ticks::ZERO,
            add: 0,
            left: 0,
            direction: Direction::Forward,
            last_direction: None,
            finished: false,
            queued_to: 0,
            end: None,
        }
    }

    /// Returns the rate of the timer that the executor's brake is made for.
    pub fn tick_rate(&self) -> TickRate {
        self.brake.tick_rate()
    }

    /// Returns the number of segments that fit now. The segment under way keeps its place.
    pub fn room(&self) -> usize {
        Q - self.queue.len() - usize::from(self.is_moving())
    }

    /// Queues a segment, at rest or in motion. `tick_rate` is the rate of the timer that the segment is made
    /// for.
    ///
    /// # Errors
    ///
    /// Fails with [`PushError::Full`] if there is no room, and with [`PushError::Segment`] if the segment is
    /// not valid. Fails with [`PushError::Beyond`] if it leads beyond the plan's end ([`Self::set_end`]) or away
    /// from it. Fails with [`PushError::TickRate`] if `tick_rate` is not that of the brake, by which the motor
    /// could not stop. After [`Self::finish`] it fails with [`PushError::Finished`], after a stop with
    /// [`PushError::Stopped`].
    pub fn push(&mut self, segment: Segment, tick_rate: TickRate) -> Result<(), PushError> {
        self.push_before(self.end, segment, tick_rate)
    }

    /// Queues a segment as [`Self::push`] does, in a fifth of its time: the segment's intervals were checked before.
    /// A thread that shares the executor with an interrupt checks them outside its critical section.
    ///
    /// ```
    /// use pump_ctl::plan::Motor;
    /// use pump_ctl::step::{Segment, Stepper, TickRate};
    ///
    /// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
    /// let mut stepper = Stepper::<2>::new(Motor::new(12_800.0, 17.8, 500.0).brake(tick_rate)?);
    /// let segment = Segment { count: 2, interval: 2000, add: 0, frac: 0 };
    /// assert_eq!(Segment { interval: 0, ..segment }.validated(), None);
    /// stepper.push_valid(segment.validated().unwrap(), tick_rate)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails where [`Self::push`] does, but for [`PushError::Segment`].
    pub fn push_valid(&mut self, segment: ValidSegment, tick_rate: TickRate) -> Result<(), PushError> {
        self.push_valid_before(self.end, segment.segment(), tick_rate)
    }

    /// Queues a segment of a plan that comes to rest at `end`.
    fn push_before(
        &mut self,
        end: Option<i64>,
        segment: Segment,
        tick_rate: TickRate,
    ) -> Result<(), PushError> {
        self.takes_segments_of(tick_rate)?;
        if !segment.is_valid() {
            return Err(PushError::Segment(segment));
        }
        self.push_valid_before(end, &segment, tick_rate)
    }

    fn takes_segments_of(&self, tick_rate: TickRate) -> Result<(), PushError> {
        self.takes_segments()?;
        let brake = self.brake.tick_rate();
        if tick_rate == brake { Ok(()) } else { Err(PushError::TickRate { segments: tick_rate, brake }) }
    }

    fn push_valid_before(
        &mut self,
        end: Option<i64>,
        segment: &Segment,
        tick_rate: TickRate,
    ) -> Result<(), PushError> {
        self.takes_segments_of(tick_rate)?;
        let reaches = self.queued_to.wrapping_add(i64::from(segment.count));
        if let Some(end) = end {
            let (way, count) = (end.wrapping_sub(self.queued_to), i64::from(segment.count));
            if way.signum() != count.signum() || way.unsigned_abs() < count.unsigned_abs() {
                return Err(PushError::Beyond { end, reaches });
            }
        }
        if self.room() == 0 {
            return Err(PushError::Full);
        }
        self.queue.push(*segment);
        self.queued_to = reaches;
        self.end = end;
        Ok(())
    }

    /// Marks the move as complete with the segments queued so far. Without this call, a queue that runs out
    /// is a fault ([`Action::Starved`]), unless it leads to the plan's end. At rest with nothing queued, and
    /// after a stop, the call does nothing.
    pub fn finish(&mut self) {
        if self.takes_segments().is_ok() {
            self.finished = self.is_moving() || !self.queue.is_empty();
            if self.finished {
                // A new plan may lead farther only when its end is told.
                self.end = self.end.map(|_| self.queued_to);
            }
        }
    }

    /// Queues segments as far as there is room, and marks the move as complete when there are no more.
    /// Returns true when all segments are queued. The executor learns from the feed where the plan ends
    /// ([`Feed::steps`]), and goes no farther.
    ///
    /// The call computes the segments itself. Each takes some 20,000 instructions where f64 is done in
    /// software. In a critical section, push segments that were computed before.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::push`] does, except that a full queue is no error. The refused segment stays in
    /// `segments`.
    pub fn fill(&mut self, segments: &mut Feed<impl Iterator<Item = Segment>>) -> Result<bool, PushError> {
        let tick_rate = segments.tick_rate();
        let end = segments.steps().map(|steps| self.queued_to.wrapping_add(steps)).or(self.end);
        while let Some(segment) = segments.peek() {
            match self.push_before(end, *segment, tick_rate) {
                Ok(()) => segments.next(),
                Err(PushError::Full) => return Ok(false),
                Err(refused) => return Err(refused),
            };
        }
        self.finish();
        Ok(true)
    }

    /// Starts the queued segments at `now`. Returns the tick at which to call [`Self::on_deadline`].
    ///
    /// # Errors
    ///
    /// Fails with [`StartError::Empty`] if no segment is queued, and with [`StartError::Moving`] if a move is
    /// under way. Fails with [`StartError::Stopped`] if the motor was stopped or the queue ran dry.
    pub fn start(&mut self, now: u64) -> Result<u64, StartError> {
        match self.state {
            StepperState::Moving | StepperState::Ending { .. } | StepperState::Braking { .. } => {
                return Err(StartError::Moving);
            }
            StepperState::Stopped | StepperState::Starved => return Err(StartError::Stopped),
            StepperState::Ready if self.queue.is_empty() => return Err(StartError::Empty),
            StepperState::Ready => {}
        }
        self.state = StepperState::Moving;
        self.last_direction = None;
        self.next = Ticks::middle_of(now);
        self.load();
        Ok(self.next.whole)
    }

    /// Returns the action at `now`. A timer's interrupt or a loop calls this at each deadline. A step counts
    /// as made then.
    #[inline]
    pub fn on_deadline(&mut self, now: u64) -> Action {
        if self.left == 0 {
            return if self.state == StepperState::Starved { Action::Starved } else { Action::Done };
        }
        if now < self.next.whole {
            return Action::Wait;
        }
        let direction = self.direction;
        self.last_direction = Some(direction);
        self.position = self.position.wrapping_add(i64::from(direction.sign()));
        self.left -= 1;
        if self.left > 0 {
            self.interval = self.interval.plus_fixed(self.add);
            self.next = self.next.plus(self.interval);
        } else {
            self.load();
        }
        Action::Step { direction, next: self.next.whole }
    }

    /// Returns the position: the signed steps made since power-up, or counted on from [`Self::set_position`].
    pub fn position(&self) -> i64 {
        self.position
    }

    /// Returns the tick at which to call [`Self::on_deadline`], or `None` if the motor stands.
    #[inline]
    pub fn next_deadline(&self) -> Option<u64> {
        (self.left > 0).then_some(self.next.whole)
    }

    /// Returns true if steps are still to come.
    #[inline]
    pub fn is_moving(&self) -> bool {
        self.left > 0
    }

    /// Forgets the queued segments and an earlier stop, so that a new plan can be pushed. Returns false, and
    /// changes nothing, if the motor moves.
    #[must_use]
    pub fn clear(&mut self) -> bool {
        if self.is_moving() {
            return false;
        }
        self.queue.keep_pending(0);
        self.finished = false;
        self.queued_to = self.position;
        self.end = None;
        self.state = StepperState::Ready;
        true
    }

    /// Sets the brake of a motor that stands. The queued segments are forgotten, and the position stays. Returns
    /// false, and changes nothing, if the motor moves.
    ///
    /// ```
    /// use pump_ctl::plan::Motor;
    /// use pump_ctl::step::{Brake, Stepper, TickRate};
    ///
    /// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
    /// let mut stepper = Stepper::<2>::new(Brake::standing(tick_rate));
    /// assert!(stepper.set_position(17));
    /// assert!(stepper.set_brake(&Motor::new(12_800.0, 17.8, 500.0).brake(tick_rate)?));
    /// assert_eq!(stepper.position(), 17);
    /// # Ok::<(), pump_ctl::step::BrakeError>(())
    /// ```
    #[must_use]
    pub fn set_brake(&mut self, brake: &Brake) -> bool {
        let cleared = self.clear();
        if cleared {
            self.brake = *brake;
        }
        cleared
    }

    /// Sets the position from which steps count on, as after homing, and forgets the past. Returns false, and
    /// changes nothing, if the motor moves.
    #[must_use]
    pub fn set_position(&mut self, position: i64) -> bool {
        let cleared = self.clear();
        if cleared {
            self.queue.clear();
            self.position = position;
            self.queued_to = position;
        }
        cleared
    }

    /// Stops at once, without deceleration, for a back end that can make no more steps. The past is
    /// forgotten.
    ///
    /// `last_step_made` is true if the step of the last [`Action::Step`] was made. A step that was not made
    /// is not counted.
    pub fn halt(&mut self, last_step_made: bool) {
        if !last_step_made {
            let last = self.last_direction.map_or(0, Direction::sign);
            self.position = self.position.wrapping_sub(i64::from(last));
        }
        self.queue.clear();
        self.left = 0;
        self.state = StepperState::Stopped;
    }

    /// Goes on with the next segment, from the queue or down the brake, or ends the move.
    pub(super) fn load(&mut self) {
        if self.queue.is_empty() {
            self.run_dry();
        }
        if matches!(self.state, StepperState::Braking { .. }) {
            self.walk_down();
        }
        self.take();
    }

    /// Goes on with the next segment of the way to rest, or stands.
    #[cold]
    #[inline(never)]
    fn walk_down(&mut self) {
        if let StepperState::Braking { way, starved } = &mut self.state {
            if let Some(mut segment) = way.next_down(&self.brake) {
                segment.count *= i32::from(self.direction.sign());
                self.queue.push(segment);
            } else {
                self.state = if *starved { StepperState::Starved } else { StepperState::Stopped };
            }
        }
    }

    /// Ends the move where the queue does, or finds the way to rest from there.
    #[cold]
    #[inline(never)]
    fn run_dry(&mut self) {
        let starved = match self.state {
            StepperState::Moving => !self.is_whole(),
            StepperState::Ending { rests } => {
                if rests {
                    self.state = StepperState::Stopped;
                    return;
                }
                false
            }
            _ => return,
        };
        self.finished = false;
        if self.state == StepperState::Moving && !starved {
            self.end = None;
            self.state = StepperState::Ready;
            return;
        }
        self.state = match self.way_down(self.interval.fixed(), self.position, self.direction) {
            Some(way) => StepperState::Braking { way, starved },
            None if starved => StepperState::Starved,
            None => StepperState::Stopped,
        };
    }

    /// Goes on with the next segment of the queue.
    pub(super) fn take(&mut self) {
        if let Some(segment) = self.queue.take(self.next, self.position) {
            self.left = segment.steps();
            self.direction = segment.direction();
            self.interval = segment.first();
            self.add = segment.add;
            self.next = self.next.plus(self.interval);
        }
    }

    /// Returns the steps made of the segment under way.
    pub(super) fn made_of_current(&self) -> u32 {
        self.queue.current().map_or(0, |slot| slot.segment.steps() - self.left)
    }
}
