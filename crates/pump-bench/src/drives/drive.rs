//! What every driver does: it makes the steps of a plan, asking before each stretch whether it may.

use std::error::Error as StdError;
use std::fmt::{self, Debug, Display, Formatter};
use std::ops::ControlFlow;
use std::path::PathBuf;

use pump_ctl::plan::Plan;
use pump_model::integrator::IntegrationError;
use thiserror::Error;

use crate::displacement::Correction;

/// Asked before steps are made: `made` are made, and the next up to `about_to` are about to be. To break is to stop.
pub type Gate<'a> = dyn FnMut(u64, u64) -> ControlFlow<()> + 'a;

/// What a driver can do. What it cannot is refused before anything moves, never approximated in silence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Abilities {
    /// It makes each step at the plan's time; without it the device has ramps of its own and keeps to the cruise speed.
    pub step_times: bool,
    /// Its speed may follow the rollers' angle.
    pub angle_dependent_speed: bool,
    /// It finds an index mark by a sensor.
    pub index: bool,
    /// It tells where its own counter stands.
    pub readback: bool,
}

/// What a device can turn the pump head at, by its own settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Slowest cruise, rad/s; 0 if there is none.
    pub min_speed_rad_s: f64,
    /// Fastest cruise, rad/s.
    pub max_speed_rad_s: f64,
    /// Acceleration of its ramps, rad/s²: what it takes whatever the plan says.
    pub acceleration_rad_s2: f64,
}

/// What a rotor has gone through that its angle may not have survived. After each the angle is wider by two full steps of
/// the motor: as far as a rotor may fall that is let go and caught again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The device was reset, or switched on.
    Reset,
    /// The motor was without current.
    Disabled,
    /// Nobody has heard from the device in motion.
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

/// How a search for the index mark ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sought {
    /// Steps made in all.
    pub made: u64,
    /// How many of them after the mark; none if it was not found.
    pub beyond: Option<u64>,
}

/// A driver of one motor.
pub trait Drive: Debug {
    /// What it can do.
    fn abilities(&self) -> Abilities;

    /// What the device allows; none if it takes whatever the pump file allows.
    fn limits(&self) -> Option<DriveLimits>;

    /// The device's own count of steps, positive toward the outlet, from wherever it counts; none if it has none.
    fn count(&self) -> Option<i64>;

    /// What has happened to the rotor since this was last asked, or since the driver was opened.
    fn disturbed(&mut self) -> Option<Disturbance>;

    /// Refuses a plan that it cannot run, and a rotor that is not where it was left, before anything moves or is announced.
    fn check(&mut self, plan: &Plan) -> Result<(), DriveError>;

    /// The rollers displace as this calibration says from now on. Only a simulation needs to be told.
    fn displaces(&mut self, _correction: Correction) {}

    /// Makes the steps of `plan`, asking `gate` before them. When it breaks, the motor decelerates and holds. Returns how
    /// many were made, those of the deceleration included.
    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault>;

    /// Makes steps of `plan` until the index mark is found or `gate` breaks, then stops and holds.
    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<Sought, DriveFault>;

    /// Waits for `settle_s` at least, until nothing that counts can still arrive, and returns what the vessel has received
    /// since the last plan was begun, mL; none where nobody can read it.
    fn settle(&mut self, settle_s: f64) -> Result<Option<f64>, DriveError>;

    /// What a person should know of the device before it moves; told once.
    fn notes(&mut self) -> Vec<String>;

    /// Lets go of the rotor.
    fn release(&mut self) -> Result<(), DriveError>;
}

/// A driver that failed with the motor under way. As far as it can be reached, the motor holds.
#[derive(Debug, Error)]
#[error("{error}")]
pub struct DriveFault {
    /// At least these steps of the plan were made.
    pub made_least: u64,
    /// At most these.
    pub made_most: u64,
    /// Whether the device's own count disagrees, so that nobody knows where the rotor stands.
    pub lost: bool,
    /// Why.
    pub error: DriveError,
}

/// Why a driver failed, or cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    /// Another process has the device.
    #[error("{} is in use by {holder}; wait until it is done", .device.display())]
    Busy {
        /// The device.
        device: PathBuf,
        /// Who has it, as far as the system tells.
        holder: String,
    },
    /// It is not made for this.
    #[error("the {driver} driver has no {ability}; {instead}")]
    Unable {
        /// Driver.
        driver: &'static str,
        /// What it lacks.
        ability: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// The device's own error.
    #[error(transparent)]
    Device(Box<dyn StdError + Send + Sync>),
    /// The simulation's own arithmetic failed.
    #[error("the simulated drive failed: {0}")]
    Sim(#[from] IntegrationError),
}
