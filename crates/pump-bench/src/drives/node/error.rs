//! The errors of a node.

use std::io;
use std::path::PathBuf;

use pump_ctl::step::BrakeError;
use pump_link::frame::VERSION;
use pump_link::message::Refusal;
use pump_link::sender::{StreamError, TooFast, WindowError};
use thiserror::Error;

use crate::drives::known_board::{BoardError, PlaceTaken, pump_in_words};
use crate::drives::wire::{PortError, PortFault};
use crate::drives::{CommonBeginError, DriveError};
use crate::pump_file::Axis;

/// Error of a node: a board that makes each step at the plan's time.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NodeError {
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
    /// Something else than a node is at the port.
    #[error(
        "something answers at {} with {bytes} bytes at {baud} baud, and they are no frame of the board's \
         firmware; check the port, [drive] baud, and that the board runs the firmware of the driver node",
        .port.display()
    )]
    Foreign {
        /// Path of the port.
        port: PathBuf,
        /// Rate of the port, in bits per second.
        baud: u32,
        /// Number of bytes that came.
        bytes: usize,
    },
    /// The firmware speaks another version of the protocol.
    #[error(
        "the firmware of the board at {} speaks version {theirs} of the protocol, and this program speaks {VERSION}: \
         {} is the older",
        .port.display(), if *theirs < VERSION { "the firmware" } else { "this program" }
    )]
    Version {
        /// Path of the port.
        port: PathBuf,
        /// Version that the board speaks.
        theirs: u8,
    },
    /// Another board is at the port than the one on record.
    #[error(
        "the board at {} is {found}, and the record of {} is of {recorded}; connect that board, or name its port",
        .port.display(), pump_in_words(pump.as_deref())
    )]
    OtherBoard {
        /// Path of the port.
        port: PathBuf,
        /// Id of the pump whose record it is. `None` if the drive was opened for no pump of a bench.
        pump: Option<String>,
        /// Board at the port, as the message words it.
        found: String,
        /// Board on record, as the message words it.
        recorded: String,
    },
    /// The place on the board turns another pump by the record.
    #[error(transparent)]
    PlaceTaken(Box<PlaceTaken>),
    /// The record of the pump's board cannot be used.
    #[error("the record of the pump's board cannot be {action}: {reason} ({})", .record.display())]
    BoardRecord {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
    /// Another process has the board, through another port.
    #[error("{} is in use by {holder}; wait until it is done", .device.display())]
    Busy {
        /// Board, and its port.
        device: PathBuf,
        /// Holder of the board, as far as the system tells.
        holder: String,
    },
    /// This process has a board of the same number at another port.
    #[error(
        "the boards at {} and {} tell one number, {board:016x}: one board has two ports, or two boards have one \
         number; name one port for all pumps of a board, and use boards of different numbers", .other.display(),
        .port.display()
    )]
    OneNumber {
        /// Number that both tell.
        board: u64,
        /// Port of the board that was met last.
        port: PathBuf,
        /// Port of the board that this process has.
        other: PathBuf,
    },
    /// The board lacks the axis.
    #[error("the board has {axes} axes, and [drive] axis is {axis:?}; its axes 0 to 3 are X, Y, Z and A")]
    NoAxis {
        /// Letter of the axis.
        axis: char,
        /// Number of axes of the board.
        axes: u8,
    },
    /// A plan is for an axis that was not opened, or for one that has a plan.
    #[error("axis {place} of {axes} was not opened, or has a plan already; name each axis once, from 0")]
    Place {
        /// Place of the axis among those that were opened, from 0.
        place: usize,
        /// Number of axes.
        axes: usize,
    },
    /// Two pumps name one axis.
    #[error("two pumps name the axis {axis} of the board; give each pump an axis of its own")]
    Twice {
        /// Axis.
        axis: Axis,
    },
    /// The pumps of a board name different ports.
    #[error(
        "the pump of axis {axis} is at {}, and others are at another port; axes that begin together are of one \
         board", .port.display()
    )]
    Elsewhere {
        /// Axis.
        axis: Axis,
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
    /// Axes that are to begin together do not begin.
    #[error(transparent)]
    Common(#[from] CommonBeginError),
    /// The axes together need more than the line carries.
    #[error(
        "the plan needs {needed_bytes_s} bytes a second of the line to the board, and the other axes leave \
         {free_bytes_s} of {all_bytes_s}; dose more slowly, or one after another"
    )]
    LineFull {
        /// Rate that the plan needs where it needs most, bytes a second.
        needed_bytes_s: u32,
        /// Rate that the other axes leave, bytes a second.
        free_bytes_s: u32,
        /// Rate that the line carries for all axes, bytes a second.
        all_bytes_s: u32,
    },
    /// The board says that its timer stands.
    #[error("the board says that its timer has 0 ticks a second; load its firmware anew")]
    NoTimer,
    /// The record of the board and its session cannot be used.
    #[error("the record of the board's session cannot be {action}: {reason} ({})", .record.display())]
    SessionRecord {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
    /// The motor's way to rest cannot be computed for the board's timer.
    #[error("the motor's brake cannot be made for the board's timer")]
    Brake(#[from] BrakeError),
    /// The dose needs more steps per second than the board makes.
    #[error(
        "the dose needs up to {steps_s:.0} steps/s, and the board makes {most_s} at most; dose slower, or with \
         fewer microsteps"
    )]
    Fast {
        /// Most steps per second of the plan.
        steps_s: f64,
        /// Most steps per second of a plan that the board makes.
        most_s: u32,
    },
    /// The dose needs more steps per second than the pulses of the stepper driver allow.
    #[error(
        "the dose needs up to {steps_s:.0} steps/s, and step_pulse_us and step_pause_us in [drive.pins] allow \
         {most_s} at most; dose slower, with fewer microsteps, or with pulses as short as the stepper driver allows"
    )]
    Pulse {
        /// Most steps per second of the plan.
        steps_s: f64,
        /// Most steps per second of a plan that the pulses allow.
        most_s: u32,
    },
    /// The axes together need more steps per second than the board makes.
    #[error(
        "the dose needs up to {steps_s:.0} steps/s, and the other axes leave {free_s} of the {all_s} that the board \
         makes; dose slower, with fewer microsteps, or one after another"
    )]
    StepsTaken {
        /// Most steps per second of the plan.
        steps_s: f64,
        /// Most steps per second of a plan that the board makes beside the other axes.
        free_s: u32,
        /// Most steps per second of a plan that the board makes with one axis.
        all_s: u32,
    },
    /// The segments of the plan cannot reach the board in time.
    #[error(transparent)]
    Demand(#[from] TooFast),
    /// A segment of the plan cannot be sent.
    #[error("the plan cannot be sent to the board")]
    Stream(#[from] StreamError),
    /// A request cannot be sent.
    #[error("a request cannot be sent to the board")]
    Request(#[from] WindowError),
    /// The board refused a request.
    #[error("the board refused a request: {0}")]
    Refused(Refusal),
    /// The board answered something that does not fit the request.
    #[error("the board answered something that does not fit; load its firmware anew")]
    Answer,
    /// The connection to the board broke.
    #[error("the connection to the board broke")]
    Gone(#[source] io::Error),
    /// The board does not answer.
    #[error("the board has not answered for {waited_s:.1} s; check its cable and power")]
    Quiet {
        /// Time without an answer, in s.
        waited_s: f64,
    },
    /// The board was reset, or another program has taken it.
    #[error("the board was reset, or another program has taken it; its motor may have moved")]
    Reset,
    /// The board let go of its motor.
    #[error("the board has released the motor since it was last told to hold it")]
    LetGo,
    /// The board's count differs from the steps made.
    #[error("the board counts {counted} steps where {expected} were expected: the rotor's angle is unknown")]
    Count {
        /// Count that the board reports, in steps.
        counted: i64,
        /// Count that was expected, in steps.
        expected: i64,
    },
    /// Something else moves the board.
    #[error(
        "the board has been moving for {waited_s:.0} s without being told to by this program; stop what moves it"
    )]
    Moving {
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The board heard nothing of this program for too long, and stopped.
    #[error(
        "the board stopped because it heard nothing of this program for {dead_man_ms} ms; check its cable, and \
         what held this computer up"
    )]
    DeadMan {
        /// Time without a word, in ms.
        dead_man_ms: u16,
    },
    /// A step came too late.
    #[error("the board stopped because a step came when the next one was due already; dose slower")]
    Late,
    /// The board ran out of steps, because this program sent none for too long.
    #[error(
        "the board ran out of steps and came to rest, because this program was held up or the line was late; check \
         its cable, and what held this computer up"
    )]
    HeldUp,
    /// A flow over time came to rest on its way, because its steps did not reach the board in time.
    #[error(
        "the board ran out of steps of the flow over time, and came to rest; this computer or the line was late, and \
         a flow that has paused cannot go on"
    )]
    FlowPaused,
    /// The stepper driver reported a fault.
    #[error(
        "the stepper driver reported a fault, so the motor is without current; check the stepper driver's temperature, \
         its supply and the motor's cable, and switch it off and on"
    )]
    Driver,
    /// The emergency stop was pressed.
    #[error("the emergency stop is pressed, or was pressed meanwhile; see that it is safe, and release it")]
    Estop,
    /// The board was stopped by somebody else.
    #[error("the board was stopped by another program; find out why before the rest is made")]
    StoppedElsewhere,
    /// The board does not stop.
    #[error("the board has not come to rest for {waited_s:.0} s after it was told to stop; switch it off")]
    Unstoppable {
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The user asked to stop while the board was at rest.
    #[error("stopped by the user before anything moved")]
    Interrupted,
}

