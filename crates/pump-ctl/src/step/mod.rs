//! The step executor: steps on time, in integers only, as a timer interrupt can afford.
//!
//! Deadlines are absolute, in ticks of the caller's timer, and carry their fraction. A late call delays one
//! step and shifts no other. The interrupt walks [`Segment`]s that were computed before. A [`Brake`] holds
//! the segments of a stop.
//!
//! ```
//! use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
//! use pump_ctl::step::{Action, Stepper, TickRate};
//! use pump_model::Pump;
//!
//! const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();
//! let motor = Motor::new(12_800.0, 17.8, 500.0);
//! let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
//! let plan = Doser::new(&Pump::three_roller(), Limits::new(motor))?.plan(Phase::known(0.0), &request)?;
//!
//! let mut stepper = Stepper::<64>::new(motor.brake(TICK_RATE)?);
//! for segment in plan.segments(TICK_RATE) {
//!     stepper.push(segment, TICK_RATE)?;
//! }
//! stepper.finish();
//! let mut due = stepper.start(0)?;
//! while let Action::Step { direction: _, next } = stepper.on_deadline(due) {
//!     due = next; // set the timer
//! }
//! assert_eq!(stepper.position(), 15_480);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod action;
mod braking;
mod direction;
mod end;
mod error;
mod feed;
mod position;
mod queue;
mod retarget;
mod segment;
mod state;
mod stepper;
mod stop;
mod tick_rate;
mod ticks;

pub use action::Action;
pub use braking::{BRAKE_ENTRIES, Brake, BrakeError};
pub use direction::Direction;
pub use error::{PushError, StartError};
pub use feed::Feed;
pub use retarget::Junction;
pub use segment::{Intervals, Segment, ValidSegment};
pub use stepper::Stepper;
pub use stop::StopPlan;
pub use tick_rate::TickRate;
pub use ticks::Ticks;
