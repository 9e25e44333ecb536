//! The errors of a board with the Klipper firmware.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::clock::ClockError;
use super::dictionary::DictionaryError;
use super::protocol::MessageError;
use crate::drives::DriveError;
use crate::drives::wire::{PortError, PortFault};

/// Error of a board with the Klipper firmware.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum KlipperError {
    /// No serial port is named.
    #[error("no serial port is named for the board")]
    NoPort,
    /// The port cannot be opened.
    #[error("{} cannot be opened as a serial port: {fault}", .port.display())]
    Open {
        /// Path of the port.
        port: PathBuf,
        /// Fault of the port.
        fault: PortFault,
    },
    /// Another process has the port.
    #[error("{} is in use by {holder}; wait until it is done", .device.display())]
    Busy {
        /// Path of the port.
        device: PathBuf,
        /// Holder of the port, as far as the system tells.
        holder: String,
    },
    /// Nothing answers at the port.
    #[error(
        "no board answers at {} within {waited_s:.0} s at {baud} baud; check the port, the board's power, and \
         [drive] baud", .port.display()
    )]
    Silent {
        /// Path of the port.
        port: PathBuf,
        /// Rate of the port, in bits per second.
        baud: u32,
        /// Time for which the board was asked, in s.
        waited_s: f64,
    },
    /// Another firmware is at the port.
    #[error(
        "something answers at {} with {bytes} bytes at {baud} baud, and they are no block of the Klipper firmware; \
         check the port, [drive] baud, and that the board runs this firmware",
        .port.display()
    )]
    Foreign {
        /// Path of the port.
        port: PathBuf,
        /// Rate of the port, in bits per second.
        baud: u32,
        /// Number of bytes that came.
        bytes: u64,
    },
    /// The board's dictionary cannot be used.
    #[error(transparent)]
    Dictionary(#[from] DictionaryError),
    /// A message cannot be written or read.
    #[error(transparent)]
    Message(#[from] MessageError),
    /// The board's clock cannot be followed.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// The board has not confirmed what it was sent.
    #[error("the board has confirmed nothing for {waited_s:.1} s; check its cable and power")]
    Quiet {
        /// Time without a confirmation, in s.
        waited_s: f64,
    },
    /// The line damages what is sent.
    #[error(
        "the board has confirmed nothing for {waited_s:.1} s, and {corrupt} blocks of it failed their checksum; check \
         the cable, its shield, and [drive] baud"
    )]
    Garbled {
        /// Time without a confirmation, in s.
        waited_s: f64,
        /// Number of blocks whose checksum failed meanwhile.
        corrupt: u64,
    },
    /// The board is at another block than this program.
    #[error(
        "the board has confirmed nothing for {waited_s:.1} s and asks for block {told} of 16, which is none of \
         those under way: it was reset, or another program has taken it"
    )]
    OutOfStep {
        /// Time without a confirmation, in s.
        waited_s: f64,
        /// Number of the block that the board asks for, modulo 16.
        told: u8,
    },
    /// A question was not answered.
    #[error("the board has not answered `{question}` for {waited_s:.1} s; check its cable and power")]
    NoAnswer {
        /// Name of the command that asks.
        question: String,
        /// Time without an answer, in s.
        waited_s: f64,
    },
    /// The board has shut itself down.
    #[error("the board has shut itself down: {reason}; its motors are without steps until it is reset")]
    Shutdown {
        /// Reason, in the words of the firmware.
        reason: String,
    },
    /// The board was reset.
    #[error("the board was reset, or lost its supply for a moment; its motor may have moved")]
    Reset,
    /// The board is configured otherwise than it should be.
    #[error(
        "the board has another configuration ({found:08x}) than this pump needs ({wanted:08x}), and another program \
         may use it; have it reset, or switch it off and on"
    )]
    Configured {
        /// Checksum of the configuration that the board has.
        found: u32,
        /// Checksum of the configuration that is needed.
        wanted: u32,
    },
    /// The connection to the board broke.
    #[error("the connection to the board broke")]
    Gone(#[source] io::Error),
    /// The user asked to stop while the board was at rest.
    #[error("stopped by the user before anything moved")]
    Interrupted,
}

impl From<KlipperError> for DriveError {
    fn from(error: KlipperError) -> Self {
        match error {
            KlipperError::Interrupted => Self::Interrupted,
            KlipperError::Busy { device, holder } => Self::Busy { device, holder },
            error => Self::Device(Box::new(error)),
        }
    }
}

impl From<PortError> for KlipperError {
    fn from(error: PortError) -> Self {
        match error {
            PortError::Unnamed => Self::NoPort,
            PortError::Busy { device, holder } => Self::Busy { device, holder },
            PortError::Open { port, fault } => Self::Open { port, fault },
        }
    }
}
