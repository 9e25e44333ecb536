//! The direction in which the rotor turns.

/// The direction in which the rotor turns.
///
/// ```
/// use pump_ctl::step::Direction;
///
/// assert_eq!(Direction::of(-40), Direction::Reverse);
/// assert_eq!(Direction::Reverse.sign(), -1);
/// assert_eq!(Direction::Reverse.reversed(), Direction::Forward);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(i8)]
pub enum Direction {
    /// The rotor turns from inlet to outlet, and its angle grows.
    Forward = 1,
    /// The rotor turns from outlet to inlet, and its angle falls.
    Reverse = -1,
}

impl Direction {
    /// Returns the direction of a number of signed steps. Zero steps go forward.
    #[inline]
    pub const fn of(steps: i64) -> Self {
        if steps < 0 { Self::Reverse } else { Self::Forward }
    }

    /// Returns 1 for forward and -1 for reverse.
    #[inline]
    pub const fn sign(self) -> i8 {
        self as i8
    }

    /// Returns the opposite direction.
    #[inline]
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Forward => Self::Reverse,
            Self::Reverse => Self::Forward,
        }
    }
}
