//! The drive of a motor that makes one step at a time, each at the plan's time.

use std::fmt::{self, Debug, Formatter};
use std::panic::resume_unwind;
use std::thread;
use std::time::Duration;

use pump_ctl::drive::{Actuator, Clock, Fault, OnFault, StepMotor, Timer};
use pump_ctl::plan::{Motor, Plan};
use pump_ctl::step::{Brake, BrakeError, Feed, Segment, Stepper, TickRate};
use thiserror::Error;

use super::lead::{Ends, Lead};
use super::pace::steps_from;
use super::watched_motor::WatchedMotor;
use crate::drives::{Abilities, Disturbance, Drive, DriveError, DriveFault, Gate, IndexSearch};

/// Steps that are queued ahead of the motor. A stop begins after them.
const QUEUE: usize = 8;

/// Time between two questions to the gate.
const POLL: Duration = Duration::from_millis(5);

/// Time between two looks of a motor at rest for leave.
const LOOK: Duration = Duration::from_millis(1);

/// Time at the fastest speed for which there is leave ahead of the motor, beyond the way in which it stops, in s.
const AHEAD_S: f64 = 0.5;

/// Error of a motor that makes one step at a time, besides the [`Fault`]s of the motor itself.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SteppedError {
    /// The timer is too slow for the dose.
    #[error(
        "the dose needs up to {steps_s:.0} steps a second, and the timer has {tick_hz} ticks a second; use a \
         timer of 2 ticks a step or more, or dose more slowly"
    )]
    SlowTimer {
        /// Most steps per second of the plan.
        steps_s: f64,
        /// Ticks per second of the timer.
        tick_hz: u32,
    },
    /// The motor's way to rest cannot be computed.
    #[error(transparent)]
    Brake(#[from] BrakeError),
}

/// Drive of a motor that makes one step at a time: step and direction pins ([`pump_ctl::drive::StepDir`]), a bus, or
/// anything else that is a [`StepMotor`].
///
/// A thread makes the steps and turns with `clock` until each is due, so a core of the processor is busy as long as
/// the motor moves. It should have a priority of real time. A step that comes so late that the next one is due ends
/// the motion by [`Fault::Late`], with the steps counted. The thread that runs the dose asks the gate meanwhile. Steps
/// that the journal has not announced in time make the motor slow down, or rest before them.
///
/// An error of the motor is the source of the drive's error, as a [`Fault`] of [`StepMotor::Error`].
///
/// ```
/// use std::convert::Infallible;
/// use std::ops::ControlFlow;
///
/// use pump_bench::drives::{MonotonicClock, Stepped};
/// use pump_bench::{Bench, DoseRequest, Session, built_in};
/// use pump_ctl::drive::{Clock, StepMotor};
/// use pump_ctl::step::{Direction, TickRate};
///
/// struct Pins {
///     made: i64,
/// }
///
/// impl StepMotor for Pins {
///     type Error = Infallible;
///     fn step(&mut self, direction: Direction) -> Result<(), Infallible> {
///         self.made += i64::from(direction.sign());
///         Ok(())
///     }
/// }
/// # struct Patient(u64);
/// # impl Clock for Patient {
/// #     fn now(&mut self) -> u64 {
/// #         self.0 += 1;
/// #         self.0
/// #     }
/// # }
///
/// let tick_rate = TickRate::from_hz(1_000_000).unwrap();
/// let clock = MonotonicClock::new(tick_rate);
/// # let clock = Patient(0); // a doctest may be interrupted for longer than a step
/// let mut drive = Stepped::new("pins", Pins { made: 0 }, clock, tick_rate)?;
/// let state = tempfile::tempdir()?;
/// let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?.driven_by(&drive)?;
/// let bench = bench.confirming_pump(true); // the pins turn the head of the built-in pump
/// let mut session = Session::with_drive(&bench, Box::new(&mut drive))?;
/// let prepared = session.prepare(DoseRequest::dose(0.1))?;
/// assert!(session.run(&prepared, |_steps| ControlFlow::Continue(()))?.completed);
/// drop(session);
/// assert!(drive.into_parts().0.made > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Stepped<M, C> {
    id: String,
    motor: M,
    clock: C,
    tick_rate: TickRate,
    has_index: bool,
    disturbed: Option<Disturbance>,
}

