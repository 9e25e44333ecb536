//! A calibration by the dose that was just made: its reading, beside those of the doses before it.

use libm::{round, sqrt};
use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::units::{degrees, radians, rpm};

use super::date::of_unix;
use super::run::OverAngles;
use super::{
    AgainstSpeed, Calibration, CalibrationError, CalibrationRun, Expected, Fit, Reading, Source, Stored,
    Weighing,
};
use crate::displacement::Correction;
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
    /// Returns the last dose of `pump`, the pump of `file`, as a weighed run of its fluid.
    ///
    /// An angle that is not known to better than 2 deg counts with its bounds, unless whole pitches were turned.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoLastDose`] without a dose on record. [`CalibrationError::UnsureLastDose`] after a dose
    /// that was cut off where nobody knows. [`CalibrationError::LastDoseFromUnknownAngle`] if the bounds of the angle
    /// leave the volume less sure than the model of `file` does.
    pub fn of_last_dose(
        last: Option<LastDose>,
        file: &PumpFile,
        pump: &Pump,
        reading: Reading,
    ) -> Result<Self, CalibrationError> {
        let dose = last.filter(|dose| dose.speed_rad_s > 0.0 && dose.turned_rad != 0.0);
        let dose = dose.ok_or(CalibrationError::NoLastDose)?;
        let turned_deg = degrees(dose.turned_rad);
        if dose.turned_half_width_rad > UNSURE * dose.turned_rad.abs() {
            let half_width_deg = degrees(dose.turned_half_width_rad);
            return Err(CalibrationError::UnsureLastDose { turned_deg, half_width_deg });
        }
        let start = dose.start();
        let run = Self {
            digit: None,
            speed_rpm: rpm(dose.speed_rad_s),
            start_angle_deg: start.is_stated().then_some(degrees(dose.start_angle_rad)),
            start_half_width_deg: None,
            turned_deg,
            reading,
            temperature_degc: Some(file.fluid.temperature_degc),
            time: Some(of_unix(dose.unix_s)),
        };
        match run.model_ml(pump, 1) {
            Err(CalibrationError::UnknownAngle { pitch_deg, .. }) => {
                let start_angle_deg = Some(degrees(start.angle_rad()));
                let half_width_deg = degrees(start.half_width_rad()).min(0.5 * pitch_deg);
                let within = Self { start_angle_deg, start_half_width_deg: Some(half_width_deg), ..run };
                within.sure_enough(file, pump, pitch_deg)
            }
            checked => checked.map(|_| run),
        }
    }

    /// Returns the run, unless the angles at which it may have begun leave its volume less sure than the model does.
    /// Such a reading says nothing that the model does not.
    fn sure_enough(self, file: &PumpFile, pump: &Pump, pitch_deg: f64) -> Result<Self, CalibrationError> {
        let unsure = self.angle_standard_ml(pump) / self.model_ml(pump, 1)?;
        if unsure < file.model_standard() {
            return Ok(self);
        }
        let turned_deg = self.turned_deg;
        let pitches = (turned_deg / pitch_deg).abs().floor();
        let pitch_ml = pump.outlet_curve().pitch_ml();
        // The least dose of whole pitches is one.
        let nearest_ml = [pitches.max(1.0), pitches.max(1.0) + 1.0].map(|whole| whole * pitch_ml);
        let [unsure_percent, model_percent] = [unsure, file.model_standard()].map(|part| 200.0 * part);
        Err(CalibrationError::LastDoseFromUnknownAngle {
            turned_deg,
            pitch_deg,
            unsure_percent,
            model_percent,
            nearest_ml,
        })
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
    pub(crate) fn is_of_dose(&self, other: &Self) -> bool {
        self.time == other.time && same_turn(self.turned_deg, other.turned_deg)
    }
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
    /// Earlier reading of the same dose with all its digits, in whose place this one is. `None` if there was none.
    pub replaced: Option<String>,
    /// Uncertainty that an angle between bounds leaves in the volume of the dose, in mL, k = 2. `None` for an angle
    /// that is known to better than 2 deg, and for whole pitches.
    pub by_angle_ml: Option<f64>,
    /// Calibration by this dose and the doses joined to it.
    pub calibration: Calibration,
    /// Reading beside the volume that was expected of the dose.
    likelihood: Likelihood,
}

/// Reading of a dose beside the volume that was expected of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Likelihood {
    measured_ml: f64,
    /// Volume by the calibration in use, or else by the model, in mL.
    expected_ml: f64,
    /// Expanded uncertainty of the difference, k = 2, in mL.
    expanded_ml: f64,
}

