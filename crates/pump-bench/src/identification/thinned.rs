//! Long recordings, thinned to the samples that a fit needs.

use std::borrow::Cow;

use libm::{ceil, floor};
use pump_model::identification::PressureSample;

/// Most samples of a fit. It takes two seconds with these.
const MOST_SAMPLES: usize = 15_000;

/// Fewest samples in the shortest time in which the pressure swings.
const LEAST_IN_A_SWING: f64 = 20.0;

/// The samples of a fit, and their number in words.
#[derive(Debug)]
pub(super) struct Thinned<'a> {
    pub(super) samples: Cow<'a, [PressureSample]>,
    pub(super) words: String,
}

impl<'a> Thinned<'a> {
    /// Leaves samples of a long recording out: every n-th one stays, as far as a swing of `swing_s` keeps enough of
    /// them, and of more than that the first ones.
    pub(super) fn of(samples: &'a [PressureSample], swing_s: f64) -> Self {
        let all = samples.len();
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Self { samples: Cow::Borrowed(samples), words: "no samples".to_owned() };
        };
        if all <= MOST_SAMPLES {
            return Self { samples: Cow::Borrowed(samples), words: format!("{all} samples") };
        }
        let interval_s = (last.time_s - first.time_s) / (all - 1) as f64;
        let most = floor(swing_s / (LEAST_IN_A_SWING * interval_s)).max(1.0);
        let every = ceil(all as f64 / MOST_SAMPLES as f64).min(most) as usize;
        let kept: Vec<_> = samples.iter().step_by(every).take(MOST_SAMPLES).copied().collect();
        let used = (kept.len() * every).min(all);
        let of = if used < all { format!("the first {used} of {all}") } else { all.to_string() };
        let words = match every {
            1 => format!("{of} samples"),
            every => format!("1 in {every} of {of} samples"),
        };
        Self { samples: Cow::Owned(kept), words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(count: usize, interval_s: f64) -> Vec<PressureSample> {
        let sample = |n| PressureSample { time_s: n as f64 * interval_s, pressure_kpa: 88.0 };
        (0..count).map(sample).collect()
    }

    #[test]
    fn a_long_recording_keeps_enough_samples_of_each_swing() {
        let short = recording(15_000, 1e-3);
        assert_eq!(Thinned::of(&short, 0.1).words, "15000 samples");
        let fine = recording(100_000, 1e-4);
        let thinned = Thinned::of(&fine, 0.1);
        assert_eq!((thinned.samples.len(), thinned.words.as_str()), (14_286, "1 in 7 of 100000 samples"));
        // A slow recording of hours: every sample is needed, and the first ones are enough.
        let coarse = recording(100_000, 0.01);
        let thinned = Thinned::of(&coarse, 0.1);
        assert_eq!(
            (thinned.samples.len(), thinned.words.as_str()),
            (15_000, "the first 15000 of 100000 samples")
        );
        let both = recording(400_000, 1e-3);
        let thinned = Thinned::of(&both, 0.1);
        assert_eq!(thinned.words, "1 in 5 of the first 75000 of 400000 samples");
        assert_eq!(thinned.samples[1].time_s, 5e-3);
    }
}
