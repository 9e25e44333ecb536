//! One revolution that a person has watched, and the motor's steps that follow from it.

use libm::{fabs, floor};

use super::answers::Answers;
use super::pump::USUAL_FULL_STEPS;
use crate::catalogue::{DECIMAL, POWERS};
use crate::units::{QuantityError, angle_rad};

/// Part of a turn that a person sees without an instrument: some ten degrees.
const SEEN: f64 = 0.03;

/// Largest part by which usual microsteps may depart from a turn that was read by eye.
const NEAR: f64 = 0.12;

/// Largest part by which decimal microsteps may depart from a turn. They lie close to one another and to gears.
const NEAR_DECIMAL: f64 = 0.02;

/// Steps of the motor that follow from a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CorrectedSteps {
    /// Steps per revolution of the motor.
    pub steps_per_rev: u32,
    /// Microsteps per full step, if the steps are those of a usual motor driver.
    pub microsteps: Option<u32>,
}

/// Reads how far the head turned, in turns: `1`, `1/4`, `0.25 turns`, `90deg`, `4rev`.
///
/// ```
/// use pump_bench::setup::turns;
///
/// for (text, turned) in [("1/4 turn", 0.25), ("90deg", 0.25), ("4", 4.0), ("1 1/2", 1.5), ("2rev", 2.0)] {
///     assert!((turns(text).unwrap() - turned).abs() < 1e-12, "{text}");
/// }
/// ```
///
/// # Errors
/// [`QuantityError`] for a text that is no turn, or none that is more than 0.
pub fn turns(text: &str) -> Result<f64, QuantityError> {
    let bare = text.trim();
    let number = ["turns", "turn"].iter().find_map(|unit| bare.strip_suffix(unit)).unwrap_or(bare).trim();
    let plain = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
    let fraction = |text: &str| {
        let (whole, text) =
            text.rsplit_once(' ').map_or((Some(0.0), text), |(whole, rest)| (plain(whole.trim()), rest));
        let (over, under) = text.split_once('/')?;
        Some(whole? + plain(over.trim())? / plain(under.trim())?)
    };
    let turned = match plain(number).or_else(|| fraction(number)) {
        Some(turned) => turned,
        None => angle_rad(bare)? / core::f64::consts::TAU,
    };
    if turned > 0.0 && turned.is_finite() {
        Ok(turned)
    } else {
        Err(QuantityError::OutOfRange { text: text.to_owned(), allowed: "more than 0 turns" })
    }
}

impl Answers {
    /// Returns true if a head that turned so far has made one revolution, as far as a person sees.
    pub fn is_one_turn(turned: f64) -> bool {
        fabs(turned - 1.0) <= SEEN
    }

    /// Returns the motor's steps of a head that turned so far when one revolution was asked of it. `steps_per_rev` are
    /// the motor's steps so far.
    ///
    /// The steps are those over the turn. Where a motor driver has microsteps near that, they are the driver's: a turn
    /// is read by eye.
    pub fn corrected_steps(&self, steps_per_rev: u32, turned: f64) -> CorrectedSteps {
        let steps = f64::from(steps_per_rev) / turned;
        let full_steps = self.full_steps.unwrap_or(USUAL_FULL_STEPS);
        let of = |microsteps: u32| f64::from(full_steps) * f64::from(microsteps);
        let off = |microsteps: &u32| fabs(of(*microsteps) / steps - 1.0);
        let powers = POWERS.into_iter().filter(|microsteps| off(microsteps) <= NEAR);
        let near = powers.chain(DECIMAL.into_iter().filter(|microsteps| off(microsteps) <= NEAR_DECIMAL));
        match near.min_by(|one, other| off(one).total_cmp(&off(other))) {
            Some(microsteps) => CorrectedSteps {
                steps_per_rev: full_steps.saturating_mul(microsteps),
                microsteps: Some(microsteps),
            },
            None => CorrectedSteps { steps_per_rev: floor(steps + 0.5).max(1.0) as u32, microsteps: None },
        }
    }

    /// Takes corrected steps. The turn is to be seen anew.
    pub fn correct_steps(&mut self, corrected: CorrectedSteps) {
        match corrected.microsteps {
            Some(microsteps) => {
                self.full_steps = Some(self.full_steps.unwrap_or(USUAL_FULL_STEPS));
                (self.steps_per_rev, self.microsteps) = (None, Some(microsteps));
            }
            None => {
                (self.steps_per_rev, self.microsteps, self.full_steps) =
                    (Some(corrected.steps_per_rev), None, None);
            }
        }
        self.done.turned = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_turn_is_four_times_the_microsteps() {
        let mut answers = Answers::of("acid");
        (answers.full_steps, answers.microsteps) = (Some(200), Some(16));
        // A driver set to 64 in place of 16, read by eye as somewhat more than a quarter.
        let corrected = answers.corrected_steps(3200, 0.27);
        assert_eq!((corrected.steps_per_rev, corrected.microsteps), (12_800, Some(64)));
        answers.correct_steps(corrected);
        assert_eq!(answers.motor().unwrap().steps_per_rev(), 12_800);
        // A belt of 60 to 20 teeth, which nobody named: no microsteps fit.
        let geared = answers.corrected_steps(12_800, 1.0 / 3.0);
        assert_eq!((geared.steps_per_rev, geared.microsteps), (38_400, None));
        assert!(Answers::is_one_turn(1.01) && !Answers::is_one_turn(0.9));
    }

    #[test]
    fn texts_that_are_no_turn_are_refused() {
        for text in ["", "no", "0", "-1", "1/0", "nan", "a/b", "1mL"] {
            assert!(turns(text).is_err(), "{text}");
        }
    }
}
