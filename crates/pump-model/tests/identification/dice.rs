//! Noise that is equal in every run.

/// Generator SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
pub(crate) struct Dice(pub u64);

impl Dice {
    /// Returns a number in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number of mean 0 and standard deviation 1 (Box and Muller, Ann. Math. Statist. 29, 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let (radius, turn) = ((-2.0 * (1.0 - self.uniform()).ln()).sqrt(), self.uniform());
        radius * (core::f64::consts::TAU * turn).cos()
    }

    /// Returns a number between `low` and `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// Count of the truths that lay within twice the standard uncertainty.
#[derive(Default)]
pub(crate) struct Coverage {
    inside: u32,
    of: u32,
}

impl Coverage {
    pub(crate) fn take(&mut self, found: pump_model::identification::Estimate, truth: f64) {
        self.inside += u32::from((found.value - truth).abs() < 2.0 * found.standard);
        self.of += 1;
    }

    /// Asserts the count: 95.45 % of 200 are 191, within three deviations of a binomial count, 2.95 each,
    /// nearly always.
    pub(crate) fn is_as_stated(&self) {
        assert_eq!(self.of, 200);

        assert!((182..=200).contains(&self.inside), "{} of {}", self.inside, self.of);
    }
}
