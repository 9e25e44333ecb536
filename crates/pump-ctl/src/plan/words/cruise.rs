//! How fast a dose is asked to be.

/// The speed of a dose, as it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cruise {
    /// The mean flow at the cruise speed, mL/s, positive.
    Flow {
        /// mL/s.
        ml_s: f64,
    },
    /// The cruise speed of the pump head, rad/s, positive.
    Speed {
        /// rad/s.
        rad_s: f64,
    },
    /// The total time with ramps and settling, s, positive. The slowest cruise that meets the time is planned.
    Within {
        /// s.
        time_s: f64,
    },
    /// The fastest speed that holds every limit, provided that every slower speed holds them too.
    Fastest,
}
