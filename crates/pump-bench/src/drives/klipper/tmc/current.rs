//! Motor current and its scale (datasheet, chapter 9): I_rms = (CS + 1)/32 V_FS/(R_sense + 0.02 Ohm)/sqrt 2.

use std::f64::consts::SQRT_2;

/// Voltage at the sense resistor for the full scale, in V, by `vsense` (datasheet, chapter 20, V_SRTL and V_SRTH).
const FULL_SCALE_V: [f64; 2] = [0.325, 0.180];

/// Resistance between the chip and the sense resistor, in Ohm (chapter 9).
const INNER_OHM: f64 = 0.02;

/// Largest scale.
const SCALE_MOST: u8 = 31;

/// Largest current of the chip, in A (RMS) (datasheet, features: 2.0 A).
const CHIP_MOST_A: f64 = 2.0;

/// Part of a step of the scale by which a current may miss it: currents are written with few digits.
const SLACK: f64 = 1e-6;

/// Currents of a motor as the chip's scale has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scale {
    /// True for the sensitive measurement, whose steps are finer.
    pub(super) is_sensitive: bool,
    /// Scale in motion, 0 to 31.
    pub(super) run: u8,
    /// Scale at rest, 0 to 31.
    pub(super) hold: u8,
}

impl Scale {
    /// Returns the scale of currents in A (RMS), none of which it exceeds. The currents are within [`range_a`], and the
    /// current at rest is not above that in motion.
    pub(super) fn of(run_a: f64, hold_a: f64, sense_ohm: f64) -> Self {
        let is_sensitive = run_a <= current_a(SCALE_MOST, true, sense_ohm) * (1.0 + SLACK);
        let scale = |current_a: f64| {
            let steps = current_a / self::current_a(0, is_sensitive, sense_ohm) + SLACK;
            // Less than a step of the scale is its smallest.
            (steps.floor() - 1.0).clamp(0.0, f64::from(SCALE_MOST)) as u8
        };
        Self { is_sensitive, run: scale(run_a), hold: scale(hold_a) }
    }
}

/// Returns the current of a scale in A (RMS).
pub(super) fn current_a(scale: u8, is_sensitive: bool, sense_ohm: f64) -> f64 {
    let full_scale_v = FULL_SCALE_V[usize::from(is_sensitive)];
    (f64::from(scale) + 1.0) / 32.0 * full_scale_v / (sense_ohm + INNER_OHM) / SQRT_2
}

/// Returns the smallest and the largest current of a motor in A (RMS).
pub(super) fn range_a(sense_ohm: f64) -> (f64, f64) {
    let most = current_a(SCALE_MOST, false, sense_ohm);
    (current_a(0, true, sense_ohm), most.min(CHIP_MOST_A))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The datasheet's table of chapter 8: largest RMS current in A by the sense resistor in Ohm, with IRUN = 31 and
    /// vsense = 0.
    #[test]
    fn largest_currents_are_those_of_the_datasheet() {
        for (sense_ohm, most_a) in [
            (1.0, 0.23),
            (0.82, 0.27),
            (0.75, 0.30),
            (0.68, 0.33),
            (0.50, 0.44),
            (0.47, 0.47),
            (0.39, 0.56),
            (0.33, 0.66),
            (0.27, 0.79),
            (0.22, 0.96),
            (0.18, 1.15),
            (0.15, 1.35),
            (0.12, 1.64),
            (0.10, 1.92),
        ] {
            assert!((current_a(31, false, sense_ohm) - most_a).abs() < 0.0051, "{sense_ohm} Ohm");
        }
        // 2.4 A there, and above the chip's rating.
        assert_eq!(range_a(0.075).1, 2.0);
    }

    #[test]
    fn a_current_is_the_nearest_below_what_was_asked_for() {
        for sense_ohm in [0.075, 0.11, 0.15, 0.33, 1.0] {
            let (least, most) = range_a(sense_ohm);
            for run_a in (0..=1000).map(|n| least + (most - least) * f64::from(n) / 1000.0) {
                let Scale { is_sensitive, run, hold } = Scale::of(run_a, least, sense_ohm);
                let made = current_a(run, is_sensitive, sense_ohm);
                assert!(made <= run_a * (1.0 + 1e-5), "{run_a} A: {made} A");
                let is_last = run == 31;
                assert!(is_last || current_a(run + 1, is_sensitive, sense_ohm) > run_a, "{run_a} A");
                assert_eq!(hold, 0);
            }
            assert_eq!(Scale::of(most, most, sense_ohm).run, Scale::of(most, most, sense_ohm).hold);
        }
    }

    #[test]
    fn small_currents_take_the_finer_scale() {
        // 0.11 Ohm: 0.180 V/0.13 Ohm/sqrt 2 = 0.979 A is the most of the sensitive scale.
        let small = Scale::of(0.979, 0.5, 0.11);
        assert_eq!((small.is_sensitive, small.run, small.hold), (true, 30, 15));
        let large = Scale::of(0.98, 0.5, 0.11);
        assert_eq!((large.is_sensitive, large.run, large.hold), (false, 16, 8));
    }
}
