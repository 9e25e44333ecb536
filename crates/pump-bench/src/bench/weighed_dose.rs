//! The calibration by the dose just made, which a person weighed.

use super::Bench;
use crate::calibration::{Calibration, CalibrationRun, Earlier, Expected, Reading, Source, fit_of_doses};
use crate::dosing::DoseError;
use crate::units::{Amount, StatedReading};

/// Calibration by the dose just made. Nothing is kept of it yet.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WeighedDose {
    /// Dose that was weighed, as a run.
    pub run: CalibrationRun,
    /// Calibration by this dose and the doses joined to it.
    pub calibration: Calibration,
}

impl Bench {
    /// Returns the calibration that the weight of the last dose gives. [`Self::keep_calibration`] keeps it.
    ///
    /// `None` in place of the temperature takes the pump file's.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] and [`DoseError::Calibration`] where the record cannot be read. Errors of
    /// [`CalibrationRun::of_last_dose`], [`CalibrationRun::beside`] and [`Calibration::of_runs`].
    pub fn weigh_last_dose(
        &self,
        reading: &StatedReading,
        temperature_degc: Option<f64>,
        earlier: Earlier,
        expected: &Expected,
    ) -> Result<WeighedDose, DoseError> {
        let active = self.calibrations().active()?;
        let before = active.as_ref().map(|active| &active.calibration);
        let reading = match reading.amount {
            Amount::Mass(grams) => Reading::MassG(grams),
            Amount::Volume(volume_ml) => Reading::VolumeMl(volume_ml),
        };
        let last = self.story()?.state.and_then(|state| state.last);
        let run = CalibrationRun::of_last_dose(last, self.model(), reading, temperature_degc)?;
        let runs = run.clone().beside(active.as_ref(), earlier)?;
        let fit = fit_of_doses(&runs);
        let mut calibration = Calibration::of_runs(self.file(), Source::Last, runs, fit, expected, before)?;
        calibration.tube = before.and_then(|before| before.tube.clone());
        Ok(WeighedDose { run, calibration })
    }
}
