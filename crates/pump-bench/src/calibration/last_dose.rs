//! A calibration by the dose that was just made: its reading, beside those of the doses before it.

use libm::{round, sqrt};
use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::units::{degrees, radians, rpm};

use super::date::of_unix;
use super::{
    Calibration, CalibrationError, CalibrationRun, Expected, Fit, Reading, Source, Stored, Weighing,
};
use crate::pump_file::PumpFile;
use crate::record::LastDose;
use crate::units::{Amount, StatedReading};

/// Largest part of the turn by which the turn of a weighed dose may be unsure.
const UNSURE: f64 = 1e-3;

/// Quotient of the fastest and the slowest speed of weighed doses up to which they show one factor, not a line.
///
/// A first calibration changes the speed of a rate by as much: pumps that nobody has weighed are up to 25 % off
/// (Omega, FPU5MT manual, table 9-3), so the doses of one rate run at speeds with a quotient of up to 1.25/0.85.
const ONE_SPEED: f64 = 1.5;

/// Returns the shape to fit to doses that were weighed: one factor, unless their speeds are far from each other.
pub(crate) fn fit_of_doses(runs: &[CalibrationRun]) -> Fit {
    let speeds = || runs.iter().map(|run| run.speed_rpm);
    let (least_rpm, most_rpm) = (speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max));
    if most_rpm <= ONE_SPEED * least_rpm { Fit::Factor } else { Fit::Best }
}

/// Use of the calibration in use, when the last dose is weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Earlier {
    /// Doses that were weighed like this one are joined. Any other calibration must be named.
    #[default]
    Joined,
    /// The runs of the calibration in use are joined, whatever their origin.
    Added,
    /// The reading stands alone.
    Left,
}

impl CalibrationRun {
    /// Returns the last dose as a weighed run of a fluid at this temperature, in °C.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoLastDose`] without a dose on record. [`CalibrationError::UnsureLastDose`] after a dose
    /// that was cut off where nobody knows. [`CalibrationError::LastDoseFromUnknownAngle`] for a part of a pitch from
    /// an angle that is not known.
    pub fn of_last_dose(
        last: Option<LastDose>,
        pump: &Pump,
        reading: Reading,
        temperature_degc: f64,
    ) -> Result<Self, CalibrationError> {
        let dose = last.filter(|dose| dose.speed_rad_s > 0.0 && dose.turned_rad != 0.0);
        let dose = dose.ok_or(CalibrationError::NoLastDose)?;
        let turned_deg = degrees(dose.turned_rad);
        if dose.turned_half_width_rad > UNSURE * dose.turned_rad.abs() {
            let half_width_deg = degrees(dose.turned_half_width_rad);
            return Err(CalibrationError::UnsureLastDose { turned_deg, half_width_deg });
        }
        let is_stated = dose.start().is_stated();
        let run = Self {
            digit: None,
            speed_rpm: rpm(dose.speed_rad_s),
            start_angle_deg: is_stated.then_some(degrees(dose.start_angle_rad)),
            turned_deg,
            reading,
            temperature_degc: Some(temperature_degc),
            time: Some(of_unix(dose.unix_s)),
        };
        match run.model_ml(pump, 1) {
            Err(CalibrationError::UnknownAngle { turned_deg, pitch_deg, .. }) => {
                let pitches = (turned_deg / pitch_deg).abs().floor();
                let pitch_ml = pump.outlet_curve().pitch_ml();
                // The least dose of whole pitches is one.
                let nearest_ml = [pitches.max(1.0), pitches.max(1.0) + 1.0].map(|whole| whole * pitch_ml);
                Err(CalibrationError::LastDoseFromUnknownAngle { turned_deg, pitch_deg, nearest_ml })
            }
            checked => checked.map(|_| run),
        }
    }

    /// Returns the runs of a calibration by this dose of the fluid that is named. The earlier reading of the same dose
    /// is left out. Runs of earlier versions without a temperature have that of their calibration.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::WeighedOtherwise`] if the calibration in use has other runs than doses weighed like this
    /// one, and `earlier` does not name them. [`CalibrationError::WeighedWith`] if it was weighed with another fluid.
    pub fn beside(
        self,
        active: Option<&Stored>,
        earlier: Earlier,
        fluid: &str,
    ) -> Result<Vec<Self>, CalibrationError> {
        let joined =
            active.filter(|stored| earlier != Earlier::Left && stored.calibration.displacement.is_some());
        let Some(Stored { version, calibration }) = joined else { return Ok(vec![self]) };
        if earlier == Earlier::Joined && calibration.source != Source::Last {
            let runs = calibration.runs.len();
            return Err(CalibrationError::WeighedOtherwise { version: *version, runs });
        }
        let kept = calibration.runs.iter().filter(|run| !run.is_of_dose(&self));
        let mut runs: Vec<Self> = kept.map(|run| run.clone().at_degc(calibration.temperature_degc)).collect();
        if !calibration.fluid.eq_ignore_ascii_case(fluid) {
            let (weighed, now) = (calibration.fluid.clone(), fluid.to_owned());
            return Err(CalibrationError::WeighedWith { version: *version, weighed, now });
        }
        runs.push(self);
        Ok(runs)
    }

