//! A calibration as it is stored.

use pump_model::units::radians;
use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

use super::applied::{Sureness, WeighedTurn};
use super::date;
use super::error::CalibrationError;
use super::fit::{Displacement, Expected, FittedPulse, PhaseFit, PulseSureness, ShortDose};
use super::run::CalibrationRun;
use crate::displacement::Correction;
use crate::pump_file::PumpFile;

/// Schema of stored calibrations.
const SCHEMA: &str = "calibration/1";

/// End to end difference of a straight line whose RMS about its mean is 1.
const LINE_OVER_RMS: f64 = 3.464_101_615_137_754_6;

/// Origin of the runs of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// A table.
    File,
    /// Runs that `dose calibrate run` made, with readings that were typed.
    Guided,
    /// Doses that were weighed after they were made.
    Last,
    /// Short doses, which show the zero of the angle.
    Phase,
}

/// A calibration as it is stored: raw data, the values that were found, and the pump and fluid that they
/// belong to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Calibration {
    /// Schema of the data: `calibration/1`.
    pub schema: String,
    /// Date at which the calibration was made, UTC.
    pub date: String,
    /// Origin of the runs.
    pub source: Source,
    /// Name that the user gave the tube.
    pub tube: Option<String>,
    /// Number of the tube, from 1, that was in the head when the calibration was kept; `None` in calibrations of
    /// earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube_number: Option<u32>,
    /// Note of the user.
    pub note: Option<String>,
    /// Name of the fluid that was pumped.
    pub fluid: String,
    /// Mean temperature of the fluid, in °C.
    pub temperature_degc: f64,
    /// Pressure of the air around the scale, in kPa absolute.
    pub ambient_kpa: f64,
    /// Model volume of a revolution that the factors multiply, in mL.
    pub revolution_ml: f64,
    /// Motor steps per revolution of the head, as the pump file stated them; `None` in calibrations of earlier
    /// versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps_per_rev: Option<f64>,
    /// Rollers of the head and bore of its tube in words, as the pump file stated them; `None` in calibrations of
    /// earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head: Option<String>,
    /// Displacement factor; `None` while only the zero was sought.
    pub displacement: Option<Displacement>,
    /// Weighed runs that the displacement factor was fitted to.
    pub runs: Vec<CalibrationRun>,
    /// Model angle of the rollers where the record says 0, in deg.
    pub zero_deg: f64,
    /// Standard uncertainty of the zero, in deg.
    pub zero_standard_deg: f64,
    /// Roller volume and engagement angle that the short doses found; `None` if they corrected the zero alone,
    /// as in calibrations of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulse: Option<FittedPulse>,
    /// Short doses that pulse and zero were fitted to.
    pub short_doses: Vec<ShortDose>,
}

/// Returns the rollers of a head and the bore of its tube, in words.
pub(crate) fn head_in_words(file: &PumpFile) -> String {
    let bore_mm = file.head.as_ref().and_then(|head| head.tube_bore_mm);
    let tube = bore_mm.map_or(String::new(), |bore_mm| format!(" and a tube of {bore_mm} mm bore"));
    format!("{} rollers{tube}", file.rollers.count)
}

impl Calibration {
    /// Returns a calibration of the pump of `file` that has no runs and corrects nothing yet.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Model`] if the pump of `file` cannot be modelled.
    pub fn empty(file: &PumpFile, source: Source) -> Result<Self, CalibrationError> {
        Ok(Self {
            schema: SCHEMA.to_owned(),
            date: date::now(),
            source,
            tube: None,
            tube_number: None,
            note: None,
            fluid: file.fluid.name.clone(),
            temperature_degc: file.fluid.temperature_degc,
            ambient_kpa: file.ambient.pressure_kpa,
            revolution_ml: file.model()?.revolution_ml(),
            steps_per_rev: Some(file.motor.steps_at_pump_head()),
            head: Some(head_in_words(file)),
            displacement: None,
            runs: Vec::new(),
            zero_deg: 0.0,
            zero_standard_deg: 0.0,
            pulse: None,
            short_doses: Vec::new(),
        })
    }

