//! `[speed_law]`: how the volume of a revolution depends on the speed, if it does.

use pump_model::units::radians;
use pump_model::{Drawing, Geometry, ModelError, SpeedLaw};
use serde::{Deserialize, Serialize};

use super::range::{WrongValue, positive, positive_up_to, within};
use crate::displacement::DisplacementLaw;

/// The table `[speed_law]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SpeedLawTable {
    /// No law: the volume of a revolution is constant over the speed.
    #[serde(rename = "none")]
    Off {},
    /// Law by which a segment's volume depends on the inlet pressure that traps it. Experimental, see
    /// [`SpeedLaw`].
    InletPressure {
        /// Volume between two rollers over the volume of the round tube, s.
        s: f64,
        /// Growth of a segment's volume with the pressure D, in 1/kPa.
        d_per_kpa: f64,
        /// Angle at which an engaging roller closes the lumen theta_c, in deg. `None` takes it from the
        /// dimensions.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        closure_angle_deg: Option<f64>,
        /// Slowest speed at which the law holds, in r/min.
        least_rpm: f64,
        /// Fastest speed at which the law holds, in r/min.
        most_rpm: f64,
        /// Standard uncertainty of the law's volumes, in percent. It replaces `model_percent` while the pump
        /// is not calibrated.
        residual_percent: f64,
    },
}

impl Default for SpeedLawTable {
    fn default() -> Self {
        Self::Off {}
    }
}

impl SpeedLawTable {
    /// Refuses the first value outside its range.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        let &Self::InletPressure { s, d_per_kpa, closure_angle_deg, least_rpm, most_rpm, residual_percent } =
            self
        else {
            return Ok(());
        };
        positive_up_to("[speed_law] s", s, 2.0).map_err(|wrong| wrong.hint("1: the round tube"))?;
        within("[speed_law] d_per_kpa", d_per_kpa, 0.0..=1.0)?;
        if let Some(angle_deg) = closure_angle_deg {
            positive_up_to("[speed_law] closure_angle_deg", angle_deg, 180.0)?;
        }
        positive("[speed_law] least_rpm", least_rpm)
            .map_err(|wrong| wrong.hint("the slowest speed at which the law holds"))?;
        within("[speed_law] most_rpm", most_rpm, least_rpm..=1e5)
            .map_err(|wrong| wrong.hint("from least_rpm on: the fastest speed at which the law holds"))?;
        within("[speed_law] residual_percent", residual_percent, 0.0..=100.0).map_err(|wrong| {
            wrong.hint("nothing published shows that the law is nearer than the 2.4 of a pump without")
        })
    }

    /// Returns the standard uncertainty of the law's volumes as a fraction of them, or `None` if the law is
    /// off.
    pub(super) fn standard(&self) -> Option<f64> {
        match self {
            Self::Off {} => None,
            Self::InletPressure { residual_percent, .. } => Some(residual_percent / 100.0),
        }
    }

    /// Returns the law of a pump of these dimensions, with its speeds, or `None` if the law is off.
    ///
    /// # Errors
    ///
    /// Returns the [`ModelError`] of dimensions from which no closure angle follows.
    pub(super) fn law(
        &self,
        geometry: &Geometry,
        ambient_kpa: f64,
    ) -> Result<Option<DisplacementLaw>, ModelError> {
        let &Self::InletPressure { s, d_per_kpa, least_rpm, most_rpm, .. } = self else { return Ok(None) };
        let to_fit = self.law_to_fit(geometry, ambient_kpa)?;
        let law = SpeedLaw { scale: s, distensibility_per_kpa: d_per_kpa, ..to_fit };
        Ok(Some(DisplacementLaw::new(law, [least_rpm, most_rpm])))
    }

    /// Returns a law whose s and D are to be fitted, with theta_c of a pump of these dimensions.
    ///
    /// # Errors
    ///
    /// Returns the [`ModelError`] of dimensions from which no closure angle follows.
    pub(super) fn law_to_fit(&self, geometry: &Geometry, ambient_kpa: f64) -> Result<SpeedLaw, ModelError> {
        let closure_rad = match self {
            Self::InletPressure { closure_angle_deg: Some(deg), .. } => radians(*deg),
            _ => Drawing::new(geometry)?.closure_rad(),
        };
        Ok(SpeedLaw { closure_rad, ambient_kpa, ..SpeedLaw::PUBLISHED })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pump_file::PumpFile;

    fn parsed(table: &str) -> Result<PumpFile, String> {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let text = text.replace("[speed_law]\nkind = \"none\"\n", table);
        PumpFile::parse(&text, "a file").map_err(|error| crate::report::with_sources(&error))
    }

    const TABLE: &str = "[speed_law]\nkind = \"inlet-pressure\"\ns = 0.953\nd_per_kpa = 2.05e-3\n\
                         least_rpm = 10\nmost_rpm = 170\nresidual_percent = 2.4\n";

    #[test]
    fn a_table_is_the_law_with_the_closure_of_the_dimensions() {
        let file = parsed(TABLE).unwrap();
        let to_fit = file.speed_law_to_fit().unwrap();
        assert!((to_fit.closure_rad - SpeedLaw::PUBLISHED.closure_rad).abs() < 1e-6);
        assert_eq!(to_fit.ambient_kpa, 85.7);
        let law = SpeedLaw { scale: 0.953, distensibility_per_kpa: 2.05e-3, ..to_fit };
        assert_eq!(file.displacement_law().unwrap(), Some(DisplacementLaw::new(law, [10.0, 170.0])));
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        let given = parsed(&format!("{TABLE}closure_angle_deg = 32.9\n")).unwrap();
        assert!((given.speed_law_to_fit().unwrap().closure_rad - radians(32.9)).abs() < 1e-12);
        assert_eq!(parsed("").unwrap().speed_law, SpeedLawTable::Off {}, "none is what nobody writes");
    }

    #[test]
    fn tables_that_mean_nothing_are_refused() {
        for (from, to, part) in [
            ("inlet-pressure", "outlet-pressure", "outlet-pressure"),
            ("inlet-pressure\"", "none\"", "unknown field"),
            ("s = 0.953\n", "", "missing field `s`"),
            ("s = 0.953\n", "s = 0.953\nd = 1\n", "unknown field `d`"),
            ("s = 0.953", "s = -1", "[speed_law] s is -1"),
            ("2.05e-3", "1.5", "[speed_law] d_per_kpa is 1.5"),
            ("least_rpm = 10", "least_rpm = 0", "[speed_law] least_rpm is 0"),
            ("most_rpm = 170", "most_rpm = 9", "[speed_law] most_rpm is 9"),
            ("= 2.4", "= -2.4", "[speed_law] residual_percent is -2.4"),
            // 5 mL/s need 14 r/min.
            ("least_rpm = 10", "least_rpm = 20", "default_rate_ml_s: by the pump file's speed law"),
            ("s = 0.953", "s = 0.1", "volume per revolution of the speed law"),
        ] {
            let error = parsed(&TABLE.replace(from, to)).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
