//! The errors of a board with the Klipper firmware.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::dictionary::DictionaryError;
use super::protocol::MessageError;
use super::refit::RefitError;
use super::tmc::TmcError;
use crate::drives::board_clock::ClockError;
use crate::drives::known_board::{BoardError, PlaceTaken, pump_in_words};
use crate::drives::wire::{PortError, PortFault};
use crate::drives::{CommonBeginError, DriveError};

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
    /// Another motor of this process has lost the board and found it anew, and this one's commands with it.
    #[error(
        "the line to the board was begun anew for another pump of it, which had lost it; check its cable and power"
    )]
    FoundAnew,
    /// A question was not answered.
    #[error("the board has not answered `{question}` for {waited_s:.1} s; check its cable and power")]
    NoAnswer {
        /// Name of the command that asks.
        question: String,
        /// Time without an answer, in s.
        waited_s: f64,
    },
    /// The board has shut itself down.
    #[error(
        "the board has shut itself down: {reason}{}; its motors are without steps until it is reset",
        meaning(reason)
    )]
    Shutdown {
        /// Reason, in the words of the firmware.
        reason: String,
    },
    /// The board was reset.
    #[error("the board was reset, or lost its supply for a moment; its motor may have moved")]
    Reset,
    /// The board is configured otherwise than it should be.
    #[error("the board has a configuration that is not on record, and another program may use it")]
    Configured {
        /// Checksum of the configuration that the board has.
        found: u32,
        /// Checksum of the configuration that is needed.
        wanted: u32,
    },
    /// The pump's motor was refused after the board was reset to configure it for this pump.
    #[error("{error}; {others}")]
    AfterReset {
        /// Refusal.
        error: Box<Self>,
        /// Words for the board's other motors, and for what has befallen them.
        others: String,
    },
    /// The pump file names no pins.
    #[error(
        "no pins of the board are named for this pump, and a built-in pump names none; a pump file names them in the \
         table [drive.klipper], as step = \"PB13\", with dir, and enable where the motor has one"
    )]
    NoPins,
    /// The board would have to be configured anew, and turns another pump of this process.
    #[error(
        "the board at {} turns another pump of this program, and is configured without the pins of this one, which \
         only a reset changes; run one after the other once, or name both in one rack", .port.display()
    )]
    Shared {
        /// Path of the port.
        port: PathBuf,
    },
    /// Drives of this process use the port at another rate.
    #[error(
        "{} is open at {open_baud} baud for another pump, and this one names {baud}; give the pumps of a board the \
         same [drive] baud", .port.display()
    )]
    Rate {
        /// Path of the port.
        port: PathBuf,
        /// Rate that this pump names, in bits per second.
        baud: u32,
        /// Rate of the port, in bits per second.
        open_baud: u32,
    },
    /// The place on the board turns another pump by the record.
    #[error(transparent)]
    PlaceTaken(Box<PlaceTaken>),
    /// Another firmware than Klipper's is on the board.
    #[error("the board at {} runs the firmware {app:?}, and this driver needs Klipper's; load that", .port.display())]
    OtherFirmware {
        /// Path of the port.
        port: PathBuf,
        /// Name of the firmware.
        app: String,
    },
    /// Another board than the one on record is at the port.
    #[error(
        "another board is at {} than the one of {}: found {found}, and on record is {recorded}; check the port",
        .port.display(), pump_in_words(.pump.as_deref())
    )]
    OtherBoard {
        /// Path of the port.
        port: PathBuf,
        /// Id of the pump.
        pump: Option<String>,
        /// Words for the board at the port.
        found: String,
        /// Words for the board on record.
        recorded: String,
    },
    /// The record of the board cannot be used.
    #[error("the record of the board in {} cannot be {action}: {reason}", .record.display())]
    BoardRecord {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
    /// The record of the board's session cannot be used.
    #[error("the record of the board's session in {} cannot be {action}: {reason}", .record.display())]
    SessionRecord {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
    /// Something else moves the motor.
    #[error(
        "the board has been moving its motor for {waited_s:.0} s without being told to by this program; stop what \
         moves it"
    )]
    Moving {
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The board does not forget its configuration.
    #[error("the board was told to reset, and still has its configuration; switch it off and on")]
    NoReset,
    /// The stepper driver has a fault, or does not answer.
    #[error(transparent)]
    Driver(#[from] TmcError),
    /// The steps of a plan are none that the board makes.
    #[error(transparent)]
    Steps(#[from] RefitError),
    /// The plan has more commands than the board's queue holds.
    #[error(
        "the plan has {commands} commands within {within_s} s, and the board's queue of {slots} has room for {room} of \
         them; dose more slowly, or use a board with more memory"
    )]
    Queue {
        /// Most commands of the plan within that time.
        commands: usize,
        /// Time for which the queue is filled, in s.
        within_s: f64,
        /// Commands that the queue holds for all motors of the board.
        slots: u16,
        /// Commands that it holds of a plan. Some slots stay free.
        room: u16,
    },
    /// The plan needs more bytes than the line carries.
    #[error(
        "the plan needs {needed_bytes_s} bytes/s, and the line carries {allowed_bytes_s} of them; raise the rate of \
         the port in the firmware and in [drive] baud, or dose more slowly"
    )]
    Line {
        /// Bytes a second that the plan needs.
        needed_bytes_s: u32,
        /// Bytes a second that commands of steps may take.
        allowed_bytes_s: u32,
    },
    /// The board's count differs from the steps made.
    #[error("the board counts {counted} steps where {expected} were expected: the rotor's angle is unknown")]
    Count {
        /// Count that the board reports, in steps.
        counted: i64,
        /// Count that was expected, in steps.
        expected: i64,
    },
    /// The board ran out of steps at speed.
    #[error(
        "the board ran out of steps while the motor turned, because this program was held up or the line was late; the \
         motor stopped without a ramp; check its cable, and what held this computer up"
    )]
    HeldUp,
    /// The motor cannot begin together with others.
    #[error(transparent)]
    Common(#[from] CommonBeginError),
    /// A flow over time came to rest on its way, because its steps did not reach the board in time.
    #[error(
        "the flow over time came to rest on its way; this computer or the line was late, and a flow that has paused \
         cannot go on"
    )]
    FlowPaused,
    /// The index sensor answered from the begin of a search to its end.
    #[error(
        "the index sensor answered all the way; check its wiring and the disc, and the marks `!` and `^` before its \
         pin in [drive.klipper] index"
    )]
    IndexStays,
    /// The board heard nothing of this program for too long, and stopped the motor.
    #[error(
        "the board stopped the motor because it heard nothing of this program for {dead_man_ms} ms; check its cable, \
         and what held this computer up"
    )]
    DeadMan {
        /// Time without a word, in ms.
        dead_man_ms: u128,
    },
    /// The connection to the board broke.
    #[error("the connection to the board broke")]
    Gone(#[source] io::Error),
    /// The user asked to stop while the board was at rest.
    #[error("stopped by the user before anything moved")]
    Interrupted,
}

