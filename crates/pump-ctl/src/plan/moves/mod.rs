//! The moves of the rotor that can be planned: a dose, a turn, a changed dose, a stop.

mod dose;
mod retarget;
mod start;
mod stop;
mod turn;

pub use dose::plan;
pub use turn::turn;