impl NodeError {
    /// Returns true if nothing more can be heard from the board.
    pub(super) fn ends_link(&self) -> bool {
        matches!(self, Self::Gone(_) | Self::Quiet { .. } | Self::Reset)
    }

    /// Returns true if the motor is without current after this error.
    pub(crate) fn cuts_current(&self) -> bool {
        matches!(self, Self::Driver | Self::Estop)
    }

    /// Returns true if nobody knows whether the motor holds after this error.
    pub(crate) fn hides_motor(&self) -> bool {
        self.ends_link() || matches!(self, Self::LetGo)
    }

    /// Returns true for a refusal of this program: no board was asked, or none has refused.
    fn is_of_this_program(&self) -> bool {
        matches!(
            self,
            Self::NoPort
                | Self::Open { .. }
                | Self::OtherBoard { .. }
                | Self::PlaceTaken(_)
                | Self::BoardRecord { .. }
                | Self::SessionRecord { .. }
                | Self::OneNumber { .. }
                | Self::NoAxis { .. }
                | Self::Place { .. }
                | Self::Twice { .. }
                | Self::Elsewhere { .. }
                | Self::Rate { .. }
                | Self::LineFull { .. }
                | Self::Fast { .. }
                | Self::Pulse { .. }
                | Self::StepsTaken { .. }
                | Self::Demand(_)
        )
    }