    /// Returns true if both runs are readings of one dose.
    fn is_of_dose(&self, other: &Self) -> bool {
        self.time == other.time && same_turn(self.turned_deg, other.turned_deg)
    }
}

/// Returns the standard deviation of the volume of a turn, in mL, over the start angles that `start` allows. They are
/// equally likely.
fn angle_ml(pump: &Pump, start: Phase, turned_rad: f64) -> f64 {
    const ANGLES: i32 = 32;
    let curve = pump.outlet_curve();
    let volume_ml = |from_rad: f64| curve.volume_ml(from_rad + turned_rad) - curve.volume_ml(from_rad);
    let planned_ml = volume_ml(start.angle_rad());
    let square = |n: i32| {
        let part = f64::from(2 * n + 1) / f64::from(ANGLES) - 1.0;
        let error_ml = volume_ml(start.angle_rad() + start.half_width_rad() * part) - planned_ml;
        error_ml * error_ml
    };
    sqrt((0..ANGLES).map(square).sum::<f64>() / f64::from(ANGLES))
}

/// Returns true for turns that are equal to a millionth of a degree.
fn same_turn(one_deg: f64, other_deg: f64) -> bool {
    round(1e6 * one_deg) == round(1e6 * other_deg)
}

/// Calibration by the dose just made. Nothing is kept of it yet.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WeighedDose {
    /// Dose that was weighed, as a run.
    pub run: CalibrationRun,
    /// Earlier reading of the same dose, in whose place this one is. `None` if there was none.
    pub replaced: Option<Reading>,
    /// Calibration by this dose and the doses joined to it.
    pub calibration: Calibration,
}

impl WeighedDose {
    /// Fits a factor to the last dose of the pump and the fluid of `file`, and to the runs of `active` that are joined.
    ///
    /// # Errors
    ///
    /// Errors of [`CalibrationRun::of_last_dose`], [`CalibrationRun::beside`] and [`Calibration::of_runs`].
    pub(crate) fn of(
        file: &PumpFile,
        last: Option<LastDose>,
        active: Option<&Stored>,
        weighing: &LastWeighing<'_>,
    ) -> Result<Self, CalibrationError> {
        let reading = match weighing.reading.amount {
            Amount::Mass(grams) => Reading::MassG(grams),
            Amount::Volume(volume_ml) => Reading::VolumeMl(volume_ml),
        };
        let pump = file.model()?;
        let run = CalibrationRun::of_last_dose(last, &pump, reading, file.fluid.temperature_degc);
        let run = run.map_err(|error| error.by_calibration(weighing.in_use, last, &pump))?;
        let start = last.filter(|_| run.start_angle_deg.is_some()).map(|dose| dose.start());
        let angle_ml = start.map_or(0.0, |start| angle_ml(&pump, start, radians(run.turned_deg)));
        let density = match reading {
            Reading::MassG(_) => Weighing::of(file).density_standard()?,
            Reading::VolumeMl(_) => 0.0,
        };
        let expected = weighing.expected.with_angle_ml(angle_ml).with_density(density);
        // A mistake in a unit is told before anything else.
        run.volumes_ml(&pump, &Weighing::of(file), 1)?;
        let runs = run.clone().beside(active, weighing.earlier, &file.fluid.name)?;
        let replaced = active.filter(|_| weighing.earlier != Earlier::Left).and_then(|active| {
            active.calibration.runs.iter().find(|earlier| earlier.is_of_dose(&run)).map(|run| run.reading)
        });
        let before = active.map(|active| &active.calibration);
        let fit = fit_of_doses(&runs);
        let mut calibration = Calibration::of_runs(file, Source::Last, runs, fit, &expected, before)?;
        calibration.tube = before.and_then(|before| before.tube.clone());
        Ok(Self { run, replaced, calibration })
    }
}

impl CalibrationError {
    /// Returns the error with the volumes of whole pitches by the calibration that doses use.
    fn by_calibration(self, in_use: Option<&Stored>, last: Option<LastDose>, pump: &Pump) -> Self {
        let Self::LastDoseFromUnknownAngle { turned_deg, pitch_deg, nearest_ml } = self else { return self };
        let found = in_use.and_then(|stored| stored.calibration.displacement.as_ref());
        let rpm = last.map_or(0.0, |dose| rpm(dose.speed_rad_s));
        let factor = found.and_then(|found| found.factor_at(pump, rpm).ok()).unwrap_or(1.0);
        let nearest_ml = nearest_ml.map(|volume_ml| factor * volume_ml);
        Self::LastDoseFromUnknownAngle { turned_deg, pitch_deg, nearest_ml }
    }
}

/// Weighing of the last dose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LastWeighing<'a> {
    pub(crate) reading: &'a StatedReading,
    pub(crate) earlier: Earlier,
    /// Calibration that doses use. `None` while one waits.
    pub(crate) in_use: Option<&'a Stored>,
    pub(crate) expected: &'a Expected,
}
