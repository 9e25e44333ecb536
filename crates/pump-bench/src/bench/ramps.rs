//! The ramps that a bench's drive can make.

use pump_ctl::plan::{Doser, Limits, Ramps};

use super::bench::Bench;
use crate::dosing::DoseError;
use crate::drives::DriveError;
use crate::notice::Remedy;

impl Bench {
    /// Returns the best acceleration for a board that has one for every dose, in rad/s². `None` if the motor is too
    /// slow for the pump's default rate.
    pub(super) fn plain_acceleration_rad_s2(&self) -> Option<f64> {
        let doser = Doser::new(self.model(), Limits::new(self.file().limits().motor)).ok()?;
        doser.plain_acceleration_rad_s2(self.file().pump.default_rate_ml_s).ok()
    }

    /// Returns the ramps of a dose. A drive that plans its own steps has one acceleration for every dose.
    pub(super) fn ramps_of_drive(&self, asked: Option<Ramps>) -> Result<Option<Ramps>, DoseError> {
        if self.identity().abilities.step_times {
            return Ok(asked);
        }
        if asked == Some(Ramps::LineAware) {
            return Err(DoseError::Connection(DriveError::Unable {
                driver: self.drive_id().to_owned(),
                ability: "line-aware ramps: the board has one acceleration for every dose",
                instead: Remedy::LeaveRampsOut,
            }));
        }
        Ok(Some(Ramps::Fastest))
    }
}