    /// Returns true if the rotor's angle is unknown after this error.
    pub(super) fn loses(&self) -> bool {
        matches!(self, Self::Count { .. } | Self::Driver | Self::Estop)
    }

    /// Returns the error of a refusal.
    pub(super) fn of(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Session => Self::Reset,
            Refusal::Estop => Self::Estop,
            Refusal::Driver => Self::Driver,
            Refusal::AngleLost => Self::LetGo,
            refusal => Self::Refused(refusal),
        }
    }
}

impl From<BoardError> for NodeError {
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

impl From<NodeError> for DriveError {
    fn from(error: NodeError) -> Self {
        match error {
            NodeError::Interrupted => Self::Interrupted,
            NodeError::Busy { device, holder } => Self::Busy { device, holder },
            error if error.is_of_this_program() => Self::Refused(Box::new(error)),
            error => Self::Device(Box::new(error)),
        }
    }
}

impl From<PortError> for NodeOpening {
    fn from(error: PortError) -> Self {
        Self(match error {
            PortError::Unnamed => NodeError::NoPort.into(),
            PortError::Busy { device, holder } => DriveError::Busy { device, holder },
            PortError::Open { port, fault } => NodeError::Open { port, fault }.into(),
        })
    }
}

/// Error of a port, in the words of this drive.
pub(super) struct NodeOpening(pub(super) DriveError);
