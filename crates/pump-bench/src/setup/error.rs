//! Answers that cannot be, by themselves or beside others, and records of a first run that cannot be used.

use std::path::PathBuf;

use pump_model::ModelError;
use thiserror::Error;

use crate::config::ConfigError;
use crate::numbers::significant;
use crate::pump_file::{Axis, PumpFileError};

/// Answer of a first run that cannot be, or a record of one that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SetupError {
    /// An answer is missing.
    #[error("nobody has said {what}")]
    Missing {
        /// Answer that is missing.
        what: &'static str,
    },
    /// The name cannot name a pump.
    #[error(
        "`{name}` cannot name a pump; allowed: 1 to 64 of a-z, 0-9, - and _, and no built-in pump's name"
    )]
    Name {
        /// Name that was given.
        name: String,
    },
    /// Another pump has this id, or a record bears it.
    #[error("{} is that of a pump `{name}` already; choose another name", .path.display())]
    Taken {
        /// Name that was given.
        name: String,
        /// Pump file or record of the other pump.
        path: PathBuf,
    },
    /// The catalogue has no such head.
    #[error("no head of the catalogue is `{name}`; the nearest are {nearest}")]
    UnknownHead {
        /// Name that was given.
        name: String,
        /// Nearest names of the catalogue.
        nearest: String,
    },
    /// The number of rollers is not that of the catalogue.
    #[error(
        "{head} has {published} rollers by its document, and {rollers} are said; count them, or name another head"
    )]
    Rollers {
        /// Name of the head.
        head: String,
        /// Rollers by the document.
        published: u32,
        /// Rollers that were said.
        rollers: u32,
    },
    /// The suction lift leaves no pressure above the vapour pressure.
    #[error(
        "water is not sucked up {lift_m} m: the air of {ambient_kpa:.1} kPa lifts it by less than {most_m:.2} m; stand \
         the pump lower, or the supply higher"
    )]
    Lift {
        /// Height that was said, in m.
        lift_m: f64,
        /// Height up to which water is sucked, in m.
        most_m: f64,
        /// Pressure of the air, in kPa absolute.
        ambient_kpa: f64,
    },
    /// No head delivers the volume of a revolution through the bore.
    #[error(
        "{ml_per_rev} mL per revolution cannot be with a bore of {bore_mm} mm: heads with this bore have {} to {} mL, \
         since less leaves no room for the shaft beside the tube and more takes a rotor of more than 3 m; look at the \
         units",
        significant(*least_ml, 2), significant(*most_ml, 2)
    )]
    Bore {
        /// Volume of a revolution that was said, in mL.
        ml_per_rev: f64,
        /// Bore that was said, in mm.
        bore_mm: f64,
        /// Smallest volume of a revolution with this bore, in mL.
        least_ml: f64,
        /// Largest volume of a revolution with this bore, in mL.
        most_ml: f64,
    },
    /// The axis of the board turns another pump.
    #[error("the axis {axis} of {} turns the pump `{name}` already; choose another axis", .port.display())]
    Axis {
        /// Axis that was said.
        axis: Axis,
        /// Serial port of the board.
        port: PathBuf,
        /// Pump that has the axis.
        name: String,
    },
    /// The socket of the board turns another pump.
    #[error("the socket {socket} of {} turns the pump `{name}` already; choose another socket", .port.display())]
    Socket {
        /// Socket that was said.
        socket: String,
        /// Serial port of the board.
        port: PathBuf,
        /// Pump that has the socket.
        name: String,
    },
    /// The stepper driver that the board sets does not make the current.
    #[error("the {what} is {current_a} A; allowed: {allowed}")]
    Current {
        /// Name of the current.
        what: &'static str,
        /// Current that was said, in A (RMS).
        current_a: f64,
        /// Currents that are allowed, as the message words them.
        allowed: String,
    },
    /// The stepper driver that the board sets does not make the microsteps.
    #[error(
        "{microsteps} microsteps of {full_steps} full steps are none that a TMC2209 makes, and the board sets the one \
         at this socket; allowed: {allowed}"
    )]
    Microsteps {
        /// Microsteps that were said.
        microsteps: f64,
        /// Full steps of a revolution.
        full_steps: u32,
        /// Microsteps that are allowed, as the message words them.
        allowed: &'static str,
    },
    /// The rate needs a head that turns faster than it may.
    #[error(
        "{} mL/s needs {needed_rpm:.0} r/min of a head of {ml_per_rev:.4} mL per revolution, and it turns at \
         {most_rpm:.0} r/min at most: {most_ml_s:.3} mL/s",
        significant(*rate_ml_s, 6)
    )]
    Fast {
        /// Rate that was said, in mL/s.
        rate_ml_s: f64,
        /// Speed that the rate needs, in r/min.
        needed_rpm: f64,
        /// Volume of a revolution, in mL.
        ml_per_rev: f64,
        /// Fastest speed, in r/min.
        most_rpm: f64,
        /// Fastest rate, in mL/s.
        most_ml_s: f64,
    },
    /// The rate turns the head so slowly that no setup dose comes to its end.
    #[error(
        "{} mL/s turns a head of {ml_per_rev:.4} mL per revolution at {} r/min, so that a pitch of its rollers takes \
         longer than an hour; allowed: {} to {} mL/s",
        significant(*rate_ml_s, 6), significant(*needed_rpm, 3), significant(*least_ml_s, 3),
        significant(*most_ml_s, 3)
    )]
    Slow {
        /// Rate that was said, in mL/s.
        rate_ml_s: f64,
        /// Speed that the rate needs, in r/min.
        needed_rpm: f64,
        /// Volume of a revolution, in mL.
        ml_per_rev: f64,
        /// Slowest rate, in mL/s.
        least_ml_s: f64,
        /// Fastest rate, in mL/s.
        most_ml_s: f64,
    },
    /// The board does not turn the head as fast or as slowly as the rate needs.
    #[error(
        "{} mL/s needs {needed_rpm:.2} r/min of the head, and the board turns it at {least_rpm:.4} to \
         {most_rpm:.2} r/min with these steps: {least_ml_s:.4} to {most_ml_s:.4} mL/s",
        significant(*rate_ml_s, 6)
    )]
    Board {
        /// Rate that was said, in mL/s.
        rate_ml_s: f64,
        /// Speed that the rate needs, in r/min.
        needed_rpm: f64,
        /// Slowest speed of the head, in r/min.
        least_rpm: f64,
        /// Fastest speed of the head, in r/min.
        most_rpm: f64,
        /// Slowest rate, in mL/s.
        least_ml_s: f64,
        /// Fastest rate, in mL/s.
        most_ml_s: f64,
    },
    /// The configuration has no place.
    #[error("the configuration has no place: neither HOME nor XDG_CONFIG_HOME is set")]
    NoPlace,
    /// A file or folder cannot be read or written.
    #[error("cannot {action} {}", .path.display())]
    File {
        /// Operation that failed.
        action: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Reason that the system gives.
        source: std::io::Error,
    },
    /// The record cannot be understood.
    #[error("the answers on record cannot be understood ({}): {message}", .path.display())]
    Damaged {
        /// Path of the record.
        path: PathBuf,
        /// Message of the parser.
        message: String,
    },
    /// Somebody has changed the pump file since it was written.
    #[error("{} was changed by hand since it was written, and is not written anew", .path.display())]
    Changed {
        /// Path of the pump file.
        path: PathBuf,
    },
    /// The pump cannot work.
    #[error("such a pump cannot work")]
    Model(#[from] ModelError),
    /// The pump file cannot be used.
    #[error(transparent)]
    PumpFile(#[from] PumpFileError),
    /// The configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
}
