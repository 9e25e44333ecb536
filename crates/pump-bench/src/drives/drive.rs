//! The interface of every drive. A drive makes the steps of a plan and asks for leave before each stretch.

use std::error::Error as StdError;
use std::fmt::{self, Debug, Display, Formatter};
use std::ops::ControlFlow;
use std::path::PathBuf;

use pump_ctl::plan::Plan;
use pump_model::integrator::IntegrationError;
use thiserror::Error;

use crate::displacement::Correction;

/// Gate that a drive asks before it makes steps. `made` are made, and the next up to `about_to` are about to
/// be made. To break is to stop.
pub type Gate<'a> = dyn FnMut(u64, u64) -> ControlFlow<()> + 'a;

/// Abilities of a driver. Anything else is refused before the motor moves, never approximated in silence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Abilities {
    /// True if the driver makes each step at the plan's time. Otherwise the device has ramps of its own and
    /// keeps to the cruise speed.
    pub step_times: bool,
    /// True if the speed may follow the rollers' angle.
    pub angle_dependent_speed: bool,
    /// True if the driver finds an index mark by a sensor.
    pub index: bool,
    /// True if the driver reads the device's own step count.
    pub readback: bool,
}

/// Limits of the pump head's motion by the device's own settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Slowest cruise, in rad/s. Zero without such a limit.
    pub min_speed_rad_s: f64,
    /// Fastest cruise, in rad/s.
    pub max_speed_rad_s: f64,
    /// Acceleration of the device's ramps, in rad/s². It holds whatever the plan says.
    pub acceleration_rad_s2: f64,
}

/// Event that the rotor's angle may not have survived.
///
/// Each event widens the angle by two full steps of the motor: a released rotor may fall that far before it
/// is caught again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The device was reset, or switched on.
    Reset,
    /// The motor was without current.
    Disabled,
    /// The device was out of reach in motion.
    LinkLost,
}

impl Display for Disturbance {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Reset => "the device was reset",
            Self::Disabled => "the motor was without current",
            Self::LinkLost => "the device was out of reach in motion",
        })
    }
}

/// Result of a search for the index mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sought {
    /// Steps made in all.
    pub made: u64,
    /// Steps made after the mark. `None` if the mark was not found.
    pub beyond: Option<u64>,
}

/// Drive of one motor.
pub trait Drive: Debug {
    /// Returns the abilities of the driver.
    fn abilities(&self) -> Abilities;

    /// Returns the limits of the device. `None` if it takes whatever the pump file allows.
    fn limits(&self) -> Option<DriveLimits>;

    /// Returns the device's own count of steps, positive toward the outlet, from any zero. `None` without a
    /// count.
    fn count(&self) -> Option<i64>;

    /// Returns the last disturbance of the rotor since this was last asked, or since the drive was opened.
    fn disturbed(&mut self) -> Option<Disturbance>;

    /// Checks that the device can run a plan, and that the rotor is where it was left. Nothing has moved or
    /// been announced yet.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the device cannot run the plan, or has moved or been reset since.
    fn check(&mut self, plan: &Plan) -> Result<(), DriveError>;

    /// Sets the correction of the displacement from now on. Only a simulation needs it.
    fn displaces(&mut self, _correction: Correction) {}

    /// Makes the steps of `plan` and asks `gate` before them. When the gate breaks, the motor decelerates and
    /// holds.
    ///
    /// Returns the number of steps made, those of the deceleration included.
    ///
    /// # Errors
    ///
    /// [`DriveFault`] if the drive failed with the motor under way.
    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault>;

    /// Makes steps of `plan` until the index mark is found or `gate` breaks, then stops and holds.
    ///
    /// # Errors
    ///
    /// [`DriveFault`] if the drive has no index sensor, or failed with the motor under way.
    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<Sought, DriveFault>;

    /// Waits for at least `settle_s`, until nothing noticeable can still arrive in the vessel.
    ///
    /// Returns the volume that the vessel received since the last plan was begun, in mL, or `None` if nobody
    /// can read it.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the drive failed meanwhile.
    fn settle(&mut self, settle_s: f64) -> Result<Option<f64>, DriveError>;

    /// Returns the notes for the user to read before the device moves. Each note is returned once.
    fn notes(&mut self) -> Vec<String>;

    /// Releases the rotor.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the device cannot be reached or refuses.
    fn release(&mut self) -> Result<(), DriveError>;
}

/// Fault of a drive with the motor under way. The motor holds, as far as it can be reached.
#[derive(Debug, Error)]
#[error("{error}")]
pub struct DriveFault {
    /// Fewest steps of the plan that were made.
    pub made_least: u64,
    /// Most steps of the plan that were made.
    pub made_most: u64,
    /// True if the device's own count disagrees, so that nobody knows where the rotor stands.
    pub lost: bool,
    /// Error of the drive.
    pub error: DriveError,
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
    /// The driver lacks an ability.
    #[error("the {driver} driver has no {ability}; {instead}")]
    Unable {
        /// Name of the driver.
        driver: &'static str,
        /// Ability that the driver lacks.
        ability: &'static str,
        /// Advice to the user.
        instead: &'static str,
    },
    /// The device failed with an error of its own protocol.
    #[error(transparent)]
    Device(Box<dyn StdError + Send + Sync>),
    /// The arithmetic of the simulation failed.
    #[error("the simulated drive failed: {0}")]
    Sim(#[from] IntegrationError),
}
