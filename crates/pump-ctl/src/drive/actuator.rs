//! A motor and its executor, driven from a timer's interrupt.

use super::error::Fault;
use super::step_motor::StepMotor;
use crate::step::{Action, Stepper, StopPlan};

/// The treatment of the motor when its back end fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OnFault {
    /// The motor stays energised. It holds its angle and the line's pressure.
    Hold,
    /// The motor is let go. The line may turn it, so its angle is no longer certain.
    Disable,
}

/// The next task of the timer.
///
/// The enum is exhaustive on purpose: a timer that misses a task loses steps, so a new one is a breaking change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Timer {
    /// The timer must fire at this tick.
    At(u64),
    /// The timer has no task. The motor stands, as planned or as the stop said.
    Done,
}

/// A motor that follows queued segments. `Q` segments fit into the queue of its [`Stepper`].
///
/// ```
/// use std::convert::Infallible;
///
/// use pump_ctl::drive::{Actuator, OnFault, StepMotor, Timer};
/// use pump_ctl::plan::Motor;
/// use pump_ctl::step::{Direction, Segment, Stepper, TickRate};
///
/// struct Axis {
///     made: i64,
/// }
///
/// impl StepMotor for Axis {
///     type Error = Infallible;
///     fn step(&mut self, direction: Direction) -> Result<(), Infallible> {
///         self.made += i64::from(direction.sign());
///         Ok(())
///     }
/// }
///
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
/// let stepper = Stepper::<4>::new(motor.brake(tick_rate)?);
/// let mut actuator = Actuator::new(Axis { made: 0 }, stepper, OnFault::Hold);
/// actuator.enable()?;
/// actuator.stepper().push(Segment { count: 5, interval: 2000, add: 0, frac: 0 }, tick_rate)?;
/// actuator.stepper().finish();
/// let mut due = actuator.start(0)?;
/// while let Timer::At(next) = actuator.on_timer(due)? {
///     due = next; // set the timer
/// }
/// let (axis, stepper) = actuator.release();
/// assert_eq!((axis.made, stepper.position(), due), (5, 5, 10_000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
// The executor comes last, because its queue is long, and an instruction reaches only the first 4 kB behind a pointer.
#[derive(Debug)]
#[repr(C)]
pub struct Actuator<M, const Q: usize> {
    /// Delay of the late call that made the motor stop, ticks.
    late_ticks: Option<u64>,
    /// Position at which the index sensor last became active.
    index_at: Option<i64>,
    /// Last state of the index sensor, if the sensor is read after every step.
    watching: Option<bool>,
    pub(super) enabled: bool,
    on_fault: OnFault,
    motor: M,
    stepper: Stepper<Q>,
}

impl<M: StepMotor, const Q: usize> Actuator<M, Q> {
    /// Makes an actuator of a motor at rest. The call does not energise the motor.
    pub fn new(motor: M, stepper: Stepper<Q>, on_fault: OnFault) -> Self {
        Self { motor, stepper, on_fault, enabled: false, late_ticks: None, watching: None, index_at: None }
    }

    /// Returns the executor, which takes segments and knows where the motor is and was.
    pub fn stepper(&mut self) -> &mut Stepper<Q> {
        &mut self.stepper
    }

    /// Returns the tick of the next step, or `None` if the motor stands.
    #[inline]
    pub fn next_deadline(&self) -> Option<u64> {
        self.stepper.next_deadline()
    }

    /// Returns true if steps are still to come.
    #[inline]
    pub fn is_moving(&self) -> bool {
        self.stepper.is_moving()
    }

    /// Returns the back end.
    pub fn motor(&mut self) -> &mut M {
        &mut self.motor
    }

    /// Gives back end and executor back. A motor that moves makes no further step, and stays energised.
    pub fn release(self) -> (M, Stepper<Q>) {
        (self.motor, self.stepper)
    }

    /// Energises the motor.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::Motor`] if the back end fails.
    pub fn enable(&mut self) -> Result<(), Fault<M::Error>> {
        match self.motor.enable() {
            Ok(()) => {
                self.enabled = true;
                Ok(())
            }
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Lets go of the motor, which must stand. A motor that moves is stopped dead, and its angle is lost.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::Motor`] if the back end fails.
    pub fn disable(&mut self) -> Result<(), Fault<M::Error>> {
        if self.stepper.is_moving() {
            self.stepper.halt(true);
        }
        self.enabled = false;
        let position = self.stepper.position();
        self.motor.disable().map_err(|error| Fault::Motor { error, position })
    }

    /// Starts the queued segments at `now`. Returns the tick at which the timer must fire first.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::NotEnabled`] if the motor is not energised. Fails with [`Fault::Start`] if no
    /// segment is queued, a move is under way, or the motor was stopped.
    pub fn start(&mut self, now: u64) -> Result<u64, Fault<M::Error>> {
        if !self.enabled {
            return Err(Fault::NotEnabled);
        }
        let due = self.stepper.start(now)?;
        self.late_ticks = None;
        Ok(due)
    }

    /// Decelerates the motor as [`Stepper::stop`] does. The timer must fire at [`Stepper::next_deadline`] if
    /// that is earlier now.
    pub fn stop(&mut self, now: u64) -> StopPlan {
        self.stepper.stop(now)
    }

    /// Makes the step that is due. Call it when the timer fires.
    ///
    /// A call may be so late that the next step is due already. Steps in a burst would follow, which no motor
    /// can make. The motor is decelerated instead, and then [`Fault::Late`] comes back. A call that is less
    /// late shifts no other step.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::Motor`] if the back end fails. Once the motor stands, it fails with
    /// [`Fault::Starved`] after a queue that ran dry, and with [`Fault::Late`] after a call that was too
    /// late.
    #[inline]
    pub fn on_timer(&mut self, now: u64) -> Result<Timer, Fault<M::Error>> {
        let due = self.stepper.next_deadline().unwrap_or(now);
        match self.stepper.on_deadline(now) {
            Action::Step { direction, next } => {
                if let Err(error) = self.motor.step(direction) {
                    self.stepper.halt(self.motor.made_its_step(&error));
                    return Err(self.failed(error));
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

    /// Records the position at which the index sensor becomes active, from now on. Each step then reads the
    /// sensor's pin once.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::Motor`] if the sensor cannot be read.
    pub fn watch_index(&mut self) -> Result<(), Fault<M::Error>> {
        self.index_at = None;
        match self.motor.index() {
            Ok(active) => {
                self.watching = active;
                Ok(())
            }
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Returns the position at which the index sensor last became active since [`Self::watch_index`].
    pub fn index_at(&self) -> Option<i64> {
        self.index_at
    }

    fn look_at_index(&mut self) -> Result<(), Fault<M::Error>> {
        match self.motor.index() {
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
        // A deceleration that was planned or begun before is overdue too.
        if self.stepper.next_deadline().is_some_and(|next| next < now) {
            self.stepper.put_off(now);
        }
        Timer::At(self.stepper.next_deadline().unwrap_or(now))
    }

    /// Stops the motor dead, and holds it or lets it go as configured.
    #[cold]
    fn failed(&mut self, error: M::Error) -> Fault<M::Error> {
        if self.stepper.is_moving() {
            self.stepper.halt(true);
        }
        if self.on_fault == OnFault::Disable {
            self.enabled = false;
            // The first error is the one to report.
            let _ = self.motor.disable();
        }
        self.fault(error)
    }

    fn fault(&self, error: M::Error) -> Fault<M::Error> {
        Fault::Motor { error, position: self.stepper.position() }
    }
}
