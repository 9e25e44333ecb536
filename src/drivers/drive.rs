//! What every driver does: it makes the steps of a plan, asking before each stretch whether it may.

use std::fmt::Debug;
use std::ops::ControlFlow;

use pump_ctl::plan::Plan;
use pump_model::integrator::IntegrationError;
use thiserror::Error;

/// Asked before steps are made: `made` are made, and the next up to `about_to` are about to be. To break is to stop.
pub type Gate<'a> = dyn FnMut(u64, u64) -> ControlFlow<()> + 'a;

/// A driver of one motor.
pub trait Drive: Debug {
    /// Makes the steps of `plan`, asking `gate` before them. When it breaks, the motor decelerates and holds. Returns how
    /// many were made, those of the deceleration included.
    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault>;

    /// Waits until nothing that counts can still arrive, and returns what the vessel has received since the last plan was
    /// begun, mL; none where nobody can read it.
    fn settle(&mut self) -> Result<Option<f64>, DriveError>;
}

/// A driver that failed with the motor under way; the motor holds.
#[derive(Debug, Error)]
#[error("{error}")]
pub struct DriveFault {
    /// At least these steps of the plan were made.
    pub made_least: u64,
    /// At most these.
    pub made_most: u64,
    /// Why.
    pub error: DriveError,
}

/// Why a driver failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The simulation's own arithmetic failed.
    #[error("the simulated drive failed: {0}")]
    Sim(#[from] IntegrationError),
}
