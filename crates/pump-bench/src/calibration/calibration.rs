//! A calibration, and what it makes of a dose at one speed.

use pump_model::math::{radians, sqrt};
use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

use super::date;
use super::error::CalibrationError;
use super::fit::{Displacement, ShortDose};
use super::run::Run;
use crate::displacement::Correction;
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Schema of stored calibrations.
const SCHEMA: &str = "calibration/1";

/// End to end difference of a straight line whose RMS about its mean is 1.
const LINE_OVER_RMS: f64 = 3.464_101_615_137_754_6;

/// Where runs come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// A table.
    File,
    /// Runs that `dose calibrate run` made, with readings that were typed.
    Guided,
    /// Short doses: the zero of the angle.
    Phase,
}

/// A calibration as it is stored: raw data, what was found, and of what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// `calibration/1`.
    pub schema: String,
    /// When it was made, UTC.
    pub date: String,
    /// Where the runs come from.
    pub source: Source,
    /// The tube, as the user calls it.
    pub tube: Option<String>,
    /// What the user wants remembered.
    pub note: Option<String>,
    /// Fluid that was pumped.
    pub fluid: String,
    /// Its mean temperature, °C.
    pub temperature_degc: f64,
    /// Pressure of the air around the scale, kPa absolute.
    pub ambient_kpa: f64,
    /// Model volume of a revolution that the factors multiply, mL.
    pub revolution_ml: f64,
    /// The displacement factor; none while only the zero was sought.
    pub displacement: Option<Displacement>,
    /// Its runs.
    pub runs: Vec<Run>,
    /// Model angle of the rollers where the record says 0, deg.
    pub zero_deg: f64,
    /// Standard uncertainty of that, deg.
    pub zero_standard_deg: f64,
    /// The short doses that it comes from.
    pub short_doses: Vec<ShortDose>,
}

/// What a calibration, the pump file's speed law or both make of a dose at its cruise speed; uncertainties are parts of the
/// volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Applied {
    /// The calibration; none of the speed law alone.
    pub calibration: Option<Made>,
    /// What is changed.
    pub correction: Correction,
    /// How sure the displacement is that was weighed; none if it is the model's or the speed law's.
    pub displacement: Option<Sureness>,
    /// Standard uncertainty of the pump file's speed law, where that says the displacement.
    pub speed_law: Option<f64>,
    /// Standard uncertainty of the zero, rad.
    pub zero_standard_rad: f64,
}

/// Which calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// Its number.
    pub version: u32,
    /// When it was made.
    pub date: String,
}

/// How sure a calibrated displacement is: parts of the volume, standard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sureness {
    /// Of the factor at this speed: scatter of the runs and the readings.
    pub factor: f64,
    /// What the volume may depend on the speed beyond what the runs show.
    pub speed_law: f64,
    /// Standard deviation of the runs; 0 if it could not be told.
    pub repeatability: f64,
    /// Fluid of the dose less fluid of the runs, °C.
    pub warmer_degc: f64,
}

impl Calibration {
    /// A calibration of the pump of `file` that says nothing yet.
    pub fn empty(file: &PumpFile, source: Source) -> Result<Self, CalibrationError> {
        Ok(Self {
            schema: SCHEMA.to_owned(),
            date: date::now(),
            source,
            tube: None,
            note: None,
            fluid: file.fluid.name.clone(),
            temperature_degc: file.fluid.temperature_degc,
            ambient_kpa: file.ambient.pressure_kpa,
            revolution_ml: file.model()?.revolution_ml(),
            displacement: None,
            runs: Vec::new(),
            zero_deg: 0.0,
            zero_standard_deg: 0.0,
            short_doses: Vec::new(),
        })
    }

    /// Refuses data of another schema, in words.
    pub fn check_schema(&self) -> Result<(), String> {
        if self.schema == SCHEMA {
            return Ok(());
        }
        Err(format!("its schema is `{}`; this version reads `{SCHEMA}`", self.schema))
    }

    /// Model angle of the rollers where the record says 0, rad.
    pub fn zero_rad(&self) -> f64 {
        radians(self.zero_deg)
    }

    /// How sure its displacement is for a dose of `base`, the pump of `file`, that cruises at `rpm`, negative in reverse.
    ///
    /// With one speed or two nobody has seen how the volume depends on the speed. The share for that is then what it is if
    /// all of the model's uncertainty over the motor's speeds were a straight line, over the distance to the nearest speed
    /// of the runs: sqrt(12) model_percent |N - N_nearest|/N_max. With three or more it is what the runs depart from their
    /// line, or the speed law, by.
    pub fn sureness_at(
        &self,
        base: &Pump,
        rpm: f64,
        file: &PumpFile,
    ) -> Result<Option<Sureness>, ModelError> {
        let Some(displacement) = &self.displacement else { return Ok(None) };
        Ok(Some(Sureness {
            factor: displacement.standard_at(base, rpm)?,
            speed_law: if displacement.speeds_rpm.len() < 3 {
                let distance = displacement.distance_rpm(rpm.abs()) / file.motor.max_speed_rpm;
                LINE_OVER_RMS * file.uncertainty.model_percent / 100.0 * distance
            } else {
                displacement.lack_of_fit
            },
            repeatability: displacement.scatter.unwrap_or(0.0),
            warmer_degc: file.fluid.temperature_degc - self.temperature_degc,
        }))
    }
}

impl Sureness {
    /// What the user should know of a speed at which nothing was weighed.
    pub(crate) fn warning(&self, version: u32, calibrated: &Displacement, rpm: f64) -> Option<String> {
        let percent = 100.0 * self.speed_law;
        (calibrated.speeds_rpm.len() < 3 && percent > 0.0).then(|| {
            let speeds: Vec<String> = calibrated.speeds_rpm.iter().map(|speed| significant(*speed, 5)).collect();
            format!(
                "calibration {version} was made at {} r/min alone, and this dose cruises at {}: {percent:.2} % of the \
                 volume is added to the uncertainty for that; calibrate at three speeds or more",
                speeds.join(" and "),
                significant(rpm, 5),
            )
        })
    }

    /// Root of the sum of squares of what is common to all doses at this speed.
    pub fn common(&self) -> f64 {
        sqrt(self.factor * self.factor + self.speed_law * self.speed_law)
    }
}
