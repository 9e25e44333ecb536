//! The hydraulic line of one port and its exact solution.

pub(crate) mod exact_run;
pub(crate) mod extremes;
pub(crate) mod fine_steps;
pub(crate) mod friction;
pub(crate) mod line;
pub(crate) mod line_state;
pub(crate) mod oscillator;
pub(crate) mod outflow_ripple;
pub(crate) mod periodic_state;
pub(crate) mod propagator;
pub(crate) mod reach;
mod ringing;
pub(crate) mod runs;
pub(crate) mod settling;
mod turns;