impl<M, C> Debug for Stepped<M, C> {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_struct("Stepped")
            .field("id", &self.id)
            .field("tick_rate", &self.tick_rate)
            .field("has_index", &self.has_index)
            .field("disturbed", &self.disturbed)
            .finish_non_exhaustive()
    }
}

impl<M: StepMotor<Error: Send + Sync + 'static>, C: Clock> Stepped<M, C> {
    /// Makes the drive `id` of a motor at rest and a clock of this rate. [`Drive::id`] says which names are allowed.
    /// The motor is energised for its first motion, and holds from then on.
    ///
    /// # Errors
    ///
    /// [`DriveError::Device`] if the motor has an index sensor that cannot be read.
    pub fn new(id: &str, mut motor: M, clock: C, tick_rate: TickRate) -> Result<Self, DriveError> {
        let read = motor.index().map_err(|error| DriveError::device(Fault::Motor { error, position: 0 }));
        let has_index = read?.is_some();
        Ok(Self { id: id.to_owned(), motor, clock, tick_rate, has_index, disturbed: None })
    }

    /// Gives motor and clock back. The motor stays energised.
    pub fn into_parts(self) -> (M, C) {
        (self.motor, self.clock)
    }

    /// Returns the brake for `plan`, by which the motor stops if steps come late.
    fn brake(&self, plan: &Plan) -> Result<Brake, SteppedError> {
        let steps_s = plan.profile().peak_rad_s() / plan.step_rad();
        if 2.0 * steps_s > f64::from(self.tick_rate.hz()) {
            return Err(SteppedError::SlowTimer { steps_s, tick_hz: self.tick_rate.hz() });
        }
        let motor = Motor::new(
            plan.steps_per_rev(),
            plan.profile().peak_rad_s(),
            plan.profile().acceleration_rad_s2(),
        );
        Ok(motor.brake(self.tick_rate)?)
    }
}

/// Motion under way.
struct Motion<'a> {
    plan: &'a Plan,
    brake: Brake,
    lead: &'a Lead,
    seeks: bool,
}

impl Motion<'_> {
    /// Returns the number of steps of the plan.
    fn all(&self) -> u64 {
        self.plan.steps().unsigned_abs()
    }

    /// Returns the number of steps to have leave for ahead of the motor.
    fn ahead(&self) -> u64 {
        let (peak_rad_s, acceleration_rad_s2) =
            (self.plan.profile().peak_rad_s(), self.plan.profile().acceleration_rad_s2());
        let stop_rad = peak_rad_s * peak_rad_s / (2.0 * acceleration_rad_s2);
        ((stop_rad + AHEAD_S * peak_rad_s) / self.plan.step_rad()).ceil() as u64 + QUEUE as u64
    }

    /// Makes the steps that have leave, until the plan is done or the lead stops. Returns the number of steps made,
    /// with the fault that ended the motion.
    fn make<M: StepMotor>(
        &self,
        motor: &mut M,
        clock: &mut impl Clock,
    ) -> (u64, Result<(), Fault<M::Error>>) {
        let watched = match WatchedMotor::new(motor, self.lead, self.seeks) {
            Ok(watched) => watched,
            Err(error) => return (0, Err(Fault::Motor { error, position: 0 })),
        };
        let mut actuator = Actuator::new(watched, Stepper::<QUEUE>::new(self.brake), OnFault::Hold);
        let ended = self.go_on(&mut actuator, clock);
        (actuator.stepper().position().unsigned_abs(), ended)
    }

    /// Goes on from rest to rest.
    fn go_on<M: StepMotor>(
        &self,
        actuator: &mut Actuator<M, QUEUE>,
        clock: &mut impl Clock,
    ) -> Result<(), Fault<M::Error>> {
        actuator.enable()?;
        let tick_rate = self.brake.tick_rate();
        loop {
            let made = actuator.stepper().position().unsigned_abs();
            if made >= self.all() || self.lead.stops() {
                return Ok(());
            }
            if self.lead.left() > made && actuator.stepper().clear() {
                let mut steps = Feed::new(tick_rate, steps_from(self.plan, tick_rate, self.lead, made));
                if let Some(late_ticks) = self.step(actuator, clock, &mut steps)? {
                    return Err(Fault::Late { late_ticks, position: actuator.stepper().position() });
                }
            } else {
                thread::sleep(LOOK);
            }
        }
    }

    /// Makes `steps` from rest to rest. Returns the delay of a step that came so late that the next one was due.
    ///
    /// The steps after such a step come as much later. They are those that have leave, and slow down to rest within
    /// it: the brake of the actuator is weaker than the plan, so its way to rest may lead beyond.
    fn step<M: StepMotor>(
        &self,
        actuator: &mut Actuator<M, QUEUE>,
        clock: &mut impl Clock,
        steps: &mut Feed<impl Iterator<Item = Segment>>,
    ) -> Result<Option<u64>, Fault<M::Error>> {
        // The motion may have been ended meanwhile.
        if steps.peek().is_none() {
            return Ok(None);
        }
        actuator.stepper().fill(steps)?;
        let mut due = actuator.start(clock.now())?;
        let (mut lost, mut late) = (0, None);
        loop {
            let now = clock.now().saturating_sub(lost);
            if now < due {
                continue;
            }
            match actuator.on_timer(due)? {
                Timer::Done => return Ok(late),
                Timer::At(next) => {
                    if next < now && actuator.stepper().is_moving() {
                        late.get_or_insert(now - due);
                        lost += now - due;
                        self.lead.stop();
                    }
                    due = next;
                }
            }
            actuator.stepper().fill(steps)?;
        }
    }
}

