//! What can go wrong with a grbl board.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::drives::DriveError;

use super::code::{alarm_text, error_text, stops_at_once};

/// Why a grbl board cannot be used, or what it did.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GrblError {
    /// Nobody has said where the board is.
    #[error(
        "no serial port is named for the grbl board; say `--port /dev/ttyUSB0`, or `port = \"...\"` in [drive]"
    )]
    NoPort,
    /// The port cannot be opened.
    #[error("{} cannot be opened as a serial port: {reason}", .port.display())]
    Open {
        /// The port.
        port: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// No grbl answers there.
    #[error(
        "no grbl board answers at {} within {waited_s} s at {baud} baud{heard}; check the port, [drive] baud, and that the \
         board speaks grbl 1.1's protocol", .port.display()
    )]
    NoGrbl {
        /// The port.
        port: PathBuf,
        /// Bits per second.
        baud: u32,
        /// How long it was asked, s.
        waited_s: f64,
        /// What came instead.
        heard: String,
    },
    /// A firmware before 1.1, which has no jogs.
    #[error("the board runs grbl {major}.{minor}; jogs need 1.1 or later: update its firmware")]
    Old {
        /// Before the point.
        major: u32,
        /// After it.
        minor: u32,
    },
    /// A setting that is needed and not listed.
    #[error(
        "the board does not tell its {what} (${number} in its answer to `$$`): it may not have this axis, see [drive] axis"
    )]
    NoSetting {
        /// Number of the setting.
        number: u16,
        /// What it is.
        what: String,
    },
    /// It is in a state in which it takes no jogs.
    #[error("the board's state is {state}: {instead}")]
    Locked {
        /// Its state.
        state: String,
        /// What to do.
        instead: &'static str,
    },
    /// Something else moves it.
    #[error(
        "the board has been moving for {waited_s} s without being told to by this program; stop what moves it"
    )]
    Moving {
        /// How long was waited, s.
        waited_s: f64,
    },
    /// Its reports cannot tell single steps.
    #[error(
        "the board reports positions to {step} of a step ({steps_per_unit} steps a unit), but single steps must be told \
         apart to 0.4; set ${number} to {most} or less, and `$10=1` and `$13=0`"
    )]
    Coarse {
        /// Largest error of a report, steps.
        step: f64,
        /// Steps per unit.
        steps_per_unit: f64,
        /// Number of that setting.
        number: u16,
        /// What would do, steps per unit.
        most: f64,
    },
    /// Its ramps are steeper than the pump allows.
    #[error(
        "the board accelerates at {board_rad_s2:.1} rad/s2 (${number}={setting}), the pump file allows {limit_rad_s2:.1}; \
         `--configure` sets it, or raise [motor] max_acceleration_rad_s2"
    )]
    Steep {
        /// Acceleration of the board, rad/s².
        board_rad_s2: f64,
        /// What the pump file allows, rad/s².
        limit_rad_s2: f64,
        /// Number of the setting.
        number: u16,
        /// Its value, units/s².
        setting: f64,
    },
    /// It refuses to turn farther than a machine's travel.
    #[error("the board's soft limits are on ($20=1), but a pump turns on and on; `--configure` sets $20=0")]
    SoftLimits,
    /// Its single-precision positions end there.
    #[error(
        "the axis would stand at step {count} of the board's count, which is exact to {most} steps either way; switch the \
         board off and on to count from zero"
    )]
    Far {
        /// Where the dose would go, steps.
        count: i64,
        /// Farthest, steps.
        most: i64,
    },
    /// It cannot turn as slowly.
    #[error(
        "the dose needs {steps_s:.2} steps/s, the board makes no less than {least_s:.2}; dose faster, or with finer microsteps"
    )]
    Slow {
        /// Steps per second at the cruise.
        steps_s: f64,
        /// Fewest.
        least_s: f64,
    },
    /// It will not turn as fast.
    #[error(
        "the dose needs {steps_s:.0} steps/s, the board makes no more than {most_s:.0} (${number}={setting}); dose slower, or raise it"
    )]
    Fast {
        /// Steps per second at the cruise.
        steps_s: f64,
        /// Most.
        most_s: f64,
        /// Number of the setting.
        number: u16,
        /// Its value, units/min.
        setting: f64,
    },
    /// A line was refused.
    #[error("the board refused `{line}` with error:{code}: {}", error_text(*code))]
    Refused {
        /// The line.
        line: String,
        /// grbl's number.
        code: u16,
    },
    /// A setting was written and did not change.
    #[error("the board took ${number}={value} but says {reads} now; set it by hand")]
    NotTaken {
        /// Number of the setting.
        number: u16,
        /// What was written.
        value: f64,
        /// What it says.
        reads: f64,
    },
    /// It has locked itself.
    #[error("the board stopped with ALARM:{code}: {}", alarm_text(*code))]
    Alarm {
        /// grbl's number.
        code: u16,
    },
    /// It was reset.
    #[error("the board was reset; its motor may have moved")]
    Reset,
    /// The device is gone.
    #[error("the connection to the board broke: {0}; check its cable and power")]
    Gone(#[source] io::Error),
    /// It says nothing.
    #[error("the board has not answered for {waited_s:.1} s; check its cable and power")]
    Quiet {
        /// How long, s.
        waited_s: f64,
    },
    /// Its reports have no position.
    #[error(
        "the board's reports have told no position of the axis for {waited_s:.1} s; set `$10=1`, and look at [drive] axis"
    )]
    NoPosition {
        /// How long, s.
        waited_s: f64,
    },
    /// A line was neither taken nor refused.
    #[error("the board has not acknowledged `{line}` for {waited_s:.1} s")]
    NoOk {
        /// The line.
        line: String,
        /// How long, s.
        waited_s: f64,
    },
    /// It does not move, although it should.
    #[error(
        "the board has made no step for {waited_s:.1} s, although it should; look for a hold, a door or a jammed board"
    )]
    Stalled {
        /// How long, s.
        waited_s: f64,
    },
    /// It does not stop.
    #[error("the board has not come to rest for {waited_s:.1} s after it was told to stop; switch it off")]
    Unstoppable {
        /// How long, s.
        waited_s: f64,
    },
    /// Its count is not ours.
    #[error(
        "the board counts {counted} steps where {expected} were to be: nobody knows where the rotor stands"
    )]
    Count {
        /// Its count.
        counted: i64,
        /// What it was to be.
        expected: i64,
    },
}

impl GrblError {
    /// Whether nobody knows where the rotor stands afterwards.
    pub(super) fn loses(&self) -> bool {
        match self {
            Self::Count { .. } => true,
            Self::Alarm { code } => stops_at_once(*code),
            _ => false,
        }
    }

    /// Whether nothing more is to be heard.
    pub(super) fn ends_link(&self) -> bool {
        matches!(self, Self::Gone(_) | Self::Quiet { .. })
    }
}

impl From<GrblError> for DriveError {
    fn from(error: GrblError) -> Self {
        Self::Device(Box::new(error))
    }
}
