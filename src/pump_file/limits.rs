//! `[limits]`, and all that a pump file knows of what a dose must not exceed.

use pump_ctl::plan::{InletBound, Limits};
use serde::{Deserialize, Serialize};

use super::PumpFile;

/// `[limits]`
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitsTable {
    /// Largest pressure at the port that pushes, kPa absolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the port that sucks, kPa absolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_inlet_kpa: Option<f64>,
}

impl LimitsTable {
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl PumpFile {
    /// Limits of motor, pressures and torque.
    pub fn limits(&self) -> Limits {
        self.limits_with(None, None)
    }

    /// The same with pressures, kPa absolute, in place of those in `[limits]`. At the port that sucks the largest of three
    /// binds: that pressure, the one at which the tube collapses, and the fluid's vapour pressure.
    pub fn limits_with(&self, max_outlet_kpa: Option<f64>, min_inlet_kpa: Option<f64>) -> Limits {
        let bounds = [
            (self.fluid.vapour_kpa(), InletBound::Vapour),
            (self.collapse_kpa(), InletBound::TubeCollapse),
            (min_inlet_kpa.or(self.limits.min_inlet_kpa), InletBound::Given),
        ];
        let known = bounds.into_iter().filter_map(|(kpa, bound)| Some((kpa?, bound)));
        let largest = known.max_by(|a, b| a.0.total_cmp(&b.0));
        Limits {
            motor: self.motor.at_pump_head(),
            max_outlet_kpa: max_outlet_kpa.or(self.limits.max_outlet_kpa),
            min_inlet_kpa: largest.map(|(kpa, _)| kpa),
            inlet_bound: largest.map_or(InletBound::Given, |(_, bound)| bound),
            torque: self.motor.torque(self.ambient.pressure_kpa),
        }
    }

    /// Limits that nobody checks, since no value is known: of a dose within `limits` with this pressure asked for at the
    /// port that sucks. Whoever gives that pressure answers for tube and fluid.
    pub fn not_checked(&self, limits: &Limits, min_inlet_kpa: Option<f64>) -> Vec<&'static str> {
        let given = min_inlet_kpa.or(self.limits.min_inlet_kpa).is_some();
        let no_collapse = !given && self.tube.collapse_below_ambient_kpa().is_none();
        let no_vapour = !given && self.fluid.vapour_kpa().is_none();
        let all = [
            ("outlet_pressure", limits.max_outlet_kpa.is_none()),
            ("inlet_pressure", no_collapse && no_vapour),
            ("tube_collapse", no_collapse && !no_vapour),
            ("vapour_pressure", no_vapour && !no_collapse),
            ("torque", limits.torque.is_none()),
        ];
        all.into_iter().filter_map(|(name, missing)| missing.then_some(name)).collect()
    }

    /// Pressure at which the tube collapses, kPa absolute; none if it is not known or the tube withstands a vacuum.
    fn collapse_kpa(&self) -> Option<f64> {
        let kpa = self.ambient.pressure_kpa - self.tube.collapse_below_ambient_kpa()?;
        Some(kpa).filter(|kpa| *kpa > 0.0)
    }
}
