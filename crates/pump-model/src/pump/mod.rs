//! The pump: a head with two lines, its presets, its runs and its steady state.

mod by_volume;
mod outflow_ripple;
pub(crate) mod presets;
pub(crate) mod pump;
mod runs;
pub(crate) mod steady_state;
