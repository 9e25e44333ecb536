//! A calibration made from weighed runs or short doses.

use super::{
    AgainstSpeed, Calibration, CalibrationError, Displacement, Expected, PhaseFit, Revolution, Run,
    ShortDose, Source, Weighing,
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
    /// Speed law, whose s and D are fitted.
    SpeedLaw,
}

words!(Fit { Line = "line", SpeedLaw = "speed-law" });

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
    /// Errors of [`Displacement::fit`] or [`Displacement::fit_law`], and [`CalibrationError::Model`] if the
    /// pump of `file` cannot be modelled.
    pub fn of_runs(
        file: &PumpFile,
        source: Source,
        runs: Vec<Run>,
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
            Fit::SpeedLaw => {
                let start = file.speed_law_to_fit()?;
                Displacement::fit_law(&pump, &base, &start, &runs, &weighing, expected)?
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
    /// Errors of [`PhaseFit::of`], and [`CalibrationError::Model`] if the pump of `file` cannot be modelled.
    pub fn of_short_doses(
        file: &PumpFile,
        doses: Vec<ShortDose>,
        expected: &Expected,
        before: Option<&Self>,
    ) -> Result<(Self, PhaseFit), CalibrationError> {
        let empty = Self::empty(file, Source::Phase)?;
        let (base, displacement) = (file.model()?, before.and_then(|before| before.displacement.as_ref()));
        let model_standard = file.speed_law.standard().unwrap_or(file.uncertainty.model_percent / 100.0);
        let against = AgainstSpeed::of(displacement, file.speed_law()?, &base);
        let found = PhaseFit::of(&base, Revolution { against, model_standard }, &doses, expected)?;
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
