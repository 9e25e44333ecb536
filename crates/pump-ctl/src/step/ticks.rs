//! Times in ticks of the caller's timer, with a fraction.

/// A time in whole ticks and a fraction in 2^-32 tick. Sums keep the fraction, so a million intervals are as
/// exact as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ticks {
    /// Whole ticks.
    pub whole: u64,
    /// Fraction of a tick, 2^-32 tick.
    pub frac: u32,
}

impl Ticks {
    pub(in crate::step) const ZERO: Self = Self { whole: 0, frac: 0 };

    /// Returns the middle of tick `whole`. A sum that starts there and is cut to whole ticks is rounded.
    pub(in crate::step) fn middle_of(whole: u64) -> Self {
        Self { whole, frac: 1 << 31 }
    }

    #[inline]
    pub(in crate::step) fn plus(self, other: Self) -> Self {
        let (frac, carry) = self.frac.overflowing_add(other.frac);
        Self { whole: self.whole.wrapping_add(other.whole).wrapping_add(u64::from(carry)), frac }
    }

    /// Adds `change`, in 2^-32 tick.
    #[inline]
    pub(in crate::step) fn plus_fixed(self, change: i64) -> Self {
        let (frac, carry) = self.frac.overflowing_add(change as u32);
        Self { whole: self.whole.wrapping_add_signed(change >> 32).wrapping_add(u64::from(carry)), frac }
    }

    /// Returns the time in 2^-32 tick.
    pub(in crate::step) fn fixed(self) -> i128 {
        (i128::from(self.whole) << 32) | i128::from(self.frac)
    }

    /// Makes a time from a number of 2^-32 ticks, which is not negative.
    pub(in crate::step) fn of_fixed(fixed: i128) -> Self {
        Self { whole: (fixed >> 32) as u64, frac: fixed as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_carry_either_way() {
        let almost_two = Ticks { whole: 1, frac: u32::MAX };
        assert_eq!(almost_two.plus_fixed(1), Ticks { whole: 2, frac: 0 });
        assert_eq!(almost_two.plus_fixed(-(1 << 32)), Ticks { whole: 0, frac: u32::MAX });
        assert_eq!(Ticks { whole: 5, frac: 0 }.plus_fixed(-1), Ticks { whole: 4, frac: u32::MAX });
        assert_eq!(almost_two.plus(almost_two), Ticks { whole: 3, frac: u32::MAX - 1 });
        assert_eq!(Ticks::of_fixed(almost_two.fixed()), almost_two);
    }
}
