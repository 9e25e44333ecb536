//! The speeds at which every board of grbl's family makes steps. They are known without a board.

/// Fewest steps per second of grbl 1.1: its 16-bit timer counts 2 MHz (16 MHz / 8).
pub(crate) const LEAST_STEPS_S: f64 = 16e6 / 8.0 / 65_536.0;

/// Most steps per second of grbl 1.1 (its documentation: 30 kHz).
pub(crate) const MOST_STEPS_S: f64 = 30_000.0;
