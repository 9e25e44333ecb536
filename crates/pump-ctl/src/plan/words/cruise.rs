//! The speed of a dose, as it is asked for.

/// The speed of a dose, as it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cruise {
    /// The mean flow at the cruise speed, mL/s, positive.
    Flow {
        /// Mean flow, mL/s.
        ml_s: f64,
    },
    /// The cruise speed of the pump head, rad/s, positive.
    Speed {
        /// Speed of the pump head, rad/s.
        rad_s: f64,
    },
    /// The total time with ramps and settling, s, positive. The slowest cruise that meets the time is
    /// planned: with line-aware ramps, one whose cruise slower by 1 % misses the time with ramps of its own. Where
    /// line-aware ramps do not meet the time, the plan has the ramps that take back least of those that do, and says
    /// so ([`crate::plan::Plan::is_hurried`]).
    Within {
        /// Total time, s.
        time_s: f64,
    },
    /// The fastest speed that holds every limit, provided that every slower speed holds them too. With
    /// line-aware ramps the speed is sought with the usual ramps.
    Fastest,
}
