//! How the rotor moves, and the flow that its motion makes at the rollers.

pub(crate) mod flow;
pub(crate) mod leg;
pub(crate) mod ripple;
pub(crate) mod stretches;
pub(crate) mod walk;
