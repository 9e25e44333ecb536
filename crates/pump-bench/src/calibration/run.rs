//! A weighed run: the angle that the rotor turned, and the volume that arrived.

use std::fmt;

use libm::{round, sqrt};
use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::units::{degrees, radians};
use serde::{Deserialize, Serialize};

use crate::files::Table;

use super::{CalibrationError, Weighing};
use crate::units::last_digit;

/// A turn within this part of whole pitches delivers the same volume from any angle, within twice this part:
/// the largest flow is at most twice the mean.
const WHOLE_PITCHES: f64 = 1e-3;

/// A measured volume further from the model's than this factor either way is a mistake.
pub(crate) const PLAUSIBLE: f64 = 2.0;

/// Reading of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reading {
    /// Mass that the scale showed, in g.
    MassG(f64),
    /// Volume that a measuring vessel showed, in mL.
    VolumeMl(f64),
}

/// Words the reading with its unit, as it would be typed.
impl fmt::Display for Reading {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MassG(mass_g) => write!(to, "{mass_g}g"),
            Self::VolumeMl(volume_ml) => write!(to, "{volume_ml}mL"),
        }
    }
}

/// A run at constant speed with the volume that arrived.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationRun {
    /// Cruise speed, in r/min, positive.
    pub speed_rpm: f64,
    /// Angle of the rollers at the start, in deg; `None` if nobody knows.
    pub start_angle_deg: Option<f64>,
    /// Distance of the true angle at the start from `start_angle_deg`, in deg, at most. The run then counts with the
    /// mean volume over these angles. `None` takes the angle as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_half_width_deg: Option<f64>,
    /// Angle that the rotor turned, in deg; negative in reverse.
    pub turned_deg: f64,
    /// Reading of scale or vessel, without sign.
    pub reading: Reading,
    /// Step of the reading's last digit, in its unit; `None` if nobody wrote the reading down as text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub digit: Option<f64>,
    /// Temperature of the fluid, in °C; `None` takes the pump file's.
    pub temperature_degc: Option<f64>,
    /// Time of the run, as it was written down.
    pub time: Option<String>,
}

impl CalibrationRun {
    /// Returns the reading with its unit and all its digits, as it was typed: the last one says how sure it is.
    pub fn reading_text(&self) -> String {
        let (value, unit) = match self.reading {
            Reading::MassG(mass_g) => (mass_g, "g"),
            Reading::VolumeMl(volume_ml) => (volume_ml, "mL"),
        };
        let Some(digit) = self.digit else { return self.reading.to_string() };
        let decimals = round(-libm::log10(digit)).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}{unit}")
    }

    /// Returns the volume that arrived, in mL.
    ///
    /// # Errors
    ///
    /// Errors of [`Weighing::volume_ml`] if the density of the fluid is not known at the temperature of the
    /// run.
    pub(crate) fn measured_ml(&self, weighing: &Weighing<'_>) -> Result<f64, CalibrationError> {
        match self.reading {
            Reading::VolumeMl(volume_ml) => Ok(volume_ml),
            Reading::MassG(mass_g) => weighing.volume_ml(mass_g, self.temperature_degc(weighing)),
        }
    }

    /// Returns the temperature of the fluid, in °C.
    pub(crate) fn temperature_degc(&self, weighing: &Weighing<'_>) -> f64 {
        self.temperature_degc.unwrap_or(weighing.fluid.temperature_degc)
    }

    /// Returns the run with this temperature in °C, if it was weighed and its own is not known.
    pub(super) fn at_degc(mut self, degc: f64) -> Self {
        if matches!(self.reading, Reading::MassG(_)) {
            self.temperature_degc.get_or_insert(degc);
        }
        self
    }

    /// Returns the model volume of the angle turned, in mL, without sign; `number` names the run in errors.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::UnknownAngle`] if the run turned a part of a pitch from an unknown angle.
    pub(crate) fn model_ml(&self, pump: &Pump, number: usize) -> Result<f64, CalibrationError> {
        match self.angles() {
            Some(start) => Ok(OverAngles::of(pump, start, radians(self.turned_deg)).mean_ml.abs()),
            None => turned_ml(pump, self.start_angle_deg, self.turned_deg, number),
        }
    }

    /// Returns the standard deviation of the model volume over the angles at which the run may have begun, in mL; 0
    /// for an angle that is taken as it is.
    pub(super) fn angle_standard_ml(&self, pump: &Pump) -> f64 {
        self.angles().map_or(0.0, |start| OverAngles::of(pump, start, radians(self.turned_deg)).standard_ml)
    }

    /// Returns the angles at which the run may have begun. `None` for an angle that is taken as it is.
    fn angles(&self) -> Option<Phase> {
        let (start_deg, half_width_deg) = self.start_angle_deg.zip(self.start_half_width_deg)?;
        Some(Phase::within(radians(start_deg), radians(half_width_deg)))
    }

    /// Returns measured and model volume, in mL; `number` names the run in errors.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Implausible`] if the measured volume is more than twice the model's or less than
    /// half of it. [`CalibrationError::UnknownAngle`] if the run turned a part of a pitch from an unknown
    /// angle. Errors of [`Weighing::volume_ml`] if the run was weighed.
    pub fn volumes_ml(
        &self,
        pump: &Pump,
        weighing: &Weighing<'_>,
        number: usize,
    ) -> Result<(f64, f64), CalibrationError> {
        let (measured_ml, model_ml) = (self.measured_ml(weighing)?, self.model_ml(pump, number)?);
        if (1.0 / PLAUSIBLE..=PLAUSIBLE).contains(&(measured_ml / model_ml)) {
            Ok((measured_ml, model_ml))
        } else {
            Err(CalibrationError::Implausible { run: number, measured_ml, model_ml })
        }
    }
}

