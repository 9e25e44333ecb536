//! The default pulse of a head that is known by its volume alone, with the spread that drawings of heads leave.

use core::f64::consts::TAU;

use libm::{cos, exp, log, sin, sqrt};
use pump_model::DefaultPulse;
use pump_model::identification::widening;

use super::PulseBounds;
use super::pulse_spread::{self, ENGAGEMENT_SPREAD, FULLNESS_STANDARD};

/// Number of drawings that show the scatter.
const DRAWINGS: u32 = 5;

/// Number of pulses that stand for all that heads may have.
const PULSES: usize = 128;

/// Default pulse of a head of which the number of rollers is known, with its standard uncertainties.
///
/// ```
/// use pump_bench::displacement::PulsePrior;
/// let prior = PulsePrior::of(4);
/// // The share of a pitch is the fullness times the part of the pitch that the pulse takes.
/// assert!((prior.share() - prior.fullness * prior.engagement_deg / 90.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PulsePrior {
    /// Number of rollers.
    pub rollers: u32,
    /// Engagement angle phi, in deg: the middle of its logarithms.
    pub engagement_deg: f64,
    /// Standard uncertainty of the logarithm of phi.
    pub engagement_spread: f64,
    /// Fullness V_r/(a phi): the part of the bore's volume over phi that a roller takes.
    pub fullness: f64,
    /// Standard uncertainty of the fullness.
    pub fullness_standard: f64,
}

impl PulsePrior {
    /// Returns the default pulse of a head with this number of rollers.
    pub fn of(rollers: u32) -> Self {
        Self {
            rollers,
            engagement_deg: DefaultPulse::usual_engagement_deg(rollers),
            engagement_spread: ENGAGEMENT_SPREAD,
            fullness: DefaultPulse::FULLNESS,
            fullness_standard: FULLNESS_STANDARD,
        }
    }

    /// Returns the share of the bore's volume of a pitch that a roller takes.
    pub fn share(&self) -> f64 {
        self.fullness * self.engagement_deg * f64::from(self.rollers) / 360.0
    }

    /// Returns the pulse of the model.
    pub(crate) fn pulse(&self) -> DefaultPulse {
        DefaultPulse::new(self.share(), self.engagement_deg)
    }

    /// Returns the bounds that geometry sets to the pulse.
    pub(crate) fn bounds(&self) -> PulseBounds {
        PulseBounds::of(self.rollers)
    }

    /// Returns pulses that heads may have, each as likely as any other: ln phi and the fullness are normal, within
    /// [`Self::bounds`]. The standard uncertainties are those of the prior, widened as five drawings are few (Student's
    /// t; GUM, JCGM 100:2008, G.3.2).
    ///
    /// The pairs are those of Halton (Numerische Mathematik 2, 1960), in bases 2 and 3, made normal as by Box and
    /// Muller (Annals of Mathematical Statistics 29, 1958).
    pub(crate) fn pulses(&self) -> impl Iterator<Item = DefaultPulse> {
        let (prior, bounds, wider) = (*self, self.bounds(), widening(DRAWINGS - 1));
        let drawn = (1..).filter_map(move |n| {
            let radius = wider * sqrt(-2.0 * log(halton(n, 2)));
            let (sine, cosine) = (sin(TAU * halton(n, 3)), cos(TAU * halton(n, 3)));
            let engagement_deg = prior.engagement_deg * exp(prior.engagement_spread * radius * cosine);
            let fullness = prior.fullness + prior.fullness_standard * radius * sine;
            let share = fullness * engagement_deg * f64::from(prior.rollers) / 360.0;
            bounds.hold(engagement_deg, fullness).then(|| DefaultPulse::new(share, engagement_deg))
        });
        drawn.take(PULSES)
    }

    /// Returns the covariances of V_r, as a part of it, and of phi, in rad.
    pub(crate) fn covariances(&self) -> [[f64; 2]; 2] {
        pulse_spread::covariances(self.rollers)
    }
}

/// Returns the part between 0 and 1 whose digits in `base` are those of `n` in reverse, `n` > 0.
fn halton(n: u32, base: u32) -> f64 {
    let (mut rest, mut digit, mut part) = (n, 1.0 / f64::from(base), 0.0);
    while rest > 0 {
        part += digit * f64::from(rest % base);
        rest /= base;
        digit /= f64::from(base);
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_halton_are_the_digits_in_reverse() {
        for (n, base, part) in [(1, 2, 0.5), (6, 2, 0.375), (5, 3, 7.0 / 9.0), (9, 3, 1.0 / 27.0)] {
            assert!((halton(n, base) - part).abs() < 1e-15, "{n} {base}");
        }
    }

    #[test]
    fn pulses_have_the_spread_of_the_prior_where_no_bound_cuts_them() {
        // So narrow a spread reaches no bound.
        let prior = PulsePrior { engagement_spread: 0.1, fullness_standard: 0.03, ..PulsePrior::of(3) };
        let pulses: Vec<_> = prior.pulses().collect();
        let logs: Vec<f64> =
            pulses.iter().map(|pulse| (pulse.engagement_deg() / prior.engagement_deg).ln()).collect();
        let fullnesses: Vec<f64> = pulses
            .iter()
            .map(|pulse| pulse.share * 120.0 / pulse.engagement_deg() - prior.fullness)
            .collect();
        // 2.87/2: the 95.45th percentile of Student's t of 4 degrees of freedom (GUM, table G.2).
        for (values, standard) in [(logs, 0.1 * 1.435), (fullnesses, 0.03 * 1.435)] {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let square = values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64;
            assert!(mean.abs() < 0.03 * standard, "{mean}");
            assert!((square.sqrt() / standard - 1.0).abs() < 0.05, "{square}");
        }
    }

    #[test]
    fn every_pulse_is_one_that_a_head_can_have() {
        for rollers in [1, 2, 3, 4, 6, 8, 12, 40, 1000] {
            let prior = PulsePrior::of(rollers);
            let pulses: Vec<_> = prior.pulses().collect();
            assert_eq!(pulses.len(), PULSES, "{rollers}");
            for pulse in pulses {
                assert!(pulse.share > 0.0 && pulse.share <= 2.0 / 3.0, "{rollers}: {pulse:?}");
                assert!(pulse.engagement_deg() <= prior.bounds().longest_deg, "{rollers}: {pulse:?}");
                pulse.roller_volume(1.0).unwrap();
            }
        }
    }
}