impl KlipperError {
    /// Returns true if the link has ended with the error, and the board may still be there.
    pub(super) fn ends_link(&self) -> bool {
        matches!(
            self,
            Self::Gone(_)
                | Self::Quiet { .. }
                | Self::Garbled { .. }
                | Self::OutOfStep { .. }
                | Self::FoundAnew
                | Self::NoAnswer { .. }
        )
    }

    /// Returns true if the motor is without current after this error.
    pub(crate) fn cuts_current(&self) -> bool {
        matches!(
            self,
            Self::Shutdown { .. }
                | Self::Driver(TmcError::Off { .. } | TmcError::Reset { .. } | TmcError::Disabled { .. })
        )
    }

    /// Returns the error of a meeting that has reset the board, with what became of its other motors.
    pub(super) fn after_reset(self, others: &[String]) -> Self {
        if others.is_empty() {
            return self;
        }
        Self::AfterReset { error: Box::new(self), others: others.join("; ") }
    }

    /// Returns true if nobody knows whether the motor holds after this error.
    pub(crate) fn hides_motor(&self) -> bool {
        self.ends_link() || matches!(self, Self::Reset)
    }

    /// Returns true for a refusal of this program: no board was asked, or none has refused.
    fn is_of_this_program(&self) -> bool {
        if let Self::AfterReset { error, .. } = self {
            return error.is_of_this_program();
        }
        matches!(
            self,
            Self::NoPort
                | Self::Open { .. }
                | Self::NoPins
                | Self::Shared { .. }
                | Self::Rate { .. }
                | Self::OtherFirmware { .. }
                | Self::OtherBoard { .. }
                | Self::PlaceTaken(_)
                | Self::BoardRecord { .. }
                | Self::SessionRecord { .. }
                | Self::Configured { .. }
                | Self::Dictionary(_)
                | Self::Steps(_)
                | Self::Queue { .. }
                | Self::Line { .. }
                | Self::Driver(TmcError::Setting { .. })
        )
    }

    /// Returns true if the board's clock or this computer's has jumped.
    pub(super) fn is_of_clock(&self) -> bool {
        matches!(self, Self::Clock(ClockError::Jump { .. }))
    }

    /// Returns true if the rotor's angle is unknown after this error.
    pub(super) fn loses(&self) -> bool {
        matches!(self, Self::Count { .. }) || self.is_of_driver()
    }

    /// Returns true if the motor was stopped without a ramp where its steps ended.
    pub(super) fn halts(&self) -> bool {
        matches!(self, Self::HeldUp | Self::DeadMan { .. })
    }

    /// Returns true if the stepper driver has lost the motor's current, or nobody knows whether it has.
    pub(super) fn is_of_driver(&self) -> bool {
        matches!(self, Self::Driver(error) if !matches!(error, TmcError::Setting { .. }))
    }
}

impl From<BoardError> for KlipperError {
    fn from(error: BoardError) -> Self {
        match error {
            BoardError::Other { port, pump, found, recorded } => {
                Self::OtherBoard { port, pump, found, recorded }
            }
            BoardError::Taken(taken) => Self::PlaceTaken(taken),
            BoardError::Record { action, record, reason } => Self::BoardRecord { action, record, reason },
        }
    }
}

impl From<KlipperError> for DriveError {
    fn from(error: KlipperError) -> Self {
        match error {
            KlipperError::Interrupted => Self::Interrupted,
            KlipperError::Busy { device, holder } => Self::Busy { device, holder },
            error if error.is_of_this_program() => Self::Refused(Box::new(error)),
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

/// Returns what a reason of the firmware means, where it does not say so to a person: the texts are those of its
/// `src/sched.c` and `src/stepper.c`.
fn meaning(reason: &str) -> &'static str {
    match reason {
        "Timer too close" | "Rescheduled timer in the past" | "Stepper too far in past" => {
            " (a step came too late: this computer or the line was held up)"
        }
        "Move queue overflow" => " (more steps were queued than it holds)",
        _ => "",
    }
}
