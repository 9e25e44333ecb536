//! The plan of a dose: from a volume to angle, speed profile, step times and predicted pressures.
//!
//! Each room names only the rooms before it. They are, in order:
//!
//! - `words`: choices, request, refusals;
//! - `profile`: speed over angle;
//! - `target`: steps for a volume;
//! - this folder: [`Plan`], its steps and segments;
//! - `prediction`: pressures, settling and back flow;
//! - `limits`: motor, pressures, torque, margins;
//! - `speed`: the cruise speed that is asked for or allowed;
//! - `ramps`: the ramps that leave the line nearly at rest;
//! - `moves`: dose, turn, retarget, stop;
//! - `flow`: a flow over time.

mod flow;
mod handover;
mod limits;
mod line_states;
mod moves;
mod plan;
mod planned_motion;
mod prediction;
mod profile;
mod ramps;
mod ripple;
mod segments;
mod speed;
mod steps;
mod target;
mod volumes;
mod words;

pub use flow::{
    FlowError, FlowKnot, FlowLegs, FlowMotion, FlowPace, FlowPlan, FlowRow, FlowSegments, FlowStretch,
};
pub use handover::Handover;
pub use limits::{
    Limits, Lowest, Margin, Margins, Motor, PressureLimits, TORQUE_POINTS, Torque, TorqueCurve,
};
pub use moves::Doser;
pub use plan::Plan;
pub use planned_motion::{MotionSegments, PlannedMotion};
pub use prediction::Prediction;
pub use profile::{Legs, Profile};
pub use ripple::Ripples;
pub use segments::Segments;
pub use speed::{MAX_DURATION_S, speed_for_flow};
pub use steps::{Step, Steps};
pub use target::MAX_STEPS;
pub use words::{
    Allowed, Cruise, Finish, LimitedBy, MAX_VOLUME_ML, Nearest, Phase, PlanError, Ramps, Request, Retarget,
    SetBy, Turned, UnknownName,
};
