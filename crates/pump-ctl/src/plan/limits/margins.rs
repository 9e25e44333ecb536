//! The margins of a dose to its limits.

use super::bound::Bound;
use super::margin::Margin;
use crate::plan::words::LimitedBy;
use crate::step::Direction;

/// The margins of a dose to each limit that is given, start-up, stop and settling included.
///
/// [`crate::plan::Limits::margins`] computes them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
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
    /// Returns the limit of which most is used in a motion in this direction, and its margin, or `None` if no
    /// limit is given.
    pub fn nearest(&self, direction: Direction) -> Option<(LimitedBy, Margin)> {
        self.nearest_bound().map(|(bound, margin)| (bound.limited_by(direction), margin))
    }

    /// Returns the limit of which most is used by its port's role, and its margin.
    fn nearest_bound(&self) -> Option<(Bound, Margin)> {
        let all = [
            (Bound::DischargePressure, self.outlet),
            (Bound::Suction, self.inlet),
            (Bound::DischargeSuction, self.outlet_suction),
            (Bound::Torque, self.torque),
        ];
        let given = all.into_iter().filter_map(|(limit, margin)| Some((limit, margin?)));
        given.max_by(|a, b| a.1.used.total_cmp(&b.1.used))
    }

    /// Returns the limit that is broken most, or `None` if every limit holds.
    pub(in crate::plan) fn broken(&self) -> Option<(Bound, Margin)> {
        self.nearest_bound().filter(|(_, margin)| margin.used > 1.0)
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