impl Likelihood {
    /// Compares the reading of `run`, a dose of the pump of `file`, with what is known of the pump without it.
    fn of(
        file: &PumpFile,
        pump: &Pump,
        run: &CalibrationRun,
        in_use: Option<&Stored>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        let (measured_ml, model_ml) = run.volumes_ml(pump, &Weighing::of(file), 1)?;
        let calibration = in_use.map(|stored| &stored.calibration);
        let rpm = run.speed_rpm.copysign(run.turned_deg);
        let by_speed = file.speed_dependent_pump()?;
        let found = calibration.and_then(|calibration| calibration.displacement.as_ref());
        let against = AgainstSpeed::of(found, &by_speed);
        let factor = against.map_or(Ok(1.0), |against| against.factor_at(rpm))?;
        let sureness = calibration.map_or(Ok(None), |used| used.sureness_at(pump, rpm, file))?;
        let of_mean = sureness.map_or(file.model_standard(), |sureness| sureness.common());
        let expected_ml = factor * model_ml;
        let of_run = expected.standard_of(factor * pump.revolution_ml(), factor, expected_ml);
        let of_angle = run.angle_standard_ml(pump) / model_ml;
        // A pulse that nobody measured is anything from none to twice its volume.
        let is_default = file.pulse_prior().is_some() && calibration.is_none_or(|used| used.pulse.is_none());
        let roller_ml = if is_default { factor * pump.roller_volume().total_ml() } else { 0.0 };
        let of_pulse = roller_ml / (sqrt(3.0) * expected_ml);
        let squares = [of_mean, of_run, of_angle, of_pulse].map(|part| part * part);
        let expanded_ml = 2.0 * sqrt(squares.iter().sum()) * expected_ml;
        Ok(Self { measured_ml, expected_ml, expanded_ml })
    }
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
        let run = CalibrationRun::of_last_dose(last, file, &pump, reading);
        let run = run.map_err(|error| error.by_calibration(weighing.in_use, last, &pump))?;
        let (Amount::Mass(digit) | Amount::Volume(digit)) = weighing.reading.resolution;
        let run = CalibrationRun { digit: Some(digit), ..run };
        let stated = last.map(|dose| dose.start()).filter(Phase::is_stated);
        let of_angle = |start| OverAngles::of(&pump, start, radians(run.turned_deg)).standard_ml;
        let angle_ml = stated.map_or(0.0, of_angle);
        let by_angle_ml = run.start_half_width_deg.map(|_| 2.0 * run.angle_standard_ml(&pump));
        let density = match reading {
            Reading::MassG(_) => Weighing::of(file).density_standard()?,
            Reading::VolumeMl(_) => 0.0,
        };
        let expected = weighing.expected.with_angle_ml(angle_ml).with_density(density);
        // A mistake in a unit is told before anything else.
        let likely = run.volumes_ml(&pump, &Weighing::of(file), 1);
        if let Err(error) = likely {
            let correction = last.map_or(Correction::NONE, |dose| dose.correction);
            // A pump file that was changed since may refuse the correction on record.
            let planned_ml = run.model_ml(&correction.of(&pump).unwrap_or(pump), 1)?;
            return Err(error.of_last_dose(planned_ml, &file.fluid.name));
        }
        let runs = run.clone().beside(active, weighing.earlier, &file.fluid.name)?;
        let replaced = active.filter(|_| weighing.earlier != Earlier::Left).and_then(|active| {
            let earlier = active.calibration.runs.iter().find(|earlier| earlier.is_of_dose(&run));
            earlier.map(CalibrationRun::reading_text)
        });
        let before = active.map(|active| &active.calibration);
        let likelihood = Likelihood::of(file, &pump, &run, weighing.in_use, &expected)?;
        let fit = fit_of_doses(&runs);
        let mut calibration = Calibration::of_runs(file, Source::Last, runs, fit, &expected, before)?;
        calibration.tube = before.and_then(|before| before.tube.clone());
        Ok(Self { run, replaced, by_angle_ml, calibration, likelihood })
    }

    /// Refuses a reading that lies further from the expected volume than twice the expanded uncertainty of the
    /// difference. A person may know better, so that nothing but this asks for it.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::UnlikelyReading`].
    pub fn check_likely(&self) -> Result<(), CalibrationError> {
        let Likelihood { measured_ml, expected_ml, expanded_ml } = self.likelihood;
        if (measured_ml - expected_ml).abs() <= 2.0 * expanded_ml {
            return Ok(());
        }
        Err(CalibrationError::UnlikelyReading { measured_ml, expected_ml, expanded_ml })
    }
}

impl CalibrationError {
    /// Returns the error of the one dose that was weighed, in place of that of a run. `planned_ml` is the volume that
    /// the dose was planned for, in mL.
    fn of_last_dose(self, planned_ml: f64, fluid: &str) -> Self {
        match self {
            Self::Implausible { measured_ml, model_ml, .. } => {
                Self::ImplausibleReading { measured_ml, planned_ml, model_ml, fluid: fluid.to_owned() }
            }
            error => error,
        }
    }

    /// Returns the error with the volumes of whole pitches by the calibration that doses use.
    fn by_calibration(self, in_use: Option<&Stored>, last: Option<LastDose>, pump: &Pump) -> Self {
        let mut error = self;
        let Self::LastDoseFromUnknownAngle { nearest_ml, .. } = &mut error else { return error };
        let found = in_use.and_then(|stored| stored.calibration.displacement.as_ref());
        let rpm = last.map_or(0.0, |dose| rpm(dose.speed_rad_s));
        let factor = found.and_then(|found| found.factor_at(pump, rpm).ok()).unwrap_or(1.0);
        *nearest_ml = nearest_ml.map(|volume_ml| factor * volume_ml);
        error
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
