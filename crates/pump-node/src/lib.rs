//! The node: the board that makes the steps of doses which a host plans.
//!
//! The crate is a machine without I/O. Bytes and ticks go in; frames and edges of pins come out. It needs neither
//! `std` nor an allocator. A firmware is thin: it owns the pins, a timer and a serial port.
//!
//! - [`Axes`] is the half that the timer's interrupt uses: executors, pins, faults.
//! - [`Node`] is the half of the thread: it takes the bytes of its [`PORTS`], one of which has the session, and reaches
//!   the axes through [`Shared`] for short times.
//! - [`Pins`] and [`Board`] are the hardware.
//!
//! Nothing moves at power-up, after a reset, on a frame that fails its checksum, or on a version that is not known.
//! Until the host has configured an axis, its pins are inputs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

mod axes;
mod axis;
mod board;
mod driver;
mod node;
mod ports;
mod shared;

pub use axes::{Axes, LEAD_NS, MAX_STEP_HZ};
pub use axis::Axis;
pub use board::{Board, Edge, Levels, Pins};
pub use node::{Node, identity};
pub use ports::PORTS;
pub use shared::Shared;
