//! Motions of the rotor, and the flow that they make at the rollers.

pub(crate) mod flow;
mod harmonics;
pub(crate) mod leg;
pub(crate) mod ripple;
pub(crate) mod stretches;
pub(crate) mod walk;