/// Volume of a turn over the start angles that a phase allows. They are equally likely.
pub(super) struct OverAngles {
    /// Mean of the volumes, in mL, negative in reverse.
    pub(super) mean_ml: f64,
    /// Standard deviation of the volumes, in mL.
    pub(super) standard_ml: f64,
}

impl OverAngles {
    pub(super) fn of(pump: &Pump, start: Phase, turned_rad: f64) -> Self {
        const ANGLES: i32 = 32;
        let curve = pump.outlet_curve();
        // Beyond a pitch the volumes come again.
        let half_width_rad = start.half_width_rad().min(0.5 * curve.pitch_rad());
        let volume_ml = |n: i32| {
            let part = f64::from(2 * n + 1) / f64::from(ANGLES) - 1.0;
            let from_rad = start.angle_rad() + half_width_rad * part;
            curve.volume_ml(from_rad + turned_rad) - curve.volume_ml(from_rad)
        };
        let mean_ml = (0..ANGLES).map(volume_ml).sum::<f64>() / f64::from(ANGLES);
        let squares = (0..ANGLES).map(|n| (volume_ml(n) - mean_ml).powi(2)).sum::<f64>();
        Self { mean_ml, standard_ml: sqrt(squares / f64::from(ANGLES)) }
    }
}

/// Returns the model volume of a turn from `start_angle_deg`, in mL, without sign. `None` is an unknown angle;
/// `number` names the run in errors.
pub(crate) fn turned_ml(
    pump: &Pump,
    start_angle_deg: Option<f64>,
    turned_deg: f64,
    number: usize,
) -> Result<f64, CalibrationError> {
    let curve = pump.outlet_curve();
    let turn_rad = radians(turned_deg);
    if let Some(start_deg) = start_angle_deg {
        let start_rad = radians(start_deg);
        return Ok((curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad)).abs());
    }
    let pitches = (turn_rad / curve.pitch_rad()).abs();
    let whole = round(pitches);
    if whole > 0.0 && (pitches - whole).abs() <= WHOLE_PITCHES * whole {
        Ok(pitches * curve.pitch_ml())
    } else {
        Err(CalibrationError::UnknownAngle { run: number, turned_deg, pitch_deg: degrees(curve.pitch_rad()) })
    }
}

/// Columns of a table of runs.
const COLUMNS: &[&str] = &[
    "speed_rpm",
    "start_angle_deg",
    "turned_deg",
    "revolutions",
    "steps",
    "direction",
    "mass_g",
    "volume_ml",
    "temperature_degc",
    "time",
];