impl<M: StepMotor<Error: Send + Sync + 'static> + Send, C: Clock + Send> Stepped<M, C> {
    /// Makes the steps of `plan` in a thread of their own, and asks `gate` in this one.
    fn travel(&mut self, plan: &Plan, gate: &mut Gate<'_>, seeks: bool) -> Result<IndexSearch, DriveFault> {
        let brake = self.brake(plan).map_err(|error| DriveFault::at(0, DriveError::device(error)))?;
        let lead = Lead::new();
        let motion = Motion { plan, brake, lead: &lead, seeks };
        let (motor, clock) = (&mut self.motor, &mut self.clock);
        let (made, ended) = thread::scope(|scope| {
            let thread = thread::Builder::new().name("steps".to_owned());
            let makes = thread
                .spawn_scoped(scope, || motion.make(motor, clock))
                .map_err(|error| DriveFault::at(0, DriveError::device(error)))?;
            let ends = Ends(&lead);
            while !makes.is_finished() {
                lead.ask(gate, motion.all(), motion.ahead());
                thread::sleep(POLL);
            }
            drop(ends);
            makes.join().map_or_else(|panic| resume_unwind(panic), Ok)
        })?;
        ended.map_err(|fault| DriveFault::at(made as i64, DriveError::device(fault)))?;
        Ok(IndexSearch { made, beyond: lead.index_at().map(|at| made - at) })
    }
}

impl<M: StepMotor<Error: Send + Sync + 'static> + Send, C: Clock + Send> Drive for Stepped<M, C> {
    fn id(&self) -> &str {
        &self.id
    }

    fn abilities(&self) -> Abilities {
        Abilities::new()
            .with_step_times(true)
            .with_angle_dependent_speed(true)
            .with_index(self.has_index)
            .with_release(true)
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        self.disturbed.take()
    }

    fn check(&mut self, plan: &Plan) -> Result<(), DriveError> {
        self.brake(plan).map(drop).map_err(DriveError::device)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(plan, gate, false).map(|search| search.made)
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        if !self.has_index {
            return Err(DriveFault::at(0, DriveError::no_index(&self.id)));
        }
        self.travel(plan, gate, true)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        self.disturbed = Some(Disturbance::Disabled);
        self.motor.disable().map_err(|error| DriveError::device(Fault::Motor { error, position: 0 }))
    }
}
