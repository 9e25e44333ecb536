//! The errors of a grbl board.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use thiserror::Error;

use crate::drives::known_board::{BoardError, PlaceTaken, pump_in_words};
use crate::drives::wire::{PortError, PortFault};
use crate::drives::{CommonBeginError, DriveError};

use super::axis_name::{axes_in_words, letter_at};
use super::code::{alarm_text, error_text, stops_at_once};

/// Error of a grbl board. The axes that it moves as one line have one error.
#[derive(Debug, Clone, Error)]
#[non_exhaustive]
pub enum GrblError {
    /// No serial port is named.
    #[error("no serial port is named for the grbl board")]
    NoPort,
    /// The port cannot be opened.
    #[error("{} cannot be opened as a serial port: {fault}", .port.display())]
    Open {
        /// Path of the port.
        port: PathBuf,
        /// Fault of the port.
        fault: PortFault,
    },
    /// No grbl board answers at the port.
    #[error(
        "no grbl board answers at {} within {waited_s} s at {baud} baud{heard}; check the port, [drive] \
         baud, and that the board speaks grbl 1.1's protocol", .port.display()
    )]
    NoGrbl {
        /// Path of the port.
        port: PathBuf,
        /// Baud rate, in bits per second.
        baud: u32,
        /// Time for which the board was asked, in s.
        waited_s: f64,
        /// Reply that came instead, as the message words it.
        heard: String,
    },
    /// The firmware is older than 1.1 and has no jogs.
    #[error("the board runs grbl {major}.{minor}; jogs need 1.1 or later: update its firmware")]
    Old {
        /// Major version.
        major: u32,
        /// Minor version.
        minor: u32,
    },
    /// The board does not list a setting that the drive needs.
    #[error(
        "the board does not list its {what} (${number} in its answer to `$$`); it may lack this axis: check \
         [drive] axis"
    )]
    NoSetting {
        /// Number of the setting.
        number: u16,
        /// Meaning of the setting.
        what: String,
    },
    /// The board is in a state in which it takes no jogs.
    #[error("the board's state is {state}: {instead}")]
    Locked {
        /// State of the board.
        state: String,
        /// Advice to the user.
        instead: &'static str,
    },
    /// Something else moves the board.
    #[error(
        "the board has been moving for {waited_s} s without being told to by this program; stop what moves it"
    )]
    Moving {
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The board's reports cannot tell single steps apart.
    #[error(
        "the board reports positions to {step} of a step ({steps_per_unit} steps a unit), but the drive \
         must tell steps apart to 0.4 of a step; set ${number} to {most} or less, and `$10=1` and `$13=0`"
    )]
    Coarse {
        /// Largest error of a report, in steps.
        step: f64,
        /// Steps per unit by the board's setting.
        steps_per_unit: f64,
        /// Number of the setting of steps per unit.
        number: u16,
        /// Most steps per unit at which reports tell steps apart.
        most: f64,
    },
    /// The board's ramps are steeper than the pump allows.
    #[error(
        "the board accelerates at {board_rad_s2:.1} rad/s2 (${number}={setting}), the pump file allows \
         {limit_rad_s2:.1}"
    )]
    Steep {
        /// Acceleration of the board, in rad/s².
        board_rad_s2: f64,
        /// Acceleration that the pump file allows, in rad/s².
        limit_rad_s2: f64,
        /// Number of the setting.
        number: u16,
        /// Value of the setting, in units/s².
        setting: f64,
    },
    /// The board refuses to turn farther than a machine's travel.
    #[error("the board's soft limits are on ($20=1), but a pump turns on and on; $20=0 turns them off")]
    SoftLimits,
    /// The dose would end beyond the board's exact single-precision positions.
    #[error(
        "the axis would stand at step {count} of the board's count, which is exact to {most} steps either \
         way; switch the board off and on to count from zero"
    )]
    Far {
        /// Count at which the axis would stand, in steps.
        count: i64,
        /// Farthest exact count either way, in steps.
        most: i64,
    },
    /// The board cannot turn as slowly as the dose needs.
    #[error(
        "the dose needs {steps_s:.2} steps/s, the board makes no less than {least_s:.2}; dose faster, or \
         with finer microsteps"
    )]
    Slow {
        /// Steps per second at the cruise.
        steps_s: f64,
        /// Fewest steps per second of the board.
        least_s: f64,
    },
    /// The board is set to turn no faster than its largest rate, and the dose is faster.
    #[error(
        "the dose needs {steps_s:.0} steps/s, the board makes no more than {most_s:.0} \
         (${number}={setting}); dose slower, or raise ${number}"
    )]
    Fast {
        /// Steps per second at the cruise.
        steps_s: f64,
        /// Most steps per second of the board.
        most_s: f64,
        /// Number of the setting.
        number: u16,
        /// Value of the setting, in units/min.
        setting: f64,
    },
    /// The dose is faster than grbl 1.1 makes steps, whatever its settings say.
    #[error(
        "the dose needs {steps_s:.0} steps/s, grbl 1.1 makes no more than {most_s:.0}; dose slower, or with \
         fewer microsteps"
    )]
    FasterThanGrbl {
        /// Steps per second at the cruise.
        steps_s: f64,
        /// Most steps per second of grbl 1.1.
        most_s: f64,
    },
    /// The board told two values of one setting.
    #[error(
        "the board told ${number}={one}, and ${number}={two} when it was asked again; check its cable, and \
         try again"
    )]
    Unsteady {
        /// Number of the setting.
        number: u16,
        /// First value. NaN if the board did not list the setting.
        one: f64,
        /// Second value. NaN if the board did not list the setting.
        two: f64,
    },
    /// Settings that scale the motion differ from those on record.
    #[error(
        "the board's settings have changed since the last time, or another board is at this port: {changes} (the \
         record is {})",
        .record.display()
    )]
    SettingsChanged {
        /// Numbers, old and new values of the settings.
        changes: String,
        /// Path of the record.
        record: PathBuf,
    },
    /// The record of the board's settings cannot be used.
    #[error(
        "the record of the board's settings cannot be {action}: {reason} ({})", .record.display()
    )]
    SettingsRecord {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
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
    #[error("{0}; if these are two boards whose ports share a name, give each a text with `$I=`")]
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
    /// The board refused a line.
    #[error("the board refused {} with error:{code}: {}", named(line), error_text(*code))]
    Refused {
        /// Line that was sent.
        line: String,
        /// grbl's code of the error.
        code: u16,
    },
    /// The board took a setting but did not change it.
    #[error("the board took ${number}={value} but tells {reads} now; set it by hand")]
    NotTaken {
        /// Number of the setting.
        number: u16,
        /// Value that was written.
        value: f64,
        /// Value that the board tells.
        reads: f64,
    },
    /// The board stopped and locked itself.
    #[error("the board stopped with ALARM:{code}: {}", alarm_text(*code))]
    Alarm {
        /// grbl's code of the alarm.
        code: u16,
    },
    /// The board was reset.
    #[error("the board was reset; its motor may have moved")]
    Reset,
    /// The connection to the board broke.
    #[error("the connection to the board broke")]
    Gone(#[source] Arc<io::Error>),
    /// The board does not answer.
    #[error("the board has not answered for {waited_s:.1} s; check its cable and power")]
    Quiet {
        /// Time without an answer, in s.
        waited_s: f64,
    },
    /// The board's reports have no coordinate of the axis.
    #[error(
        "the board reports {}, and [drive] axis is {}; name the axis that has the motor",
        axes_in_words(*.axes), letter_at(*.axis)
    )]
    NoAxis {
        /// Place of the axis among those of a board, from 0 for X.
        axis: usize,
        /// Number of axes that the board reports.
        axes: usize,
    },
    /// The board's reports tell no position.
    #[error(
        "the board's reports have told no position of the axis for {waited_s:.1} s; set `$10=1`, and check \
         [drive] axis"
    )]
    NoPosition {
        /// Time without a position, in s.
        waited_s: f64,
    },
    /// The port is open at another rate.
    #[error(
        "the pump's [drive] baud is {baud}, and {} is open at {open_baud} for another axis; give both one rate",
        .port.display()
    )]
    Rate {
        /// Path of the port.
        port: PathBuf,
        /// Rate that this pump names, in bits per second.
        baud: u32,
        /// Rate of the port, in bits per second.
        open_baud: u32,
    },
    /// Axes that are to move as one line do not begin.
    #[error(transparent)]
    Common(#[from] CommonBeginError),
    /// The axis that led a line did not tell how it ended.
    #[error("the axis that led this one on a line failed; where the line ended is not known")]
    Unled,
    /// The board neither took nor refused a line.
    #[error("the board has not acknowledged `{line}` for {waited_s:.1} s; check its cable and power")]
    NoOk {
        /// Line that was sent.
        line: String,
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The board does not move, although it should.
    #[error(
        "the board has made no step for {waited_s:.1} s, although it should; check for a hold, an open door \
         or a jammed board"
    )]
    Stalled {
        /// Time without a step, in s.
        waited_s: f64,
    },
    /// The board was stopped by somebody else.
    #[error(
        "the board was stopped by somebody else (its state is {state}): by a hold, a jog cancel, a door or \
         another program; find out why before the rest is made"
    )]
    StoppedElsewhere {
        /// State of the board.
        state: String,
    },
    /// The motion takes much longer than it needs.
    #[error(
        "the motion has taken {taken_s:.0} s and needs {needs_s:.1} s; check the feed override of the board"
    )]
    Late {
        /// Time taken, in s.
        taken_s: f64,
        /// Time that the motion needs, in s.
        needs_s: f64,
    },
    /// The user asked to stop while the board was at rest.
    #[error("stopped by the user before anything moved")]
    Interrupted,
    /// The board does not stop.
    #[error("the board has not come to rest for {waited_s:.1} s after it was told to stop; switch it off")]
    Unstoppable {
        /// Time waited, in s.
        waited_s: f64,
    },
    /// The board's count differs from the steps sent.
    #[error("the board counts {counted} steps where {expected} were expected: the rotor's angle is unknown")]
    Count {
        /// Count that the board reports, in steps.
        counted: i64,
        /// Count that was expected, in steps.
        expected: i64,
    },
}

