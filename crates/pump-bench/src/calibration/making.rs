//! A calibration made from weighed runs or short doses.

use super::{
    AgainstSpeed, Calibration, CalibrationError, CalibrationRun, Displacement, Expected, LawToFit, PhaseFit,
    Revolution, ShortDose, Source, Weighing,
};
use crate::displacement::Correction;
use crate::pump_file::PumpFile;
use crate::words::words;

/// Shape that is fitted to runs at several speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fit {
    /// A straight line over the speed.
    #[default]
    Line,
    /// Law of volume against speed: the speed law, whose s and D are fitted.
    Law,
}

words!(Fit { Line = "line", Law = "speed-law" });

impl Expected {
    /// Returns the repeatability of the pump file, with the standard uncertainty of a reading, in mL.
    pub fn of(file: &PumpFile, reading_ml: f64) -> Self {
        Self { repeatability: file.uncertainty.repeatability_percent / 100.0, reading_ml }
    }
}

impl Calibration {
    /// Returns a calibration of the displacement of the pump of `file` by weighed runs. The zero of `before`
    /// stays, since other doses found it.
    ///
    /// ```
    /// use pump_bench::calibration::{Calibration, Expected, Fit, Source, runs_of_csv};
    /// let file = pump_bench::built_in("three-roller").unwrap();
    /// let runs = runs_of_csv("speed_rpm,revolutions,volume_ml\n60,2,43.0618\n", 12_800.0)?;
    /// let expected = Expected::of(&file, 0.0);
    /// let found = Calibration::of_runs(&file, Source::File, runs, Fit::Line, &expected, None)?;
    /// assert!((found.displacement.unwrap().factor - 1.01).abs() < 1e-3);
    /// # Ok::<(), pump_bench::calibration::CalibrationError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Errors of [`Displacement::fit`]. [`CalibrationError::NoLaw`] if a law is asked for that the runs do not
    /// show. [`CalibrationError::Model`] if the pump of `file` cannot be modelled.
    pub fn of_runs(
        file: &PumpFile,
        source: Source,
        runs: Vec<CalibrationRun>,
        fit: Fit,
        expected: &Expected,
        before: Option<&Self>,
    ) -> Result<Self, CalibrationError> {
        let weighing = Weighing::of(file);
        let mut calibration = Self::empty(file, source)?;
        if let Some(before) = before {
            calibration.zero_deg = before.zero_deg;
            calibration.zero_standard_deg = before.zero_standard_deg;
            calibration.short_doses.clone_from(&before.short_doses);
        }
        let base = file.model()?;
        let pump = Correction { factor: 1.0, zero_rad: calibration.zero_rad() }.of(&base)?;
        calibration.displacement = Some(match fit {
            Fit::Line => Displacement::fit(&pump, &runs, &weighing, expected)?,
            Fit::Law => {
                let law = LawToFit::of(file, &base)?;
                Displacement::fit_law(&law, &pump, &runs, &weighing, expected)?
            }
        });
        calibration.temperature_degc =
            runs.iter().map(|run| run.temperature_degc(&weighing)).sum::<f64>() / runs.len() as f64;
        calibration.runs = runs;
        Ok(calibration)
    }

    /// Returns a calibration of the zero of the pump of `file` by short doses, and the fit of these doses.
    /// The displacement of `before` stays.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] with fewer than five doses. [`CalibrationError::Undetermined`] if the
    /// doses scatter too much, or sweep too little of a pulse, for the zero to be found.
    /// [`CalibrationError::Model`] if the pump of `file` cannot be modelled.
    pub fn of_short_doses(
        file: &PumpFile,
        doses: Vec<ShortDose>,
        expected: &Expected,
        before: Option<&Self>,
    ) -> Result<(Self, PhaseFit), CalibrationError> {
        let empty = Self::empty(file, Source::Phase)?;
        let displacement = before.and_then(|before| before.displacement.as_ref());
        let pump = file.speed_dependent_pump()?;
        let against = AgainstSpeed::of(displacement, &pump);
        let revolution = Revolution { against, model_standard: file.model_standard() };
        let found = PhaseFit::of(pump.base(), revolution, &doses, expected)?;
        let calibration = Self {
            date: empty.date.clone(),
            source: Source::Phase,
            note: None,
            zero_deg: found.zero_deg.value,
            zero_standard_deg: found.zero_deg.standard,
            short_doses: doses,
            ..before.cloned().unwrap_or(empty)
        };
        Ok((calibration, found))
    }
}
