//! Exact sensitivities of a line's state to its parameters and to the flow, in one solve with the state.

mod augmented;
pub(crate) mod parameter;
mod propagator;
mod reach;
pub(crate) mod run;
pub(crate) mod samples;
#[cfg(feature = "identification")]
pub(crate) mod series;
mod short_steps;
pub(crate) mod state;
mod steady;