/// Names a line that was sent. An empty line only wakes the board.
fn named(line: &str) -> String {
    if line.is_empty() { "an empty line".to_owned() } else { format!("`{line}`") }
}

impl GrblError {
    /// Returns true if the rotor's angle is unknown after this error.
    pub(super) fn loses(&self) -> bool {
        match self {
            Self::Count { .. } => true,
            Self::Alarm { code } => stops_at_once(*code),
            _ => false,
        }
    }

    /// Returns true if nobody knows whether the motor holds after this error.
    pub(crate) fn hides_motor(&self) -> bool {
        self.ends_link() || matches!(self, Self::Reset)
    }

    /// Returns true for a refusal of this program: no board was asked, or none has refused.
    fn is_of_this_program(&self) -> bool {
        matches!(
            self,
            Self::NoPort
                | Self::Open { .. }
                | Self::Old { .. }
                | Self::Coarse { .. }
                | Self::Steep { .. }
                | Self::SoftLimits
                | Self::Far { .. }
                | Self::Slow { .. }
                | Self::Fast { .. }
                | Self::FasterThanGrbl { .. }
                | Self::SettingsChanged { .. }
                | Self::SettingsRecord { .. }
                | Self::OtherBoard { .. }
                | Self::PlaceTaken(_)
                | Self::BoardRecord { .. }
                | Self::NoAxis { .. }
                | Self::Rate { .. }
        )
    }

    /// Returns true if nothing more can be heard from the board.
    pub(super) fn ends_link(&self) -> bool {
        matches!(self, Self::Gone(_) | Self::Quiet { .. })
    }
}

impl From<BoardError> for GrblError {
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

impl From<GrblError> for DriveError {
    fn from(error: GrblError) -> Self {
        match error {
            GrblError::Interrupted => Self::Interrupted,
            error if error.is_of_this_program() => Self::Refused(Box::new(error)),
            error => Self::Device(Box::new(error)),
        }
    }
}

impl From<PortError> for DriveError {
    fn from(error: PortError) -> Self {
        match error {
            PortError::Unnamed => GrblError::NoPort.into(),
            PortError::Busy { device, holder } => Self::Busy { device, holder },
            PortError::Open { port, fault } => GrblError::Open { port, fault }.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_line_is_named_even_if_it_is_empty() {
        let said = |line: &str| GrblError::Refused { line: line.to_owned(), code: 8 }.to_string();
        assert!(said("").starts_with("the board refused an empty line with error:8: "), "{}", said(""));
        assert!(said("$$").starts_with("the board refused `$$` with error:8: "), "{}", said("$$"));
    }
}