    /// Returns true for a few weighed doses that show the mean volume less well than the model of `file` does.
    ///
    /// # Errors
    ///
    /// [`CalibrationError`] if the displacement cannot be had of the pump `base`.
    pub(crate) fn is_less_sure_than_the_model(
        &self,
        file: &PumpFile,
        base: &Pump,
    ) -> Result<bool, CalibrationError> {
        let Some(found) = self.displacement.as_ref().filter(|found| found.prior.is_some()) else {
            return Ok(false);
        };
        Ok(found.whole_part_at(base, found.reference_rpm)? > file.model_standard())
    }

    /// Checks that the data have the schema of this version.
    ///
    /// # Errors
    ///
    /// A message that names both schemas if they differ.
    pub fn check_schema(&self) -> Result<(), String> {
        if self.schema == SCHEMA {
            return Ok(());
        }
        Err(format!("its schema is `{}`; this version reads `{SCHEMA}`", self.schema))
    }

    /// Returns the model angle of the rollers where the record says 0, in rad.
    pub fn zero_rad(&self) -> f64 {
        radians(self.zero_deg)
    }

    /// Returns the model volume of the largest run, in mL.
    fn run_ml(&self) -> f64 {
        let turned = self.runs.iter().map(|run| run.turned_deg.abs());
        self.revolution_ml * turned.fold(0.0, f64::max) / 360.0
    }

    /// Returns the turns of the runs that the displacement rests on.
    pub(crate) fn turns(&self) -> Vec<WeighedTurn> {
        let turn = |run: &CalibrationRun| WeighedTurn {
            start_rad: run.start_angle_deg.map(radians),
            half_width_rad: run.start_half_width_deg.map_or(0.0, radians),
            turned_rad: radians(run.turned_deg),
        };
        self.runs.iter().filter(|_| self.displacement.is_some()).map(turn).collect()
    }

    /// Returns the correction of the zero and of the pulse, with a factor of 1.
    pub(crate) fn shape(&self) -> Correction {
        let pulse = self.pulse.map(|pulse| pulse.correction());
        Correction { zero_rad: self.zero_rad(), pulse, ..Correction::NONE }
    }

    /// Returns the joint uncertainty of the pulse and the zero, or `None` if no pulse was fitted.
    pub(crate) fn pulse_sureness(&self) -> Option<PulseSureness> {
        self.pulse.map(|pulse| pulse.sureness(self.zero_standard_deg))
    }

    /// Returns this calibration with the pulse and the zero that were found of its short doses.
    #[must_use]
    pub(super) fn with_pulse(self, found: &PhaseFit, expected: &Expected) -> Self {
        Self {
            zero_deg: found.zero_deg.value,
            zero_standard_deg: found.zero_deg.standard,
            pulse: Some(FittedPulse::of(found, expected)),
            ..self
        }
    }

    /// Returns the uncertainty of the displacement for a dose of `base`, the pump of `file`, that cruises at
    /// `rpm`, negative in reverse. Returns `None` if no displacement was weighed.
    ///
    /// One speed or two do not show how the volume depends on the speed. The share for that then takes all of
    /// the model's uncertainty over the motor's speeds as a straight line. It is
    /// sqrt(12) u |N - N_nearest|/N_max, with u the pump file's speed_percent or else model_percent, and N_nearest
    /// the nearest speed of the runs. With three speeds or more it is the distance of the runs from their line or
    /// law.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(crate) fn sureness_at(
        &self,
        base: &Pump,
        rpm: f64,
        file: &PumpFile,
    ) -> Result<Option<Sureness>, ModelError> {
        let Some(displacement) = &self.displacement else { return Ok(None) };
        Ok(Some(Sureness {
            factor: displacement.standard_at(base, rpm)? / displacement.factor_at(base, rpm)?,
            speed_dependence: if displacement.speeds_rpm.len() < 3 {
                let distance = displacement.distance_rpm(rpm.abs()) / file.motor.max_speed_rpm;
                LINE_OVER_RMS * file.uncertainty.over_speeds() * distance
            } else {
                displacement.lack_of_fit
            },
            repeatability: displacement.repeatability(),
            run_ml: displacement.scatter.standard().map_or(0.0, |_| displacement.factor * self.run_ml()),
            prior: displacement.prior.filter(|_| file.uncertainty.repeatability_at_ml.is_none()),
            warmer_degc: file.fluid.temperature_degc - self.temperature_degc,
        }))
    }
}
