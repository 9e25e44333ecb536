//! The pumps by whose displacement a motion holds its limits, where the model alone gives its steps.

use pump_ctl::plan::{Limits, Plan, PlanError};
use pump_model::Pump;
use pump_model::units::rpm;

use super::error::DoseError;
use crate::calibration::{AgainstSpeed, CalibrationError, Stored};
use crate::displacement::{Correction, SpeedDependentPump};
use crate::pump_file::PumpFile;

/// Pumps by whose displacement a motion holds its limits. The steps of a run to be weighed, and of a turn of
/// the rotor, follow from the model alone. Their pressures follow from what the pump displaces.
///
/// The calibration in use is the best knowledge of that, or else the pump file's law. A speed that it does
/// not cover has two pumps: that of the nearest speed that it covers, and the model. The truth at such a
/// speed is not known, so a motion must hold its limits by both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DisplacedPumps {
    known: Pump,
    model: Option<Pump>,
}

impl DisplacedPumps {
    /// Returns the pumps of a motion of `base`, the pump of `file` without calibration and law, at a cruise
    /// speed in rad/s. The speed is negative in reverse. `stored` is the calibration in use. A calibration of
    /// another pump does not count.
    ///
    /// # Errors
    ///
    /// [`DoseError::Plan`] or [`DoseError::Calibration`] if the pump with its law or its calibration cannot
    /// be modelled.
    pub(crate) fn at(
        file: &PumpFile,
        base: &Pump,
        stored: Option<&Stored>,
        speed_rad_s: f64,
    ) -> Result<Self, DoseError> {
        let law = file.displacement_law().map_err(PlanError::from)?;
        let pump = SpeedDependentPump::new(*base, law);
        let calibration = stored.filter(|stored| stored.is_of(base)).map(|stored| &stored.calibration);
        let shape = calibration.map_or(Correction::NONE, |calibration| calibration.shape());
        let corrected = |factor| Correction { factor, ..shape }.of(base).map_err(CalibrationError::from);
        let displacement = calibration.and_then(|calibration| calibration.displacement.as_ref());
        let Some(against) = AgainstSpeed::of(displacement, &pump) else {
            return Ok(Self { known: corrected(1.0)?, model: None });
        };
        let speed_rpm = rpm(speed_rad_s).abs();
        let covers = against.covers(speed_rpm);
        let nearest_rpm = match against.range_rpm().filter(|_| !covers) {
            Some((least_rpm, most_rpm)) => speed_rpm.clamp(least_rpm, most_rpm),
            None => speed_rpm,
        };
        let factor = against.factor_at(nearest_rpm.copysign(speed_rad_s)).map_err(CalibrationError::from)?;
        let model = if covers { None } else { Some(corrected(1.0)?) };
        Ok(Self { known: corrected(factor)?, model })
    }

    /// Returns the pump with the best known displacement.
    pub(crate) fn known(&self) -> &Pump {
        &self.known
    }

    /// Refuses a plan that breaks a limit on any of the pumps.
    ///
    /// # Errors
    ///
    /// [`PlanError`] of the limit that is broken. It names the nearest speed that holds every limit.
    pub(crate) fn check(&self, plan: &Plan, limits: &Limits) -> Result<(), PlanError> {
        plan.check_on(&self.known, limits)?;
        self.model.map_or(Ok(()), |model| plan.check_on(&model, limits))
    }
}
