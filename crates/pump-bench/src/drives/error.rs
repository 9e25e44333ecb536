//! Errors of a drive, at rest and with the motor under way.

use std::error::Error as StdError;
use std::path::PathBuf;

use thiserror::Error;

use crate::notice::{DEVICE_FAILED, PROGRAM_REFUSED, Remedy};

/// Fault of a drive with the motor under way. The motor holds, as far as it can be reached.
#[derive(Debug, Error)]
#[error("the drive failed with the motor under way")]
#[non_exhaustive]
pub struct DriveFault {
    /// Fewest net steps that were made in the plan's direction. Negative if the motor may stand behind its
    /// start.
    pub made_least: i64,
    /// Most net steps that were made in the plan's direction. The plan may have fewer.
    pub made_most: i64,
    /// True if the device's own count disagrees, so that nobody knows where the rotor stands.
    pub lost: bool,
    /// True if the device has lost its count, as after a reset, so that it never tells the steps made.
    pub count_lost: bool,
    /// Error of the drive.
    #[source]
    pub error: DriveError,
}

impl DriveFault {
    /// Makes the fault of a motor that has made just `made` net steps in the plan's direction.
    pub fn at(made: i64, error: DriveError) -> Self {
        Self::between(made, made, error)
    }

    /// Makes the fault of a motor that has made `least` to `most` net steps in the plan's direction.
    pub fn between(least: i64, most: i64, error: DriveError) -> Self {
        Self {
            made_least: least.min(most),
            made_most: most.max(least),
            lost: false,
            count_lost: false,
            error,
        }
    }

    /// Returns true if the motor has not moved.
    pub(crate) fn is_at_rest(&self) -> bool {
        (self.made_least, self.made_most, self.lost) == (0, 0, false)
    }

    /// Returns the fault of a motor whose place nobody knows.
    #[must_use]
    pub fn lost(self) -> Self {
        Self { lost: true, ..self }
    }

    /// Returns the fault of a device that has lost its count, as after a reset.
    #[must_use]
    pub fn without_count(self) -> Self {
        Self { count_lost: true, ..self }
    }
}

/// Error of a drive that failed or cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    /// Another process holds the device.
    #[error("{} is in use by {holder}; wait until it is done", .device.display())]
    Busy {
        /// Path of the device.
        device: PathBuf,
        /// Holder of the device, as far as the system tells.
        holder: String,
    },
    /// The drive lacks an ability.
    #[error("the {driver} driver has no {ability}")]
    Unable {
        /// Name of the drive.
        driver: String,
        /// Ability that the drive lacks.
        ability: &'static str,
        /// Way to do without the ability.
        instead: Remedy,
    },
    /// The user asked to stop while the device was at rest.
    #[error("stopped by the user before anything moved")]
    Interrupted,
    /// The device refused or failed with an error of its own, which is the source of this one.
    #[error("{DEVICE_FAILED}")]
    Device(#[source] Box<dyn StdError + Send + Sync>),
    /// This program refused, for the reason that is the source of this error. The device was not asked, or did not
    /// refuse.
    #[error("{PROGRAM_REFUSED}")]
    Refused(#[source] Box<dyn StdError + Send + Sync>),
    /// The drive has a name that no folder can have, or that of a drive that a pump file names.
    #[error("the drive is named `{id}`, and a name is {allowed}; name the drive so")]
    Name {
        /// Name of the drive.
        id: String,
        /// Names that are allowed.
        allowed: &'static str,
    },
    /// The bench keeps the record of another drive.
    #[error(
        "the bench keeps the record of the drive `{bench}`, and the drive given is `{given}`; make the bench \
         of this drive with `Bench::driven_by`"
    )]
    Other {
        /// Name of the drive whose record the bench keeps.
        bench: String,
        /// Name of the drive that was given.
        given: String,
    },
    /// No pump file names the drive, so a session cannot open it.
    #[error("no pump file names the drive `{id}`; give it to the session with `Session::with_drive`")]
    NotGiven {
        /// Name of the drive.
        id: String,
    },
    /// A board at the port needs another drive.
    #[error("the board at {} is {found}; name the driver `{driver}` for it, and not `{named}`", .port.display())]
    OtherDriver {
        /// Path of the port.
        port: PathBuf,
        /// Words for the board.
        found: String,
        /// Drive of the board.
        driver: &'static str,
        /// Drive that was named.
        named: &'static str,
    },
    /// No board answers at the port, as any driver asks it.
    #[error(
        "neither {asked} answers at {}{heard}; check the port, the board's power, and its firmware",
        .port.display()
    )]
    NoBoard {
        /// Path of the port.
        port: PathBuf,
        /// Boards that were asked for, and at which rates, as the message words them.
        asked: String,
        /// Reply that came instead, as the message words it.
        heard: String,
    },
    /// The program is built without the drive.
    #[error(
        "this program is built without the {driver} driver; build pump-bench with its feature `{driver}`"
    )]
    NotBuilt {
        /// Name of the drive.
        driver: &'static str,
    },
}

impl DriveError {
    /// Makes the error of a device from the device's own error, which becomes its source.
    ///
    /// ```
    /// use std::error::Error;
    /// use std::io;
    ///
    /// use pump_bench::drives::DriveError;
    ///
    /// let error = DriveError::device(io::Error::from(io::ErrorKind::BrokenPipe));
    /// let source = error.source().and_then(|source| source.downcast_ref::<io::Error>());
    /// assert_eq!(source.map(io::Error::kind), Some(io::ErrorKind::BrokenPipe));
    /// ```
    pub fn device(error: impl Into<Box<dyn StdError + Send + Sync>>) -> Self {
        Self::Device(error.into())
    }

    /// Returns the refusal of a drive that cannot let go of its motor.
    pub(crate) fn no_release(driver: &str) -> Self {
        Self::Unable {
            driver: driver.to_owned(),
            ability: "way to let go of the motor",
            instead: Remedy::SwitchOff,
        }
    }

    /// Returns the refusal of a drive that runs no flow over time.
    pub(crate) fn no_flow(driver: &str) -> Self {
        let ability = "way to follow a flow over time: it keeps no step times of a program";
        Self::Unable { driver: driver.to_owned(), ability, instead: Remedy::FlowByNode }
    }

    /// Returns the refusal of a drive that begins no motions together.
    pub(crate) fn no_common_begin(driver: &str) -> Self {
        Self::Unable {
            driver: driver.to_owned(),
            ability: "common begin with other pumps",
            instead: Remedy::BeginOneByOne,
        }
    }

    /// Returns the refusal of a drive without an index sensor.
    pub(crate) fn no_index(driver: &str) -> Self {
        Self::Unable { driver: driver.to_owned(), ability: "index sensor", instead: Remedy::SayAngleOrMark }
    }
}
