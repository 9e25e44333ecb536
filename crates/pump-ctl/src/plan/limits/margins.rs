//! How near a dose comes to each of its limits.

use super::margin::Margin;
use crate::plan::words::LimitedBy;

/// How near a dose comes to each limit that is given, start-up, stop and settling included.
///
/// [`crate::plan::Limits::margins`] makes it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margins {
    /// Pressure at the port that pushes.
    pub outlet: Option<Margin>,
    /// Pressure at the port that sucks.
    pub inlet: Option<Margin>,
    /// Smallest pressure at the port that pushes.
    pub outlet_suction: Option<Margin>,
    /// Torque of the motor while the rotor turns.
    pub torque: Option<Margin>,
}

impl Margins {
    /// The limit of which most is used, and its margin; none if no limit is given.
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

    /// The limit that is broken most, if any is.
    pub(in crate::plan) fn broken(&self) -> Option<(LimitedBy, Margin)> {
        self.nearest().filter(|(_, margin)| margin.used > 1.0)
    }

    /// The worse margin of each limit.
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