/// Reads a table of runs: CSV with a header.
///
/// A run has a `speed_rpm`, one of `turned_deg`, `revolutions` and `steps` (`steps_per_rev` of the pump head
/// make a revolution), and one of `mass_g` and `volume_ml`. It may have a `start_angle_deg`, a `direction` (1
/// or -1), a `temperature_degc` and a `time`.
///
/// # Errors
///
/// [`CalibrationError::Table`] with the line of a cell that is not as it should be.
pub fn runs_of_csv(text: &str, steps_per_rev: f64) -> Result<Vec<CalibrationRun>, CalibrationError> {
    let table = Table::parse(text, COLUMNS)?;
    let mut runs = Vec::new();
    for row in table.rows() {
        let turned = [("turned_deg", 1.0), ("revolutions", 360.0), ("steps", 360.0 / steps_per_rev)];
        let (name, value, unit_deg) = row.one_of(turned)?;
        let direction = match row.number("direction")? {
            None => 1.0,
            Some(sign) if sign.abs() == 1.0 => sign,
            Some(other) => return Err(row.error(format!("direction is {other}; allowed: 1 or -1")).into()),
        };
        let turned_deg = direction * value * unit_deg;
        if turned_deg == 0.0 || turned_deg.abs() > 360e6 {
            return Err(row
                .error(format!("{name} is {value}; a run turns by more than 0 and up to a million turns"))
                .into());
        }
        let (name, value, is_mass) = row.one_of([("mass_g", true), ("volume_ml", false)])?;
        let digit = row.text(name).map(last_digit);
        if value <= 0.0 {
            return Err(row.error(format!("{name} is {value}; allowed: more than 0")).into());
        }
        runs.push(CalibrationRun {
            digit,
            speed_rpm: row.positive("speed_rpm")?,
            start_angle_deg: row.number("start_angle_deg")?,
            start_half_width_deg: None,
            turned_deg,
            reading: if is_mass { Reading::MassG(value) } else { Reading::VolumeMl(value) },
            temperature_degc: row.number("temperature_degc")?,
            time: row.text("time").map(str::to_owned),
        });
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Expected;

    #[test]
    fn a_table_may_say_angles_turns_or_steps_and_grams_or_millilitres() {
        let text = "speed_rpm, turned_deg, revolutions, steps, direction, mass_g, volume_ml, start_angle_deg,\
                    \x20time\n\
                    60, 720,,, 1, 42.5,, 10, 9:30\n\
                    # a comment\n\
                    \n\
                    60,, 2,, -1,, 42.6,, 9:32\n\
                    90,,, 25600,,, 42.6,,\n";
        let runs = runs_of_csv(text, 12_800.0).unwrap();
        assert_eq!(runs.len(), 3);
        assert_eq!((runs[0].turned_deg, runs[1].turned_deg, runs[2].turned_deg), (720.0, -720.0, 720.0));
        assert_eq!((runs[0].reading, runs[1].reading), (Reading::MassG(42.5), Reading::VolumeMl(42.6)));
        assert_eq!((runs[0].start_angle_deg, runs[1].start_angle_deg), (Some(10.0), None));
        assert_eq!(runs[0].time.as_deref(), Some("9:30"));
        assert_eq!(runs[2].time, None);
        let steps: Vec<_> = runs.iter().map(|run| run.digit.unwrap()).collect();
        assert!(steps.iter().all(|step| (step - 0.1).abs() < 1e-12), "{steps:?}");
    }

    #[test]
    fn zeros_at_the_end_of_a_reading_are_digits() {
        let of = |mass: &str| {
            let text = format!("speed_rpm,revolutions,mass_g\n60,3,{mass}\n60,3,{mass}\n60,3,{mass}\n");
            let file = crate::built_in("three-roller").unwrap();
            Expected::of_runs(&file, &runs_of_csv(&text, 12_800.0).unwrap()).reading_ml
        };
        assert!((of("64.00") / of("64.01") - 1.0).abs() < 1e-12);
        assert!((of("64") / of("64.00") - 100.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_refused_is_named_with_its_line() {
        let refused = |text: &str| runs_of_csv(text, 12_800.0).unwrap_err().to_string();
        for (text, part) in [
            ("", "line 1: the table is empty"),
            ("speed_rpm,turned_deg,mass\n60,720,42\n", "line 1: unknown column `mass`"),
            ("speed_rpm,speed_rpm\n", "line 1: column `speed_rpm` stands twice"),
            ("speed_rpm,turned_deg,mass_g\n60,720\n", "line 2: 2 cells under 3 columns"),
            ("speed_rpm,turned_deg,mass_g\n60,720,\n", "line 2: give one of mass_g, volume_ml"),
            (
                "speed_rpm,turned_deg,mass_g,volume_ml\n60,720,42,42\n",
                "line 2: give one of mass_g, volume_ml",
            ),
            ("speed_rpm,turned_deg,mass_g\n60,720,-42\n", "mass_g is -42"),
            ("speed_rpm,turned_deg,mass_g\n60,0,42\n", "turned_deg is 0"),
            ("speed_rpm,turned_deg,mass_g\n60,720,nan\n", "mass_g is `nan`"),
            ("speed_rpm,turned_deg,mass_g\n60,720,42 g\n", "mass_g is `42 g`"),
            ("speed_rpm,turned_deg,mass_g\n-60,720,42\n", "speed_rpm is -60"),
            ("turned_deg,mass_g\n720,42\n", "line 2: speed_rpm is missing"),
            ("speed_rpm,turned_deg,mass_g,direction\n60,720,42,2\n", "direction is 2"),
        ] {
            assert!(refused(text).contains(part), "{text}: {}", refused(text));
        }
    }

    #[test]
    fn the_phase_cancels_over_whole_pitches_and_counts_elsewhere() {
        let pump = Pump::three_roller();
        let run = |start_angle_deg, turned_deg| CalibrationRun {
            digit: None,
            speed_rpm: 60.0,
            start_angle_deg,
            start_half_width_deg: None,
            turned_deg,
            reading: Reading::VolumeMl(1.0),
            temperature_degc: None,
            time: None,
        };
        let pitch_ml = pump.revolution_ml() / 3.0;
        for start in [None, Some(0.0), Some(17.0), Some(-1000.0)] {
            assert!((run(start, 240.0).model_ml(&pump, 1).unwrap() - 2.0 * pitch_ml).abs() < 1e-9);
            assert!((run(start, -120.0).model_ml(&pump, 1).unwrap() - pitch_ml).abs() < 1e-9);
        }
        let at = |start| run(Some(start), 30.0).model_ml(&pump, 1).unwrap();
        assert!(at(10.0) < 0.8 && at(80.0) > 2.2, "{} {}", at(10.0), at(80.0));
        let error = run(None, 30.0).model_ml(&pump, 4).unwrap_err().to_string();
        assert!(error.contains("run 4 turned 30 deg from an unknown angle"), "{error}");
    }
}
