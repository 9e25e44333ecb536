//! The moves of the rotor that can be planned: a dose, a turn, a changed dose, a stop.

mod another_pump;
mod doser;
mod in_time;
mod offer;
mod plain_ramp;
mod retarget;
mod start;
mod stop;
mod turn;

pub use doser::Doser;
