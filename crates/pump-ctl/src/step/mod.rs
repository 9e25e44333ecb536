//! The step executor: steps on time, in integers only, as a timer interrupt can afford.
//!
//! Deadlines are absolute, in ticks of the caller's timer, and carry their fraction. A late call delays one
//! step and shifts no other. The interrupt walks [`Segment`]s that were computed before. A [`Brake`] holds
//! the segments of a stop.
//!
//! ```
//! use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
//! use pump_ctl::step::{Action, Stepper};
//! use pump_model::Pump;
//!
//! const TICK_HZ: u32 = 1_000_000;
//! let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
//! let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
//! let plan = plan(&Pump::three_roller(), Phase::known(0.0), &request, &Limits::of_motor(motor))?;
//!
//! let mut stepper = Stepper::<64>::new(motor.brake(TICK_HZ));
//! for segment in plan.segments(TICK_HZ) {
//!     stepper.push(segment)?;
//! }
//! stepper.finish();
//! let mut due = stepper.start(0)?;
//! while let Action::Step { dir: _, next } = stepper.on_deadline(due) {
//!     due = next; // set the timer
//! }
//! assert_eq!(stepper.position(), 15_480);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod action;
mod brake;
mod error;
mod position;
mod queue;
mod retarget;
mod segment;
mod state;
mod stepper;
mod stop;
mod ticks;

pub use action::Action;
pub use brake::{BRAKE_ENTRIES, Brake};
pub use error::{PushError, StartError};
pub use retarget::Junction;
pub use segment::Segment;
pub use stepper::Stepper;
pub use stop::StopPlan;
