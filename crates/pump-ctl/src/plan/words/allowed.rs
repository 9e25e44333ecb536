//! The values that a parameter may have.

use core::fmt;

/// The values that a parameter may have. The check of the parameter and its message both use them.
///
/// ```
/// use pump_ctl::plan::Allowed;
///
/// let steps = Allowed::Between { least: 4.0, most: 1e9 };
/// assert!(steps.contains(12_800.0) && !steps.contains(3.0) && !steps.contains(f64::NAN));
/// assert_eq!(steps.to_string(), "4 to 1e9");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Allowed {
    /// Any number from `least` to `most`, both included.
    Between {
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// Any number no farther from zero than `most`.
    EitherWay {
        /// Largest magnitude.
        most: f64,
    },
    /// Any number no farther from zero than `most`, except zero itself.
    EitherWayNotZero {
        /// Largest magnitude.
        most: f64,
    },
    /// Any finite number above zero.
    Positive,
    /// Zero or any finite number above it.
    NotNegative,
    /// Values that words describe, since they depend on more than a range. The caller checks such values.
    Words(&'static str),
}

impl Allowed {
    /// Returns true if a value lies in the range. NaN lies in no range, and no value lies in [`Self::Words`].
    pub fn contains(&self, value: f64) -> bool {
        match *self {
            Self::Between { least, most } => (least..=most).contains(&value),
            Self::EitherWay { most } => value.abs() <= most,
            Self::EitherWayNotZero { most } => value != 0.0 && value.abs() <= most,
            Self::Positive => value.is_finite() && value > 0.0,
            Self::NotNegative => value.is_finite() && value >= 0.0,
            Self::Words(_) => false,
        }
    }
}

/// A bound as people write it: digits up to a million, a power of ten beyond.
struct Bound(f64);

impl fmt::Display for Bound {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(bound) = *self;
        if bound == 0.0 || (1e-3..1e6).contains(&bound.abs()) {
            write!(to, "{bound}")
        } else {
            write!(to, "{bound:e}")
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Between { least, most } => write!(to, "{} to {}", Bound(least), Bound(most)),
            Self::EitherWay { most } => write!(to, "up to {} either way", Bound(most)),
            Self::EitherWayNotZero { most } => write!(to, "up to {} either way, not zero", Bound(most)),
            Self::Positive => to.write_str("a positive number"),
            Self::NotNegative => to.write_str("zero or a positive number"),
            Self::Words(words) => to.write_str(words),
        }
    }
}
