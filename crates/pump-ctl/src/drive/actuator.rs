//! A motor and its executor, driven from a timer's interrupt.

use super::error::Fault;
use super::motion::Motion;
use crate::step::{Action, Stepper, StopPlan};

/// The treatment of the motor when its back end fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OnFault {
    /// Keep it energised: it holds its angle and the line's pressure.
    Hold,
    /// Let go of it. The line may turn it, so its angle is no longer certain.
    Disable,
}

/// The next task of the timer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Timer {
    /// Fire at this tick.
    At(u64),
    /// Nothing: the motor stands, as planned or as the stop said.
    Done,
}

/// A motor that follows queued segments. `Q` as for [`Stepper`].
#[derive(Debug)]
pub struct Actuator<M, const Q: usize> {
    motion: M,
    stepper: Stepper<Q>,
    on_fault: OnFault,
    pub(super) enabled: bool,
    /// Delay of the call that made the motor stop, ticks.
    late_ticks: Option<u64>,
    /// Last state of the index sensor, if it is looked at after every step.
    watching: Option<bool>,
    /// Position at which the index sensor last became active.
    index_at: Option<i64>,
}

impl<M: Motion, const Q: usize> Actuator<M, Q> {
    /// A motor at rest, not energised by this.
    pub fn new(motion: M, stepper: Stepper<Q>, on_fault: OnFault) -> Self {
        Self { motion, stepper, on_fault, enabled: false, late_ticks: None, watching: None, index_at: None }
    }

    /// The executor: to push segments, to ask where the motor is or was.
    pub fn stepper(&mut self) -> &mut Stepper<Q> {
        &mut self.stepper
    }

    /// The back end.
    pub fn motion(&mut self) -> &mut M {
        &mut self.motion
    }

    /// Energises the motor.
    pub fn enable(&mut self) -> Result<(), Fault<M::Error>> {
        match self.motion.enable() {
            Ok(()) => {
                self.enabled = true;
                Ok(())
            }
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Lets go of the motor, which must stand: a motor that moves is stopped dead, and its angle is lost.
    pub fn disable(&mut self) -> Result<(), Fault<M::Error>> {
        if self.stepper.is_moving() {
            self.stepper.halt(true);
        }
        self.enabled = false;
        let position = self.stepper.position();
        self.motion.disable().map_err(|error| Fault::Motion { error, position })
    }

    /// Starts the queued segments at `now`. Returns when the timer must fire first.
    pub fn start(&mut self, now: u64) -> Result<u64, Fault<M::Error>> {
        if !self.enabled {
            return Err(Fault::NotEnabled);
        }
        let due = self.stepper.start(now)?;
        self.late_ticks = None;
        Ok(due)
    }

    /// Decelerates; see [`Stepper::stop`]. The timer must fire at [`Stepper::next_deadline`] if that is earlier now.
    pub fn stop(&mut self, now: u64) -> StopPlan {
        self.stepper.stop(now)
    }

    /// The timer has fired: makes the step that is due.
    ///
    /// A call so late that the next step is due already would make steps in a burst that no motor follows: the motor
    /// is decelerated from there on instead, and then [`Fault::Late`] comes back. A call that is less late shifts no
    /// other step.
    #[inline]
    pub fn on_timer(&mut self, now: u64) -> Result<Timer, Fault<M::Error>> {
        let due = self.stepper.next_deadline().unwrap_or(now);
        match self.stepper.on_deadline(now) {
            Action::Step { dir, next } => {
                if let Err(fault) = self.motion.step(dir) {
                    self.stepper.halt(fault.made);
                    return Err(self.failed(fault.error));
                }
                if self.watching.is_some() {
                    self.look_at_index()?;
                }
                if next < now && self.stepper.is_moving() {
                    Ok(self.overrun(now, now - due))
                } else {
                    Ok(Timer::At(next))
                }
            }
            Action::Wait => Ok(self.stepper.next_deadline().map_or(Timer::Done, Timer::At)),
            Action::Starved => Err(Fault::Starved { position: self.stepper.position() }),
            Action::Done => match self.late_ticks {
                Some(late_ticks) => Err(Fault::Late { late_ticks, position: self.stepper.position() }),
                None => Ok(Timer::Done),
            },
        }
    }

    /// Notes at which position the index sensor becomes active, from now on. Costs a look at its pin a step.
    pub fn watch_index(&mut self) -> Result<(), Fault<M::Error>> {
        self.index_at = None;
        match self.motion.index() {
            Ok(active) => {
                self.watching = active;
                Ok(())
            }
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Position at which the index sensor last became active since [`Self::watch_index`].
    pub fn index_at(&self) -> Option<i64> {
        self.index_at
    }

    fn look_at_index(&mut self) -> Result<(), Fault<M::Error>> {
        match self.motion.index() {
            Ok(active) => {
                if active == Some(true) && self.watching == Some(false) {
                    self.index_at = Some(self.stepper.position());
                }
                self.watching = active;
                Ok(())
            }
            Err(error) => {
                self.stepper.halt(true);
                Err(self.failed(error))
            }
        }
    }

    #[cold]
    fn overrun(&mut self, now: u64, late_ticks: u64) -> Timer {
        self.late_ticks.get_or_insert(late_ticks);
        self.stepper.stop(now);
        // A way to rest that was planned or begun before is overdue too.
        if self.stepper.next_deadline().is_some_and(|next| next < now) {
            self.stepper.put_off(now);
        }
        Timer::At(self.stepper.next_deadline().unwrap_or(now))
    }

    /// Stands, and holds or lets go, as configured.
    #[cold]
    fn failed(&mut self, error: M::Error) -> Fault<M::Error> {
        if self.stepper.is_moving() {
            self.stepper.halt(true);
        }
        if self.on_fault == OnFault::Disable {
            self.enabled = false;
            // The first error is the one to tell.
            let _ = self.motion.disable();
        }
        self.fault(error)
    }

    fn fault(&self, error: M::Error) -> Fault<M::Error> {
        Fault::Motion { error, position: self.stepper.position() }
    }
}
