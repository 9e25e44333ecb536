//! The emulated board, its motor, and a host of several axes.

pub(crate) mod emulator;
pub(crate) mod host;
pub(crate) mod lockstep;
pub(crate) mod motor;
pub(crate) mod noise;
pub(crate) mod random;
