//! The link to a board: blocks that the board takes once and in order, or an error that says that it does not.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Message flow". The board takes blocks in the order of their sequence
//! numbers, and confirms each. Messages of the board are not sent again, so a question is asked anew.

mod grbl_report;
mod identify;
mod link;
#[cfg(test)]
mod peer;
mod resend_timer;
mod shared_trunk;
#[cfg(test)]
mod tests;
mod trunk;
mod window;

pub(super) use link::{Arrival, Link, Place};
pub(super) use shared_trunk::SharedTrunk;
