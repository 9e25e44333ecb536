//! The executor: what happens when the timer fires.

use core::iter::Peekable;

use super::action::Action;
use super::brake::Brake;
use super::error::{PushError, StartError};
use super::queue::Queue;
use super::segment::Segment;
use super::state::State;
use super::ticks::Ticks;

/// The executor: makes the steps of queued segments, each at its own absolute time.
///
/// `Q` segments fit, the one under way included. Those done stay for [`Self::position_at`] until their place is
/// needed.
///
/// Share it between thread and interrupt behind a critical section; no call takes longer than a few hundred
/// instructions but [`Self::stop`], [`Self::retarget`] and [`Self::position_at`] (some thousands), and [`Self::fill`].
#[derive(Debug, Clone)]
pub struct Stepper<const Q: usize> {
    pub(super) brake: Brake,
    pub(super) queue: Queue<Q>,
    pub(super) state: State,
    /// Steps made, signed.
    pub(super) position: i64,
    /// Time at which the next step is due; of a motor that stands, time of the last one.
    pub(super) next: Ticks,
    /// Interval from the step before to the next one.
    pub(super) interval: Ticks,
    /// Change of the interval, 2^-32 tick.
    pub(super) add: i64,
    /// Steps left of the segment, the one due included; 0 when standing.
    pub(super) left: u32,
    pub(super) direction: i8,
    /// Direction of the last step, 0 before the first of a move: after a turn-round `direction` is that of the next.
    pub(super) last_direction: i8,
    /// True if nothing will be pushed after the queued segments.
    pub(super) finished: bool,
}

impl<const Q: usize> Stepper<Q> {
    /// A motor at rest at position 0.
    pub fn new(brake: Brake) -> Self {
        Self {
            brake,
            queue: Queue::new(),
            state: State::Ready,
            position: 0,
            next: Ticks::ZERO,
            interval: Ticks::ZERO,
            add: 0,
            left: 0,
            direction: 1,
            last_direction: 0,
            finished: false,
        }
    }

    /// Room for segments now. The one under way keeps its place.
    pub fn room(&self) -> usize {
        Q - self.queue.len() - usize::from(self.is_moving())
    }

    /// Queues a segment, at rest or in motion.
    pub fn push(&mut self, segment: Segment) -> Result<(), PushError> {
        match self.state {
            State::Ending { .. } | State::Braking { .. } | State::Stopped | State::Starved => {
                return Err(PushError::Stopped);
            }
            State::Ready | State::Moving if self.finished => return Err(PushError::Finished),
            State::Ready | State::Moving => {}
        }
        if !segment.is_valid() {
            return Err(PushError::Segment(segment));
        }
        if self.room() == 0 {
            return Err(PushError::Full);
        }
        self.queue.push(segment);
        Ok(())
    }

    /// Says that the move ends with what is queued. Without it a queue that runs out is a fault: see
    /// [`Action::Starved`]. At rest with nothing queued there is no move to end.
    pub fn finish(&mut self) {
        self.finished = self.is_moving() || !self.queue.is_empty();
    }

    /// Queues segments as far as there is room and marks the move as complete when there are no more. True when done.
    ///
    /// Computes the segments here and now, some 20,000 instructions each where f64 is done in software: in a critical
    /// section push what was computed before.
    pub fn fill(
        &mut self,
        segments: &mut Peekable<impl Iterator<Item = Segment>>,
    ) -> Result<bool, PushError> {
        while let Some(segment) = segments.peek() {
            match self.push(*segment) {
                Ok(()) => segments.next(),
                Err(PushError::Full) => return Ok(false),
                Err(refused) => return Err(refused),
            };
        }
        self.finish();
        Ok(true)
    }

