//! Mean flow of a displacement over the speed: Q = kappa(N) V_rot N/60, a polynomial of third order at most.

use libm::sqrt;

use super::Displacement;

/// Halvings of an interval until its ends are neighbours.
const HALVINGS: u32 = 200;

impl Displacement {
    /// Returns the slowest speed, in r/min, whose mean flow is `flow_ml_s` on a pump that delivers
    /// `revolution_ml` per revolution without this calibration: the smallest root of kappa(N) V_rot N/60 = Q.
    /// Returns `None` beyond the largest flow, and beyond the speeds of the runs if kappa is bent.
    pub(crate) fn speed_for_flow(&self, revolution_ml: f64, flow_ml_s: f64) -> Option<f64> {
        let wanted_rpm = 60.0 * flow_ml_s / revolution_ml;
        if self.bend.is_some() {
            return self.bent_speed_rpm(wanted_rpm);
        }
        let at_rest = self.kappa_at(0.0);
        let discriminant = at_rest * at_rest + 4.0 * self.slope_per_rpm * wanted_rpm;
        // The form without cancellation; at slope 0 it is the quotient.
        let rpm = 2.0 * wanted_rpm / (at_rest + sqrt(discriminant));
        (discriminant >= 0.0 && rpm > 0.0 && rpm.is_finite()).then_some(rpm)
    }

    /// Returns the smallest N, in r/min, at which kappa(N) N is `wanted_rpm`, within the speeds of the runs or
    /// below them. Between its turning points kappa(N) N is monotone.
    fn bent_speed_rpm(&self, wanted_rpm: f64) -> Option<f64> {
        let (_, most_rpm) = self.range_rpm();
        let missing = |rpm: f64| self.kappa_at(rpm) * rpm - wanted_rpm;
        let mut from_rpm = 0.0;
        for to_rpm in self.turning_rpm(most_rpm).into_iter().flatten().chain([self.dose_range_rpm()[1]]) {
            if missing(from_rpm) * missing(to_rpm) <= 0.0 {
                let (mut low, mut high) = (from_rpm, to_rpm);
                let rises = missing(high) >= missing(low);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if (missing(middle) < 0.0) == rises { low = middle } else { high = middle }
                }
                return Some(0.5 * (low + high));
            }
            from_rpm = to_rpm;
        }
        None
    }

    /// Returns the speed between two speeds, in r/min, at which kappa(N) N is largest.
    pub(in crate::calibration::fit) fn largest_flow_rpm(&self, least_rpm: f64, most_rpm: f64) -> f64 {
        let turning = self.turning_rpm(most_rpm).into_iter().flatten().filter(|rpm| *rpm > least_rpm);
        let flow = |rpm: &f64| self.kappa_at(*rpm) * rpm;
        turning
            .chain([least_rpm])
            .fold(most_rpm, |best, rpm| if flow(&rpm) > flow(&best) { rpm } else { best })
    }

    /// Returns the speeds between 0 and `most_rpm`, rising, at which kappa(N) N turns: the roots of
    /// k0 + 2 k1 N + 3 k2 N².
    fn turning_rpm(&self, most_rpm: f64) -> [Option<f64>; 2] {
        let [k0, k1, k2] = self.powers();
        let discriminant = k1 * k1 - 3.0 * k2 * k0;
        if discriminant.is_nan() || discriminant < 0.0 {
            return [None, None];
        }
        // The form without cancellation; at k2 = 0 the other root is infinite.
        let half = -(k1 + sqrt(discriminant).copysign(k1));
        let mut roots = [half / (3.0 * k2), k0 / half];
        roots.sort_unstable_by(f64::total_cmp);
        roots.map(|root| Some(root).filter(|root| *root > 0.0 && *root < most_rpm))
    }

    /// Returns kappa over the powers of the speed in r/min: kappa = k0 + k1 N + k2 N².
    fn powers(&self) -> [f64; 3] {
        let reference = self.reference_rpm;
        let (k0, k1) = (self.factor - self.slope_per_rpm * reference, self.slope_per_rpm);
        let Some(bend) = &self.bend else { return [k0, k1, 0.0] };
        // (x² - skew x - spread) with x = N - reference.
        let constant = reference * (reference + bend.skew_rpm) - bend.spread_rpm2;
        let linear = -(2.0 * reference + bend.skew_rpm);
        [k0 + bend.per_rpm2 * constant, k1 + bend.per_rpm2 * linear, bend.per_rpm2]
    }
}
