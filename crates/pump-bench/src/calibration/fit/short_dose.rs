//! Short doses at known start angles, and tables of them.

use serde::{Deserialize, Serialize};

use crate::calibration::{CalibrationError, Reading, Weighing};
use crate::files::Table;

/// A short dose with the volume that arrived.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShortDose {
    /// Angle of the rollers at the start, by the record, in deg.
    pub start_angle_deg: f64,
    /// Angle that the rotor turned, in deg; negative in reverse.
    pub turned_deg: f64,
    /// Volume that arrived, in mL, without sign.
    pub volume_ml: f64,
    /// Cruise speed, in r/min; `None` takes the mean speed of the calibration's runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_rpm: Option<f64>,
}

/// Reads short doses: CSV with `start_angle_deg`, `turned_deg`, one of `mass_g` and `volume_ml`, and perhaps
/// `temperature_degc` and `speed_rpm`.
///
/// # Errors
///
/// [`CalibrationError::Table`] with the line of a cell that is not as it should be. Errors of
/// [`Weighing::volume_ml`] if the density of the fluid is not known at the temperature of a dose.
pub fn short_doses_of_csv(text: &str, weighing: &Weighing<'_>) -> Result<Vec<ShortDose>, CalibrationError> {
    let known =
        ["start_angle_deg", "turned_deg", "mass_g", "volume_ml", "temperature_degc", "speed_rpm", "time"];
    let table = Table::parse(text, &known)?;
    let mut doses = Vec::new();
    for row in table.rows() {
        let turned_deg = row.required("turned_deg")?;
        if turned_deg == 0.0 {
            return Err(row.error("turned_deg is 0; a dose turns".to_owned()).into());
        }
        let (name, value, reading) =
            row.one_of([("mass_g", Reading::MassG as fn(f64) -> Reading), ("volume_ml", Reading::VolumeMl)])?;
        if value <= 0.0 {
            return Err(row.error(format!("{name} is {value}; allowed: more than 0")).into());
        }
        let degc = row.number("temperature_degc")?.unwrap_or(weighing.fluid.temperature_degc);
        let volume_ml = match reading(value) {
            Reading::MassG(mass_g) => weighing.volume_ml(mass_g, degc)?,
            Reading::VolumeMl(volume_ml) => volume_ml,
        };
        let speed_rpm = row.number("speed_rpm")?;
        if let Some(rpm) = speed_rpm.filter(|rpm| *rpm <= 0.0) {
            return Err(row.error(format!("speed_rpm is {rpm}; allowed: more than 0")).into());
        }
        let start_angle_deg = row.required("start_angle_deg")?;
        doses.push(ShortDose { start_angle_deg, turned_deg, volume_ml, speed_rpm });
    }
    Ok(doses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_short_doses_is_read() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let text = "start_angle_deg,turned_deg,volume_ml\n0,24,1.2\n-10,-24,0.9\n";
        let doses = short_doses_of_csv(text, &Weighing::of(&file)).unwrap();
        assert_eq!(
            doses[1],
            ShortDose { start_angle_deg: -10.0, turned_deg: -24.0, volume_ml: 0.9, speed_rpm: None }
        );
        for bad in ["turned_deg,volume_ml\n24,1\n", "start_angle_deg,turned_deg,volume_ml\n0,0,1\n"] {
            assert!(short_doses_of_csv(bad, &Weighing::of(&file)).is_err());
        }
    }
}