    /// Starts the queued segments at `now`. Returns when to call [`Self::on_deadline`].
    pub fn start(&mut self, now: u64) -> Result<u64, StartError> {
        match self.state {
            State::Moving | State::Ending { .. } | State::Braking { .. } => return Err(StartError::Moving),
            State::Stopped | State::Starved => return Err(StartError::Stopped),
            State::Ready if self.queue.is_empty() => return Err(StartError::Empty),
            State::Ready => {}
        }
        self.state = State::Moving;
        self.last_direction = 0;
        self.next = Ticks::middle_of(now);
        self.load();
        Ok(self.next.whole)
    }

    /// The action at `now`. A timer's interrupt or a loop asks for it at the deadlines; a step counts as made then.
    #[inline]
    pub fn on_deadline(&mut self, now: u64) -> Action {
        if self.left == 0 {
            return if self.state == State::Starved { Action::Starved } else { Action::Done };
        }
        if now < self.next.whole {
            return Action::Wait;
        }
        let dir = self.direction;
        self.last_direction = dir;
        self.position = self.position.wrapping_add(i64::from(dir));
        self.left -= 1;
        if self.left > 0 {
            self.interval = self.interval.plus_fixed(self.add);
            self.next = self.next.plus(self.interval);
        } else {
            self.load();
        }
        Action::Step { dir, next: self.next.whole }
    }

    /// Steps made since power-up, signed, or since [`Self::set_position`].
    pub fn position(&self) -> i64 {
        self.position
    }

    /// Time at which [`Self::on_deadline`] is to be called; none when the motor stands.
    pub fn next_deadline(&self) -> Option<u64> {
        (self.left > 0).then_some(self.next.whole)
    }

    /// Tells whether steps are still to come.
    pub fn is_moving(&self) -> bool {
        self.left > 0
    }

    /// Forgets what was queued and that the motor was stopped, so that a new plan can be pushed. False, and nothing
    /// changes, if it moves.
    #[must_use]
    pub fn clear(&mut self) -> bool {
        if self.is_moving() {
            return false;
        }
        self.queue.keep_pending(0);
        self.finished = false;
        self.state = State::Ready;
        true
    }

    /// Counts on from `position`, as after homing, and forgets the past. False, and nothing changes, if it moves.
    #[must_use]
    pub fn set_position(&mut self, position: i64) -> bool {
        let cleared = self.clear();
        if cleared {
            self.queue.clear();
            self.position = position;
        }
        cleared
    }

    /// Stands at once, without deceleration: for a back end that can make no more steps. The past is forgotten.
    ///
    /// `last_step_made` is true if the step of the last [`Action::Step`] was made; if not, it is not counted.
    pub fn halt(&mut self, last_step_made: bool) {
        if !last_step_made {
            self.position = self.position.wrapping_sub(i64::from(self.last_direction));
        }
        self.queue.clear();
        self.left = 0;
        self.state = State::Stopped;
    }

    /// Goes on with the next segment, from the queue or down the brake, or ends.
    pub(super) fn load(&mut self) {
        if self.queue.is_empty() {
            self.state = match self.state {
                State::Moving if self.finished => State::Ready,
                State::Moving => self
                    .brake
                    .descent_from(self.interval.fixed())
                    .map_or(State::Starved, |descent| State::Braking { descent, starved: true }),
                State::Ending { rests: false } => self
                    .brake
                    .descent_from(self.interval.fixed())
                    .map_or(State::Stopped, |descent| State::Braking { descent, starved: false }),
                State::Ending { rests: true } => State::Stopped,
                other => other,
            };
            self.finished = false;
        }
        if let State::Braking { descent, starved } = &mut self.state {
            if let Some(mut segment) = self.brake.next_down(descent) {
                segment.count *= i32::from(self.direction);
                self.queue.push(segment);
            } else {
                self.state = if *starved { State::Starved } else { State::Stopped };
            }
        }
        self.take();
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

    /// Steps made of the segment under way.
    pub(super) fn made_of_current(&self) -> u32 {
        self.queue.current().map_or(0, |slot| slot.segment.steps() - self.left)
    }
}
