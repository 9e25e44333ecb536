//! Ranges of parameters: one type checks a value and words the range.

use core::fmt;
use core::ops::{Range, RangeInclusive};

/// Values that a parameter may take. The text of this type stands after `allowed:` in a message.
///
/// ```
/// use pump_model::Allowed;
/// assert_eq!(Allowed::from(1e-6..=1e6).to_string(), "1e-6 to 1e6");
/// assert_eq!(Allowed::from(0.0..90.0).to_string(), "0 to less than 90");
/// assert!(Allowed::POSITIVE.admits(0.1) && !Allowed::POSITIVE.admits(f64::INFINITY));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Allowed {
    /// Every finite number.
    Finite,
    /// Every finite number above zero.
    Positive,
    /// Numbers from `least` to `most`, both of them included.
    Between {
        /// Smallest allowed number.
        least: f64,
        /// Largest allowed number.
        most: f64,
    },
    /// Numbers from `least` to less than `below`; `least` itself is allowed.
    Below {
        /// Smallest allowed number.
        least: f64,
        /// Bound that every allowed number stays below.
        below: f64,
    },
    /// Numbers no farther from zero than `most`.
    EitherWay {
        /// Largest allowed magnitude.
        most: f64,
    },
    /// Numbers no farther from zero than `most`, except zero itself.
    EitherWayNotZero {
        /// Largest allowed magnitude.
        most: f64,
    },
    /// Zero and every finite number above it.
    NotNegative,
    /// Condition in words, for a range that depends on other parameters. The caller checks it.
    Words(&'static str),
}

impl Allowed {
    /// Every finite number.
    pub const FINITE: Self = Self::Finite;
    /// Every finite number above zero.
    pub const POSITIVE: Self = Self::Positive;

    /// True if a value is allowed. [`Self::Words`] admits no value: the caller has already found it wrong.
    pub fn admits(self, value: f64) -> bool {
        match self {
            Self::Finite => value.is_finite(),
            Self::Positive => value.is_finite() && value > 0.0,
            Self::Between { least, most } => (least..=most).contains(&value),
            Self::Below { least, below } => (least..below).contains(&value),
            Self::EitherWay { most } => value.abs() <= most,
            Self::EitherWayNotZero { most } => value != 0.0 && value.abs() <= most,
            Self::NotNegative => value.is_finite() && value >= 0.0,
            Self::Words(_) => false,
        }
    }
}

impl From<RangeInclusive<f64>> for Allowed {
    fn from(range: RangeInclusive<f64>) -> Self {
        Self::Between { least: *range.start(), most: *range.end() }
    }
}

impl From<Range<f64>> for Allowed {
    fn from(range: Range<f64>) -> Self {
        Self::Below { least: range.start, below: range.end }
    }
}

impl From<&'static str> for Allowed {
    fn from(words: &'static str) -> Self {
        Self::Words(words)
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Finite => f.write_str("a finite number"),
            Self::Positive => f.write_str("a positive number"),
            Self::Between { least, most } => write!(f, "{} to {}", Short(least), Short(most)),
            Self::Below { least, below } => write!(f, "{} to less than {}", Short(least), Short(below)),
            Self::EitherWay { most } => write!(f, "up to {} either way", Short(most)),
            Self::EitherWayNotZero { most } => write!(f, "up to {} either way, not zero", Short(most)),
            Self::NotNegative => f.write_str("zero or a positive number"),
            Self::Words(words) => f.write_str(words),
        }
    }
}

/// Number written as short as it can be: 1e-6, 0.001, 360, 1e6.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    #[test]
    fn a_range_words_its_own_message() {
        for (allowed, words) in [
            (Allowed::from(0.0..=1e6), "0 to 1e6"),
            (Allowed::from(1e-3..=1e6), "0.001 to 1e6"),
            (Allowed::from(1e-9..=1e3), "1e-9 to 1000"),
            (Allowed::from(0.0..360.0), "0 to less than 360"),
            (Allowed::from("more than the bore radius"), "more than the bore radius"),
        ] {
            assert_eq!(allowed.to_string(), words);
        }
    }

    #[test]
    fn bounds_belong_to_a_range_unless_they_are_said_not_to() {
        let [closed, half_open] = [Allowed::from(0.0..=1.0), Allowed::from(0.0..1.0)];
        assert!(closed.admits(0.0) && closed.admits(1.0) && !closed.admits(-f64::MIN_POSITIVE));
        assert!(half_open.admits(0.0) && !half_open.admits(1.0));
        for allowed in [closed, half_open, Allowed::FINITE, Allowed::POSITIVE, Allowed::from("no number")] {
            assert!(!allowed.admits(f64::NAN) && !allowed.admits(f64::INFINITY), "{allowed}");
        }
        assert!(Allowed::FINITE.admits(0.0) && !Allowed::POSITIVE.admits(0.0));
    }
}
