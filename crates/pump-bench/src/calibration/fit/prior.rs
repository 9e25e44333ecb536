//! The prior of a pump's scatter, for weighed doses that are too few to show it.
//!
//! The prior is a scaled inverse chi-square distribution of the variance, with nu0 degrees of freedom about s0². After
//! runs with the variance s² and nu degrees of freedom it has nu0 + nu about (nu0 s0² + nu s²)/(nu0 + nu), and errors
//! follow Student's t of nu0 + nu (Gelman et al., "Bayesian Data Analysis", 3rd edition, 2.6 and 3.2).

use libm::sqrt;
use pump_model::identification::widening;
use serde::{Deserialize, Serialize};

/// Degrees of freedom of the prior: the pump file's scatter is known to 1/sqrt(2 nu0), 41 % (GUM, JCGM 100:2008,
/// G.4.2).
const DEGREES_OF_FREEDOM: u32 = 3;

/// Standard deviation of the prior over that of the pump file. The draws of DESIGN.md chose it with the degrees of
/// freedom: stated intervals cover 93 % up to twice the file's scatter.
const OVER_EXPECTED: f64 = 1.3;

/// Most weighed doses that are few: they hardly show their scatter.
const FEW: u32 = 3;

/// Prior of the scatter that a calibration rests on, beside the scatter of its weighed doses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ScatterPrior {
    /// Degrees of freedom of the prior.
    pub degrees_of_freedom: u32,
    /// Standard deviation of the prior over that of the pump file.
    pub over_expected: f64,
    /// Standard deviation that the prior states for doses like the weighed ones, as a part of the volume.
    pub standard: f64,
    /// Standard deviation of these doses by the prior and by what the doses show, as a part of the volume.
    pub pooled: f64,
    /// Standard deviation of these doses by the drop and the start angle, which are known, as a part of the volume.
    pub known: f64,
    /// Number of weighed doses.
    pub weighed: u32,
    /// Degrees of freedom of the scatter that these doses show.
    pub shown: u32,
}

/// Weighed doses as the pool of a prior counts them. Each variance is over the expected variance of a dose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    /// Variance that was expected of the pump.
    pub(super) own: f64,
    /// Variance by the drop and the start angle.
    pub(super) known: f64,
    /// Variance of the doses, and its degrees of freedom.
    pub(super) ratio: f64,
    pub(super) degrees_of_freedom: u32,
    pub(super) weighed: u32,
}

impl ScatterPrior {
    /// Pools the prior with what weighed doses show. `sigma` is the standard deviation that was expected of a dose.
    ///
    /// Balance, drop and start angle are no part of the pump's scatter. So the doses show their variance less these.
    pub(super) fn pooled_with(doses: &Shown, sigma: f64) -> Self {
        let (prior, shown) = (f64::from(DEGREES_OF_FREEDOM), f64::from(doses.degrees_of_freedom));
        let stated = OVER_EXPECTED * OVER_EXPECTED * doses.own;
        let seen = (doses.ratio - (1.0 - doses.own)).max(0.0);
        let pooled = (prior * stated + shown * seen) / (prior + shown);
        Self {
            degrees_of_freedom: DEGREES_OF_FREEDOM,
            over_expected: OVER_EXPECTED,
            standard: sigma * sqrt(stated),
            pooled: sigma * sqrt(pooled),
            known: sigma * sqrt(doses.known),
            weighed: doses.weighed,
            shown: doses.degrees_of_freedom,
        }
    }

    /// True while the weighed doses hardly show their scatter.
    pub fn rests_on_few(&self) -> bool {
        self.weighed <= FEW
    }

    /// Returns Student's t over 2 of prior and doses.
    fn widening(&self) -> f64 {
        widening(self.degrees_of_freedom.saturating_add(self.shown))
    }

    /// Returns the standard deviation of doses like the weighed ones, as a part of the volume: pooled and widened,
    /// with drop and start angle.
    pub fn of_dose(&self) -> f64 {
        sqrt(self.widened() * self.widened() + self.known * self.known)
    }

    /// Returns the pooled standard deviation, widened, as a part of the volume.
    pub(crate) fn widened(&self) -> f64 {
        self.widening() * self.pooled
    }

