//! Motor current in steps of the chip's scale (datasheet, chapter 9).

use crate::pump_file::tmc_range::{self, is_sensitive};

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
    /// Returns the scale of currents in A (RMS), none of which it exceeds. The currents are those that the pump
    /// file may have.
    pub(super) fn of(run_a: f64, hold_a: f64, sense_ohm: f64) -> Self {
        let is_sensitive = is_sensitive(run_a, sense_ohm);
        let scale = |wanted_a: f64| tmc_range::scale(wanted_a, is_sensitive, sense_ohm);
        Self { is_sensitive, run: scale(run_a), hold: scale(hold_a) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pump_file::tmc_range::{current_a, range_a};

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
