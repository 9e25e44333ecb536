//! Balances at a serial port.

mod line;
mod protocol;
mod serial_balance;

pub use line::{Framing, SerialLine};
pub use protocol::Protocol;
pub use serial_balance::SerialBalance;
