//! Claims about the Klipper driver, on a simulated board at the end of a pseudo-terminal.
//!
//! The board is written from the firmware's documentation, and shares no code with the driver.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod boards;
mod commands;
mod doses;
mod driver_chips;
mod faults;
#[path = "../../crates/pump-bench/tests/plans/flow.rs"]
mod flow;
mod flows;
mod kills;
mod mixed;
mod racks;
mod rig;
mod several;
#[allow(dead_code, reason = "each user of the board needs a part of it")]
#[path = "../../examples/simulated_klipper/simulated_klipper/mod.rs"]
mod simulated_klipper;
#[allow(dead_code, reason = "each user of the board needs a part of it")]
#[path = "../../examples/simulated_node/simulated_node/mod.rs"]
mod simulated_node;
