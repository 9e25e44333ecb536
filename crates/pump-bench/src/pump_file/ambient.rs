//! `[ambient]`: the surroundings of the pump.

mod atmosphere;

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, allow, within};
use atmosphere::{ALTITUDES_M, SEA_LEVEL_KPA, pressure_at_kpa};

/// The table `[ambient]`.
///
/// ```
/// use pump_bench::pump_file::{AmbientSource, AmbientTable};
///
/// let highland = AmbientTable::at_altitude_m(1600.0);
/// assert!((highland.pressure_kpa - 83.5).abs() < 0.1);
/// assert_eq!(AmbientTable::default().source(), AmbientSource::SeaLevel);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AmbientKeys", into = "AmbientKeys")]
#[non_exhaustive]
pub struct AmbientTable {
    /// Atmospheric pressure, in kPa absolute. Gauge pressures are measured against it.
    pub pressure_kpa: f64,
    /// Altitude from which the pressure was computed, or 0 where neither was given, in m.
    altitude_m: Option<f64>,
    /// True if the file gives the altitude.
    is_given: bool,
}

/// Source of the atmospheric pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AmbientSource {
    /// The pump file gives the pressure.
    Pressure,
    /// The pump file gives the altitude, in m. The pressure is that of the standard atmosphere (ISO 2533).
    Altitude(f64),
    /// The pump file gives neither: the pressure is that of the standard atmosphere at sea level.
    SeaLevel,
}

impl AmbientTable {
    /// Returns the surroundings at an atmospheric pressure in kPa absolute.
    pub fn of_pressure_kpa(pressure_kpa: f64) -> Self {
        Self { pressure_kpa, altitude_m: None, is_given: true }
    }

    /// Returns the surroundings at a geometric altitude in m, -500 to 9000, by the standard atmosphere (ISO 2533).
    pub fn at_altitude_m(altitude_m: f64) -> Self {
        Self { pressure_kpa: pressure_at_kpa(altitude_m), altitude_m: Some(altitude_m), is_given: true }
    }

    /// Returns the source of the pressure. A pressure that was changed since the file was read counts as given.
    pub fn source(&self) -> AmbientSource {
        match self.altitude_m.filter(|altitude_m| pressure_at_kpa(*altitude_m) == self.pressure_kpa) {
            None => AmbientSource::Pressure,
            Some(altitude_m) if self.is_given => AmbientSource::Altitude(altitude_m),
            Some(_) => AmbientSource::SeaLevel,
        }
    }

    /// Returns true if a place has this altitude or this pressure.
    pub(crate) fn is_possible(&self) -> bool {
        self.check().is_ok()
    }

    /// Refuses an altitude outside -500 to 9000 m, and an atmospheric pressure outside 1 to 10000 kPa.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        let (least_m, most_m) = (ALTITUDES_M.start(), ALTITUDES_M.end());
        let allowed = format!("{least_m} to {most_m}; elsewhere give pressure_kpa");
        let altitude_m = self.altitude_m.unwrap_or(0.0);
        allow(ALTITUDES_M.contains(&altitude_m), "[ambient] altitude_m", altitude_m, &allowed)?;
        within("[ambient] pressure_kpa", self.pressure_kpa, 1.0..=1e4)
    }
}

impl Default for AmbientTable {
    /// Returns the surroundings of a file that says nothing of them: the standard atmosphere at sea level.
    fn default() -> Self {
        Self { pressure_kpa: SEA_LEVEL_KPA, altitude_m: Some(0.0), is_given: false }
    }
}

/// Keys of the table: one of them, or none.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AmbientKeys {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pressure_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    altitude_m: Option<f64>,
}

impl TryFrom<AmbientKeys> for AmbientTable {
    type Error = String;

    fn try_from(keys: AmbientKeys) -> Result<Self, String> {
        match (keys.pressure_kpa, keys.altitude_m) {
            (Some(pressure_kpa), None) => Ok(Self::of_pressure_kpa(pressure_kpa)),
            (None, Some(altitude_m)) => Ok(Self::at_altitude_m(altitude_m)),
            (None, None) => Ok(Self::default()),
            (Some(_), Some(_)) => {
                Err("`pressure_kpa` and `altitude_m` exclude each other: an altitude gives the pressure"
                    .to_owned())
            }
        }
    }
}

impl From<AmbientTable> for AmbientKeys {
    fn from(table: AmbientTable) -> Self {
        match table.source() {
            AmbientSource::Pressure => Self { pressure_kpa: Some(table.pressure_kpa), altitude_m: None },
            AmbientSource::Altitude(altitude_m) => Self { pressure_kpa: None, altitude_m: Some(altitude_m) },
            AmbientSource::SeaLevel => Self { pressure_kpa: None, altitude_m: None },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pump_file::PumpFile;

    /// Parses the three-roller pump with these keys in `[ambient]`.
    fn parsed(keys: &str) -> Result<PumpFile, String> {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let text = text.replace("[ambient]\npressure_kpa = 85.7\n", keys);
        PumpFile::parse(&text, "a file").map_err(|error| error.to_string())
    }

    #[test]
    fn an_altitude_is_read_written_and_named_as_the_source() {
        let file = parsed("[ambient]\naltitude_m = 1350.0\n").unwrap();
        // The altitude at which the standard atmosphere has the paper's 85.7 kPa lies near 1390 m.
        assert!((file.ambient.pressure_kpa - 86.1).abs() < 0.1, "{}", file.ambient.pressure_kpa);
        assert_eq!(file.ambient.source(), AmbientSource::Altitude(1350.0));
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        let mut changed = file;
        changed.ambient.pressure_kpa = 90.0;
        assert_eq!(changed.ambient.source(), AmbientSource::Pressure);
        let again = PumpFile::parse(&changed.to_toml(), "changed").unwrap();
        assert_eq!(again.ambient.pressure_kpa, 90.0);
    }

    #[test]
    fn without_either_the_file_stands_at_sea_level_and_says_so() {
        for keys in ["", "[ambient]\n"] {
            let file = parsed(keys).unwrap();
            assert_eq!(
                (file.ambient.pressure_kpa, file.ambient.source()),
                (101.325, AmbientSource::SeaLevel)
            );
            assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        }
    }

    #[test]
    fn surroundings_that_cannot_be_are_refused() {
        for (keys, part) in [
            ("altitude_m = 9001.0", "[ambient] altitude_m is 9001; allowed: -500 to 9000"),
            ("altitude_m = -501.0", "[ambient] altitude_m is -501; allowed: -500 to 9000"),
            ("altitude_m = nan", "[ambient] altitude_m is NaN"),
            ("altitude_m = 100.0\npressure_kpa = 100.0", "exclude each other"),
            ("pressure_kpa = 0.5", "[ambient] pressure_kpa is 0.5; allowed: 1 to 10000"),
            ("pressure = 100.0", "unknown field `pressure`"),
        ] {
            let error = parsed(&format!("[ambient]\n{keys}\n")).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
