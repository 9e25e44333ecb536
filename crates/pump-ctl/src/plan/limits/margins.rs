//! The margins of a dose to its limits.

use super::margin::Margin;
use crate::plan::words::LimitedBy;

/// The margins of a dose to each limit that is given, start-up, stop and settling included.
///
/// [`crate::plan::Limits::margins`] computes them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margins {
    /// Margin of the largest pressure at the discharge port.
    pub outlet: Option<Margin>,
    /// Margin of the smallest pressure at the suction port.
    pub inlet: Option<Margin>,
    /// Margin of the smallest pressure at the discharge port.
    pub outlet_suction: Option<Margin>,
    /// Margin of the motor's torque while the rotor turns.
    pub torque: Option<Margin>,
}

impl Margins {
    /// Returns the limit of which most is used, and its margin, or `None` if no limit is given.
    pub fn nearest(&self) -> Option<(LimitedBy, Margin)> {
        let all = [
            (LimitedBy::OutletPressure, self.outlet),
            (LimitedBy::InletPressure, self.inlet),
            (LimitedBy::OutletSuction, self.outlet_suction),
            (LimitedBy::Torque, self.torque),
        ];
        let given = all.into_iter().filter_map(|(limit, margin)| Some((limit, margin?)));
        given.max_by(|a, b| a.1.used.total_cmp(&b.1.used))
    }

    /// Returns the limit that is broken most, or `None` if every limit holds.
    pub(in crate::plan) fn broken(&self) -> Option<(LimitedBy, Margin)> {
        self.nearest().filter(|(_, margin)| margin.used > 1.0)
    }

    /// Returns the worse margin of each limit.
    pub(super) fn and(self, other: Self) -> Self {
        let worse = |a: Option<Margin>, b: Option<Margin>| {
            a.into_iter().chain(b).max_by(|a, b| a.used.total_cmp(&b.used))
        };
        Self {
            outlet: worse(self.outlet, other.outlet),
            inlet: worse(self.inlet, other.inlet),
            outlet_suction: worse(self.outlet_suction, other.outlet_suction),
            torque: worse(self.torque, other.torque),
        }
    }
}
