//! Moves of the rotor, planned: a dose, a turn, the rest of a dose anew, a stop.

mod dose;
mod retarget;
mod start;
mod stop;
mod turn;

pub use dose::plan;
pub use turn::turn;
