//! A calibration made from weighed runs or short doses.

use libm::{pow, sqrt};

use super::{
    AgainstSpeed, Calibration, CalibrationError, CalibrationRun, Displacement, Expected, LawToFit, PhaseFit,
    Reading, Revolution, ShortDose, Source, Weighing,
};
use crate::pump_file::PumpFile;
use crate::units::{Amount, StatedReading};
use crate::words::words;

/// Shape that is fitted to runs at several speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fit {
    /// A straight line over the speed, or a parabola if four speeds or more ask for it.
    #[default]
    Best,
    /// A straight line over the speed.
    Line,
    /// One factor for every speed, at the mean speed of the runs.
    Factor,
    /// Law of volume against speed: the speed law, whose s and D are fitted.
    Law,
}

words!(Fit { Best = "best", Line = "line", Factor = "factor", Law = "speed-law" });

/// Returns the step of a reading's last digit, in its unit. Of a reading that nobody wrote down as text it is that of
/// its shortest text, nine decimals at most: zeros at the end are lost.
fn digit_of(run: &CalibrationRun) -> f64 {
    let (Reading::MassG(value) | Reading::VolumeMl(value)) = run.reading;
    let shortest = || {
        let text = format!("{value:.9}");
        let decimals = text.trim_end_matches('0').split_once('.').map_or(0, |(_, decimals)| decimals.len());
        pow(10.0, -(decimals as f64))
    };
    run.digit.unwrap_or_else(shortest)
}

/// Returns the runs with their mean speed in place of their own.
fn at_mean_speed(runs: &[CalibrationRun]) -> Vec<CalibrationRun> {
    let speed_rpm = runs.iter().map(|run| run.speed_rpm).sum::<f64>() / runs.len().max(1) as f64;
    runs.iter().map(|run| CalibrationRun { speed_rpm, ..run.clone() }).collect()
}

impl Expected {
    /// Returns the repeatability of the pump file, which smaller runs exceed, with the standard uncertainty of a
    /// reading, in mL.
    pub fn of(file: &PumpFile, reading_ml: f64) -> Self {
        let table = &file.uncertainty;
        let repeatability_at_ml = table.repeatability_at_ml;
        Self { repeatability_at_ml, ..Self::new(table.repeatability_percent / 100.0, reading_ml) }
    }

    /// Returns the repeatability of the pump file, with the standard uncertainty of readings that the finest digit
    /// among `runs` shows: all come from one scale.
    pub fn of_runs(file: &PumpFile, runs: &[CalibrationRun]) -> Self {
        let finest = |is_mass: bool| {
            let of_kind = runs.iter().filter(|run| matches!(run.reading, Reading::MassG(_)) == is_mass);
            let finest = of_kind.map(digit_of).fold(f64::INFINITY, f64::min);
            if finest.is_finite() { finest } else { 0.0 }
        };
        let of_mass_ml = Amount::Mass(finest(true)).volume_ml(file.fluid.density_kg_m3);
        Self::of_digit(file, f64::max(of_mass_ml, finest(false)))
    }

    /// Returns the repeatability of the pump file, with the standard uncertainty of two readings, empty and full, that
    /// are rounded to the last digit. Each is unsure by a step over the square root of 12 (GUM, F.2.2.1).
    pub fn of_digits(file: &PumpFile, reading: &StatedReading) -> Self {
        Self::of_digit(file, reading.resolution.volume_ml(file.fluid.density_kg_m3))
    }

    /// Returns the repeatability of the pump file, with the standard uncertainty of two readings in steps of a volume
    /// in mL.
    fn of_digit(file: &PumpFile, digit_ml: f64) -> Self {
        Self::of(file, digit_ml * sqrt(2.0 / 12.0))
    }
}

impl Calibration {
    /// Returns a calibration of the displacement of the pump of `file` by weighed runs. The zero of `before`
    /// stays, since other doses found it. A pulse of `before` is fitted again to its short doses, with the
    /// volume of a revolution that the runs show. Doses that were weighed ([`Source::Last`]) are few, so `expected`
    /// is a prior of their scatter.
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
    /// show. [`CalibrationError::Undetermined`] if the short doses of `before` show no pulse any more.
    /// [`CalibrationError::Model`] if the pump of `file` cannot be modelled.
    pub fn of_runs(
        file: &PumpFile,
        source: Source,
        runs: Vec<CalibrationRun>,
        fit: Fit,
        expected: &Expected,
        before: Option<&Self>,
    ) -> Result<Self, CalibrationError> {
        let weighing = Weighing::of(file);
        // The pump file may say another temperature one day; these masses stay those of today's.
        let runs: Vec<_> = runs.into_iter().map(|run| run.at_degc(file.fluid.temperature_degc)).collect();
        let mut calibration = Self::empty(file, source)?;
        if let Some(before) = before {
            calibration.zero_deg = before.zero_deg;
            calibration.zero_standard_deg = before.zero_standard_deg;
            calibration.pulse = before.pulse;
            calibration.short_doses.clone_from(&before.short_doses);
        }
        let base = file.model()?;
        let pump = calibration.shape().of(&base)?;
        let expected = &if source == Source::Last { expected.with_prior() } else { *expected };
        calibration.displacement = Some(match fit {
            Fit::Best => Displacement::fit_best(&pump, &runs, &weighing, expected)?,
            Fit::Line => Displacement::fit(&pump, &runs, &weighing, expected)?,
            Fit::Factor => Displacement::fit(&pump, &at_mean_speed(&runs), &weighing, expected)?,
            Fit::Law => {
                let law = LawToFit::of(file, &base)?;
                Displacement::fit_law(&law, &pump, &runs, &weighing, expected)?
            }
        });
        calibration.temperature_degc =
            runs.iter().map(|run| run.temperature_degc(&weighing)).sum::<f64>() / runs.len() as f64;
        calibration.runs = runs;
        let Some(pulse) = calibration.pulse else { return Ok(calibration) };
        let expected = pulse.expected();
        let found = calibration.pulse_found(file, &calibration.short_doses, &expected)?;
        Ok(calibration.with_pulse(&found, &expected))
    }

    /// Returns a calibration of the pulse and the zero of the pump of `file` by short doses, and the fit of these
    /// doses. The displacement of `before` stays.
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
        let date = empty.date.clone();
        let before = before.cloned().unwrap_or(empty);
        let found = before.pulse_found(file, &doses, expected)?;
        let calibration = Self { date, source: Source::Phase, note: None, short_doses: doses, ..before };
        Ok((calibration.with_pulse(&found, expected), found))
    }

    /// Fits the pulse and the zero to short doses, with the volume of a revolution of this calibration.
    fn pulse_found(
        &self,
        file: &PumpFile,
        doses: &[ShortDose],
        expected: &Expected,
    ) -> Result<PhaseFit, CalibrationError> {
        let pump = file.speed_dependent_pump()?;
        let against = AgainstSpeed::of(self.displacement.as_ref(), &pump);
        let revolution = Revolution { against, model_standard: file.model_standard() };
        PhaseFit::of(pump.base(), revolution, doses, expected)
    }
}
