//! The scale of an axis: its coordinates and its steps.

use crate::pump_file::Axis;

/// Relative rounding of single precision (IEEE 754 binary32: 24 bits).
const SINGLE: f64 = 1.0 / 16_777_216.0;

/// Number of roundings between a count and its report: the division by the steps per unit and two products
/// with powers of ten.
const ROUNDINGS: f64 = 3.0;

/// Largest count whose halves are exact in single precision, in which firmwares compute targets.
const MOST_COUNT: f64 = 4_194_304.0;

/// Largest distance of the board's target from a whole step before it rounds, in steps.
const TARGET: f64 = 0.3;

/// Largest error of a reported position, in steps.
const REPORT: f64 = 0.4;

/// Length of an inch, in mm.
const INCH_MM: f64 = 25.4;

/// Scale of an axis between its coordinates and its steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Axis of the board.
    pub(super) axis: Axis,
    /// Steps per unit, which is a millimetre to the board.
    pub(super) steps_per_unit: f64,
    /// True if the axis counts up in reverse.
    pub(super) inverted: bool,
    /// True if reports are in inches, with four decimals instead of three.
    pub(super) inches: bool,
    /// True if the position is the sum of two rounded numbers, WPos and WCO.
    pub(super) summed: bool,
}

impl Scale {
    fn sign(&self) -> f64 {
        if self.inverted { -1.0 } else { 1.0 }
    }

    /// Returns the coordinate of a reported number, in mm.
    pub(super) fn reported_mm(&self, number: f64) -> f64 {
        if self.inches { number * INCH_MM } else { number }
    }

    /// Returns the count at the coordinate `mm`, in steps toward the outlet.
    pub(super) fn count(&self, mm: f64) -> i64 {
        (self.sign() * mm * self.steps_per_unit).round() as i64
    }

    /// Returns the largest error of a reported position near zero, in steps.
    pub(super) fn report_error(&self) -> f64 {
        let half_mm = if self.inches { 0.000_05 * INCH_MM } else { 0.000_5 };
        half_mm * self.steps_per_unit * if self.summed { 2.0 } else { 1.0 }
    }

    /// Returns true if a report tells single steps apart.
    pub(super) fn tells_steps(&self) -> bool {
        self.report_error() <= REPORT
    }

    /// Returns the most steps per unit at which reports in millimetres tell steps apart.
    pub(super) fn most_steps_per_unit() -> f64 {
        REPORT / 0.000_5
    }

    /// Returns the farthest count, either way, that the board computes and reports exactly.
    pub(super) fn most_count(&self) -> i64 {
        let reported = (0.5 - self.report_error()) / (ROUNDINGS * SINGLE);
        reported.min(MOST_COUNT) as i64
    }

    /// Formats the coordinate of a count with at most eight digits, so that the board rounds it to exactly
    /// this step. Returns `None` if no such number exists.
    pub(super) fn text(&self, count: i64) -> Option<String> {
        let wanted = self.sign() * count as f64;
        let mm = wanted / self.steps_per_unit;
        let off = |text: &String| (self.board_steps(text) - wanted).abs();
        let texts = (0..=6).map(|decimals| format!("{mm:.decimals$}"));
        let best = texts.filter(|text| digits(text) <= 8).min_by(|one, two| off(one).total_cmp(&off(two)))?;
        (off(&best) <= TARGET).then_some(best)
    }

    /// Returns the place where the board's arithmetic puts a coordinate, in steps before rounding.
    ///
    /// The board's reader multiplies the digits by powers of ten, and the steps per unit multiply the result,
    /// all in single precision.
    fn board_steps(&self, text: &str) -> f64 {
        let whole: u32 = text.chars().filter_map(|c| c.to_digit(10)).fold(0, |sum, digit| sum * 10 + digit);
        let mut decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let mut value = whole as f32;
        while decimals >= 2 {
            value *= 0.01;
            decimals -= 2;
        }
        if decimals == 1 {
            value *= 0.1;
        }
        let value = if text.starts_with('-') { -value } else { value };
        f64::from(value * self.steps_per_unit as f32)
    }
}

fn digits(text: &str) -> usize {
    text.chars().filter(char::is_ascii_digit).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scale(steps_per_unit: f64) -> Scale {
        Scale { axis: Axis::X, steps_per_unit, inverted: false, inches: false, summed: false }
    }

    proptest! {
        #[test]
        fn every_step_that_may_be_reached_has_a_text(
            thousandths in 1_000_u32..=800_000,
            part in -1.0..1.0_f64,
            inverted: bool,
        ) {
            let scale = Scale { inverted, ..scale(f64::from(thousandths) / 1e3) };
            let count = (part * scale.most_count() as f64) as i64;
            let text = scale.text(count).expect("a text");
            prop_assert_eq!(scale.board_steps(&text).round() * scale.sign(), count as f64);
        }

        #[test]
        fn every_report_within_reach_is_read_as_its_step(
            thousandths in 1_000_u32..=800_000,
            part in -1.0..1.0_f64,
        ) {
            let scale = scale(f64::from(thousandths) / 1e3);
            let count = (part * scale.most_count() as f64) as i64;
            let single = count as f32 / scale.steps_per_unit as f32;
            let thousand = (single.abs() * 100.0) * 10.0 + 0.5;
            let reported = f64::from(single.signum()) * f64::from(thousand as u32) / 1e3;
            prop_assert_eq!(scale.count(reported), count);
        }
    }

    #[test]
    fn the_most_steps_per_unit_that_are_documented_can_be_used() {
        let most = scale(Scale::most_steps_per_unit());
        assert_eq!(most.steps_per_unit, 800.0);
        assert!(most.tells_steps() && !scale(801.0).tells_steps());
    }

    #[test]
    fn inches_and_sums_are_coarser() {
        let fine = scale(250.0);
        assert!((fine.report_error() - 0.125).abs() < 1e-12 && fine.tells_steps());
        assert!(!Scale { inches: true, summed: true, ..fine }.tells_steps());
        assert!(Scale { summed: true, ..fine }.most_count() < fine.most_count());
    }
}
