//! The protocol of Klipper's firmware, as docs/Protocol.md of Klipper3d/klipper describes it.
//!
//! It is written for this board alone and shares nothing with the drive, so that an error of one is no error of both.

mod block;
mod message;
mod number;

pub(super) use block::{Heard, Inlet, framed};
pub(super) use message::{Argument, Shape};
