//! `[speed_law]`: whether and how the volume of a revolution depends on the speed.

use pump_model::math::radians;
use pump_model::{Drawing, ModelError, Pump, SpeedLaw};
use serde::{Deserialize, Serialize};

use super::PumpFile;
use crate::displacement::{RangedLaw, SpeedLawError};

/// `[speed_law]`
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SpeedLawTable {
    /// The volume of a revolution is the same at every speed.
    #[serde(rename = "none")]
    Off {},
    /// A segment holds more or less by the inlet pressure at which it is trapped; experimental, see [`SpeedLaw`].
    InletPressure {
        /// s: volume between two rollers over that of the round tube.
        s: f64,
        /// D, 1/kPa: how much more a segment holds for more pressure.
        d_per_kpa: f64,
        /// theta_c, deg: where an engaging roller closes the lumen; none takes that of the dimensions.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        closure_angle_deg: Option<f64>,
        /// Slowest speed at which it holds, r/min.
        least_rpm: f64,
        /// Fastest, r/min.
        most_rpm: f64,
        /// Standard uncertainty of the volumes that it gives, percent; of a pump that is not calibrated it takes the place of
        /// `model_percent`.
        residual_percent: f64,
    },
}

impl Default for SpeedLawTable {
    fn default() -> Self {
        Self::Off {}
    }
}

impl SpeedLawTable {
    /// Key, value and what is allowed of the first that is wrong.
    pub(super) fn wrong(&self) -> Option<(&'static str, f64, &'static str)> {
        let &Self::InletPressure { s, d_per_kpa, closure_angle_deg, least_rpm, most_rpm, residual_percent } =
            self
        else {
            return None;
        };
        let checks = [
            (s > 0.0 && s <= 2.0, "[speed_law] s", s, "more than 0, 2 at most (1: the round tube)"),
            ((0.0..=1.0).contains(&d_per_kpa), "[speed_law] d_per_kpa", d_per_kpa, "0 to 1"),
            (
                closure_angle_deg.is_none_or(|deg| deg > 0.0 && deg <= 180.0),
                "[speed_law] closure_angle_deg",
                closure_angle_deg.unwrap_or_default(),
                "more than 0, 180 at most",
            ),
            (
                least_rpm > 0.0 && least_rpm.is_finite(),
                "[speed_law] least_rpm",
                least_rpm,
                "more than 0: the slowest speed at which the law holds",
            ),
            (
                most_rpm >= least_rpm && most_rpm <= 1e5,
                "[speed_law] most_rpm",
                most_rpm,
                "least_rpm to 100000: the fastest speed at which the law holds",
            ),
            (
                (0.0..=100.0).contains(&residual_percent),
                "[speed_law] residual_percent",
                residual_percent,
                "0 to 100 (nothing published shows that the law is nearer than the 2.4 of a pump without)",
            ),
        ];
        checks.into_iter().find_map(|(ok, key, value, allowed)| (!ok).then_some((key, value, allowed)))
    }

    /// Standard uncertainty of the volumes that it gives, part of them; none if it is off.
    pub fn standard(&self) -> Option<f64> {
        match self {
            Self::Off {} => None,
            Self::InletPressure { residual_percent, .. } => Some(residual_percent / 100.0),
        }
    }
}

impl PumpFile {
    /// The law of `[speed_law]`; none if it is off.
    pub fn speed_law(&self) -> Result<Option<RangedLaw>, ModelError> {
        let SpeedLawTable::InletPressure { s, d_per_kpa, least_rpm, most_rpm, .. } = self.speed_law else {
            return Ok(None);
        };
        let law = SpeedLaw { scale: s, distensibility_per_kpa: d_per_kpa, ..self.speed_law_to_fit()? };
        Ok(Some(RangedLaw { law, least_rpm, most_rpm }))
    }

    /// A law of this pump whose s and D are to be fitted: theta_c and P_atm are the pump's.
    pub fn speed_law_to_fit(&self) -> Result<SpeedLaw, ModelError> {
        let closure_rad = match self.speed_law {
            SpeedLawTable::InletPressure { closure_angle_deg: Some(deg), .. } => radians(deg),
            _ => Drawing::new(&self.geometry())?.closure_rad(),
        };
        Ok(SpeedLaw { closure_rad, ambient_kpa: self.ambient.pressure_kpa, ..SpeedLaw::PUBLISHED })
    }

    /// `pump`, the model of this file, as it is at a constant speed in rad/s: by the speed law if it is on.
    pub fn pump_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<Pump, SpeedLawError> {
        self.speed_law()?.map_or(Ok(*pump), |law| law.pump_at(pump, speed_rad_s))
    }

    /// Speed, rad/s, whose mean flow over whole pitches is `flow_ml_s`: by the speed law if it is on.
    pub fn speed_for_flow(&self, pump: &Pump, flow_ml_s: f64) -> Result<f64, SpeedLawError> {
        let usual = || Ok(pump_ctl::plan::speed_for_flow(pump, flow_ml_s));
        self.speed_law()?.map_or_else(usual, |law| law.speed_for_flow(pump, flow_ml_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(table: &str) -> Result<PumpFile, String> {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let text = text.replace("[speed_law]\nkind = \"none\"\n", table);
        PumpFile::parse(&text, "a file").map_err(|error| error.to_string())
    }

    const TABLE: &str = "[speed_law]\nkind = \"inlet-pressure\"\ns = 0.953\nd_per_kpa = 2.05e-3\nleast_rpm = 10\n\
                         most_rpm = 170\nresidual_percent = 2.4\n";

    #[test]
    fn a_table_is_the_law_with_the_closure_of_the_dimensions() {
        let file = parsed(TABLE).unwrap();
        let law = file.speed_law().unwrap().unwrap();
        assert!((law.law.closure_rad - SpeedLaw::PUBLISHED.closure_rad).abs() < 1e-6);
        assert_eq!((law.law.ambient_kpa, law.least_rpm, law.most_rpm), (85.7, 10.0, 170.0));
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        let given = parsed(&format!("{TABLE}closure_angle_deg = 32.9\n")).unwrap();
        assert!((given.speed_law().unwrap().unwrap().law.closure_rad - radians(32.9)).abs() < 1e-12);
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