    /// Returns the widening of a standard error that has the pooled and the known standard deviation.
    pub(super) fn growth(&self) -> f64 {
        let error = self.error_of_one();
        if error > 0.0 { self.of_dose() / error } else { 1.0 }
    }

    /// Returns the standard deviation of a dose without widening, as a part of the volume.
    pub(super) fn error_of_one(&self) -> f64 {
        sqrt(self.pooled * self.pooled + self.known * self.known)
    }

    /// Returns the factor on the pump file's scatter, at any volume, by which the prior counts beside what the doses
    /// show; widened.
    pub(crate) fn over_file(&self) -> f64 {
        self.widening() * self.over_expected * sqrt(self.weight())
    }

    /// Returns the standard deviation by what the doses show beside the prior, widened, as a part of the volume.
    pub(super) fn shown_standard(&self) -> f64 {
        let square = self.pooled * self.pooled - self.weight() * self.standard * self.standard;
        self.widening() * sqrt(square.max(0.0))
    }

    /// Returns the weight of the prior's variance in the pooled one.
    fn weight(&self) -> f64 {
        let prior = f64::from(self.degrees_of_freedom);
        prior / (prior + f64::from(self.shown))
    }

    /// Returns the prior with one more weighed dose, which scatters as the pump file says.
    pub(super) fn after_one_more(&self) -> Self {
        let shown = self.shown.saturating_add(1);
        let expected = self.standard / self.over_expected;
        let degrees = f64::from(self.degrees_of_freedom.saturating_add(self.shown));
        let pooled = sqrt((degrees * self.pooled * self.pooled + expected * expected) / (degrees + 1.0));
        Self { pooled, shown, weighed: self.weighed.saturating_add(1), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prior(ratio: f64, weighed: u32) -> ScatterPrior {
        let doses = Shown { own: 0.8, known: 0.15, ratio, degrees_of_freedom: weighed - 1, weighed };
        ScatterPrior::pooled_with(&doses, 0.01)
    }

    #[test]
    fn one_dose_has_the_prior_and_students_t_of_its_degrees_of_freedom() {
        let one = prior(0.0, 1);
        assert!((one.standard - 0.01 * 1.3 * 0.8_f64.sqrt()).abs() < 1e-12 && one.pooled == one.standard);
        // t of 3 degrees of freedom for 95.45 % is 3.31 (GUM, table G.2).
        let known = 0.01 * 0.15_f64.sqrt();
        assert!((one.of_dose() - (1.655 * one.standard).hypot(known)).abs() < 1e-12);
        assert!((one.over_file() - 1.655 * 1.3).abs() < 1e-12 && one.shown_standard() == 0.0);
    }

    #[test]
    fn doses_show_their_variance_less_that_of_balance_drop_and_angle() {
        // A variance of 1 is what was expected: 0.8 of it is the pump's.
        let two = prior(1.0, 2);
        let pooled = 1e-4 * (3.0 * 1.69 * 0.8 + 0.8) / 4.0;
        assert!((two.pooled * two.pooled - pooled).abs() < 1e-12, "{two:?}");
        // t of 4 degrees of freedom is 2.87. Both parts make the whole.
        let whole = (two.over_file() * 0.01 * 0.8_f64.sqrt()).hypot(two.shown_standard());
        assert!((whole - 1.435 * two.pooled).abs() < 1e-12);
        let one = prior(0.0, 1);
        assert!((one.after_one_more().pooled - two.pooled).abs() < 1e-12);
    }

    #[test]
    fn a_second_dose_narrows_unless_it_lies_far_from_the_first() {
        let dose = |prior: ScatterPrior| prior.of_dose() * (1.0 + 1.0 / f64::from(prior.weighed)).sqrt();
        let pair = |difference: f64| {
            let doses = Shown {
                own: 1.0,
                known: 0.0,
                ratio: 0.5 * difference * difference,
                degrees_of_freedom: 1,
                weighed: 2,
            };
            ScatterPrior::pooled_with(&doses, 0.01)
        };
        let one = Shown { own: 1.0, known: 0.0, ratio: 0.0, degrees_of_freedom: 0, weighed: 1 };
        let one = dose(ScatterPrior::pooled_with(&one, 0.01));
        // (1.435²/4) 1.5 (3 1.69 + d²/2) = 1.655² 2 1.69 at d = 3.72.
        assert!(dose(pair(3.7)) < one && dose(pair(3.75)) > one);
    }
}
