//! The displacement factor: measured over model volume, at one speed, as a line over several or by the speed law.

use pump_model::identification::widening;
use pump_model::math::{degrees, rad_s, sqrt};
use pump_model::{ModelError, Pump, SpeedLaw};
use serde::{Deserialize, Serialize};

use super::law_fit::LawFit;
use super::straight::{Point, Straight};
use crate::calibration::{CalibrationError, Run, Weighing};
use crate::displacement::RangedLaw;

/// Speeds that differ by less than this part are one.
const SAME_SPEED: f64 = 0.01;

/// A run further than this many robust standard deviations from the line is an outlier (Iglewicz and Hoaglin, "How to
/// Detect and Handle Outliers", ASQC 1993: modified z-score above 3.5).
const OUTLYING: f64 = 3.5;

/// Standard deviation of a normal distribution over its median absolute deviation.
const SIGMA_OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// What is known of the readings without looking at them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Standard deviation of repeated runs, part of the volume.
    pub repeatability: f64,
    /// Standard uncertainty of a reading of scale or vessel, mL. It may be the same in every run, so no mean reduces it.
    pub reading_ml: f64,
}

/// kappa(N) = factor + slope (N - reference), fitted to runs by weighted least squares; or the speed law, with that line beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Displacement {
    /// Weighted mean speed of the runs, r/min: there factor and slope are independent.
    pub reference_rpm: f64,
    /// Measured over model volume at the reference speed.
    pub factor: f64,
    /// Its standard error from the scatter of the runs.
    pub factor_standard: f64,
    /// Change of the factor with the speed, min/r; 0 with one speed.
    pub slope_per_rpm: f64,
    /// Its standard error, min/r.
    pub slope_standard_per_rpm: f64,
    /// Of the standard errors: runs less speeds where speeds were repeated, else runs less parameters; 0 if nothing is left, and
    /// the standard errors are those that were expected.
    pub degrees_of_freedom: u32,
    /// Standard deviation of the runs at one speed, part of the volume; where none was repeated, that about the line; none
    /// without degrees of freedom.
    pub scatter: Option<f64>,
    /// How far the means at three speeds or more lie from the line beyond that scatter, RMS, part of the volume.
    pub lack_of_fit: f64,
    /// Standard uncertainty of the readings that no mean reduces, part of the volume.
    pub reading: f64,
    /// The speeds, r/min, rising.
    pub speeds_rpm: Vec<f64>,
    /// Numbers of the runs that lie far from the line, from 1; they are in the fit.
    pub outliers: Vec<usize>,
    /// The speed law, if that was fitted: scatter, lack of fit and outliers are then those about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_law: Option<LawFit>,
}

impl Displacement {
    /// Fits `runs` of `pump`, as it is without this calibration. A run weighs as much as is expected of it: one over the
    /// square of its repeatability and of the reading's share in it.
    pub fn fit(
        pump: &Pump,
        runs: &[Run],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        Self::of(pump, runs, weighing, expected, None)
    }

    /// The same by the speed law, whose s and D are fitted; `start` has its theta_c and P_atm. `base` is the pump counted from its
    /// own zero. Three speeds are needed.
    pub fn fit_law(
        pump: &Pump,
        base: &Pump,
        start: &SpeedLaw,
        runs: &[Run],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        const NEEDED: usize = 3;
        let given = distinct(runs.iter().map(|run| run.speed_rpm)).len();
        if given < NEEDED {
            return Err(CalibrationError::TooFew { given, of: "speeds for a speed law", needed: NEEDED });
        }
        Self::of(pump, runs, weighing, expected, Some((base, start)))
    }

    fn of(
        pump: &Pump,
        runs: &[Run],
        weighing: &Weighing<'_>,
        expected: &Expected,
        law: Option<(&Pump, &SpeedLaw)>,
    ) -> Result<Self, CalibrationError> {
        let mut points = Vec::new();
        let mut reading_sum = 0.0;
        for (n, run) in runs.iter().enumerate() {
            let (measured_ml, model_ml) = run.volumes_ml(pump, weighing, n + 1)?;
            let reading = expected.reading_ml / model_ml;
            let sigma = sqrt(expected.repeatability * expected.repeatability + reading * reading);
            // Nothing is ever repeated exactly: this keeps the weights of a pump that claims so finite.
            let sigma = sigma.max(1e-9);
            reading_sum += reading;
            let speed_rad_s = rad_s(run.speed_rpm).copysign(run.turned_deg);
            points.push(Point {
                rpm: run.speed_rpm,
                trapped_kpa: law.map_or(Ok(0.0), |(base, law)| law.trapped_kpa(base, speed_rad_s))?,
                ratio: measured_ml / model_ml,
                weight: 1.0 / (sigma * sigma),
            });
        }
        if points.is_empty() {
            return Err(CalibrationError::TooFew { given: 0, of: "runs", needed: 1 });
        }
        let speeds_rpm = distinct(points.iter().map(|point| point.rpm));
        let is_line = speeds_rpm.len() > 1;
        let line = Straight::fit(&points, |point| point.rpm, is_line);
        let over_pressure = law.map(|_| Straight::fit(&points, |point| point.trapped_kpa, true));
        let residual = |point: &Point| match &over_pressure {
            Some(law) => point.ratio - law.at(point.trapped_kpa),
            None => point.ratio - line.value - line.slope * (point.rpm - line.reference),
        };

        let residuals: Vec<f64> = points.iter().map(residual).collect();
        let groups = by_speed(&points, &speeds_rpm, &residuals);
        let repeated = points.len() > groups.len();
        let parameters = if is_line { 2 } else { 1 };
        let used = if repeated { groups.len() } else { parameters };
        let degrees_of_freedom = points.len().saturating_sub(used) as u32;
        // What the runs scatter by at one speed; how the speeds' means depart from the line is the lack of fit, and counts once.
        let squares = groups.iter().map(|group| {
            let middle = if repeated { mean(group) } else { 0.0 };
            let weighted = |(n, left): &(usize, f64)| {
                points.get(*n).map_or(0.0, |point| point.weight * (left - middle) * (left - middle))
            };
            group.iter().map(weighted).sum::<f64>()
        });
        // Variance of the runs over what was expected of them.
        let variance_ratio =
            (degrees_of_freedom > 0).then(|| squares.sum::<f64>() / f64::from(degrees_of_freedom));
        let mean_sigma = sqrt(points.len() as f64 / line.weight);
        let error = sqrt(variance_ratio.unwrap_or(1.0));
        // Without a scatter that contains it the reading has a share of its own in the factor, `reading`.
        let factor_error = variance_ratio.map_or(expected.repeatability / mean_sigma, sqrt);
        let reading = reading_sum / points.len() as f64;
        let standards = |of: &Straight| [factor_error / sqrt(of.weight), error / sqrt(of.spread)];
        let speed_law = match (law, &over_pressure) {
            (Some((base, start)), Some(over)) => {
                let closure_deg = degrees(start.closure_rad);
                Some(LawFit::of(
                    base,
                    start,
                    closure_deg,
                    over,
                    standards(over),
                    reading,
                    degrees_of_freedom,
                )?)
            }
            _ => None,
        };
        let [factor_standard, slope_standard_per_rpm] = standards(&line);
        Ok(Self {
            reference_rpm: line.reference,
            factor: line.value,
            factor_standard,
            slope_per_rpm: line.slope,
            slope_standard_per_rpm: if is_line { slope_standard_per_rpm } else { 0.0 },
            degrees_of_freedom,
            scatter: variance_ratio.map(|ratio| sqrt(ratio) * mean_sigma),
            lack_of_fit: lack_of_fit(&groups),
            reading,
            outliers: outliers(&groups, mean_sigma),
            speeds_rpm,
            speed_law,
        })
    }

    /// kappa of the line at a speed in r/min.
    pub(super) fn line_at(&self, rpm: f64) -> f64 {
        self.factor + self.slope_per_rpm * (rpm - self.reference_rpm)
    }

    /// kappa of `base`, as it is without this calibration, at a speed in r/min, negative in reverse.
    pub fn factor_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        match &self.speed_law {
            Some(fit) => fit.law().factor(base, rad_s(rpm)),
            None => Ok(self.line_at(rpm.abs())),
        }
    }

    /// Standard uncertainty of kappa at a speed, widened so that twice it covers 95 % whatever the number of runs.
    pub fn standard_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        let (factor, slope) = match &self.speed_law {
            Some(fit) => {
                let away_kpa = fit.law().trapped_kpa(base, rad_s(rpm))? - fit.reference_kpa;
                (fit.factor_standard, fit.slope_standard_per_kpa * away_kpa)
            }
            None => (self.factor_standard, self.slope_standard_per_rpm * (rpm.abs() - self.reference_rpm)),
        };
        let errors = widening(self.degrees_of_freedom) * sqrt(factor * factor + slope * slope);
        Ok(sqrt(errors * errors + self.reading * self.reading))
    }

    /// The speed law that was fitted, over the speeds that it covers.
    pub(super) fn law(&self) -> Option<RangedLaw> {
        let (least_rpm, most_rpm) = self.range_rpm();
        let law = self.speed_law.as_ref()?.law();
        Some(RangedLaw {
            law,
            least_rpm: least_rpm * (1.0 - SAME_SPEED),
            most_rpm: most_rpm * (1.0 + SAME_SPEED),
        })
    }

    /// Whether kappa was weighed at several speeds, and so holds between them.
    pub fn is_line(&self) -> bool {
        self.speeds_rpm.len() > 1
    }

    /// Slowest and fastest speed, r/min.
    pub fn range_rpm(&self) -> (f64, f64) {
        let ends = (self.speeds_rpm.first(), self.speeds_rpm.last());
        (ends.0.copied().unwrap_or(self.reference_rpm), ends.1.copied().unwrap_or(self.reference_rpm))
    }

    /// Distance to the nearest speed of the runs, r/min; 0 at one of them.
    pub fn distance_rpm(&self, rpm: f64) -> f64 {
        let nearest = self.speeds_rpm.iter().map(|speed| (speed - rpm).abs()).fold(f64::INFINITY, f64::min);
        if nearest <= SAME_SPEED * rpm { 0.0 } else { nearest }
    }

    /// Whether a dose may cruise at this speed: within the speeds of a line; a calibration at one speed is used at all, with
    /// a warning.
    pub fn covers(&self, rpm: f64) -> bool {
        let (least, most) = self.range_rpm();
        !self.is_line() || (least * (1.0 - SAME_SPEED)..=most * (1.0 + SAME_SPEED)).contains(&rpm)
    }

    /// The slowest speed of the line, r/min, whose mean flow is `flow_ml_s` on a pump of `revolution_ml` per revolution without this
    /// calibration: the smaller root of kappa(N) V_rot N / 60 = Q. None beyond the largest flow that the line has.
    pub fn speed_for_flow(&self, revolution_ml: f64, flow_ml_s: f64) -> Option<f64> {
        let wanted_rpm = 60.0 * flow_ml_s / revolution_ml;
        let at_rest = self.line_at(0.0);
        let discriminant = at_rest * at_rest + 4.0 * self.slope_per_rpm * wanted_rpm;
        // The form without cancellation; at slope 0 it is the quotient.
        let rpm = 2.0 * wanted_rpm / (at_rest + sqrt(discriminant));
        (discriminant >= 0.0 && rpm > 0.0 && rpm.is_finite()).then_some(rpm)
    }
}

/// The speeds that are not the same, rising: each the mean of its runs.
fn distinct(speeds: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut speeds: Vec<f64> = speeds.collect();
    speeds.sort_unstable_by(f64::total_cmp);
    let groups = speeds.chunk_by(|one, next| *next <= one * (1.0 + SAME_SPEED));
    groups.map(|group| group.iter().sum::<f64>() / group.len() as f64).collect()
}

/// What the runs at one speed depart from the line by, for each speed.
fn by_speed(points: &[Point], speeds_rpm: &[f64], residuals: &[f64]) -> Vec<Vec<(usize, f64)>> {
    let distance = |point: &Point, speed_rpm: &f64| (point.rpm - speed_rpm).abs();
    let mut groups = vec![Vec::new(); speeds_rpm.len()];
    for (n, (point, residual)) in points.iter().zip(residuals).enumerate() {
        let nearest = speeds_rpm
            .iter()
            .enumerate()
            .min_by(|(_, one), (_, other)| distance(point, one).total_cmp(&distance(point, other)));
        if let Some(group) = nearest.and_then(|(group, _)| groups.get_mut(group)) {
            group.push((n, *residual));
        }
    }
    groups
}

fn mean(group: &[(usize, f64)]) -> f64 {
    group.iter().map(|(_, residual)| residual).sum::<f64>() / group.len() as f64
}

/// Root of the variance of the speeds' means about the line that the scatter within the speeds does not explain.
fn lack_of_fit(groups: &[Vec<(usize, f64)>]) -> f64 {
    let runs = groups.iter().map(Vec::len).sum::<usize>();
    if groups.len() < 3 || runs == groups.len() {
        return 0.0;
    }
    let (mut between, mut within) = (0.0, 0.0);
    for group in groups {
        let mean = mean(group);
        between += group.len() as f64 * mean * mean;
        within += group.iter().map(|(_, residual)| (residual - mean) * (residual - mean)).sum::<f64>();
    }
    let excess = between / (groups.len() - 2) as f64 - within / (runs - groups.len()) as f64;
    sqrt(excess.max(0.0) * groups.len() as f64 / runs as f64)
}

/// Numbers of the runs, from 1, that lie far from the median of their speed, or, where no speed was repeated, from the line.
/// `sigma` is what was expected of a run: nothing nearer than half of it is called an outlier, however much the others agree.
fn outliers(groups: &[Vec<(usize, f64)>], sigma: f64) -> Vec<usize> {
    let runs = groups.iter().map(Vec::len).sum::<usize>();
    let repeated = runs > groups.len();
    let mut distances = Vec::new();
    for group in groups {
        let mut residuals: Vec<f64> = group.iter().map(|(_, residual)| *residual).collect();
        residuals.sort_unstable_by(f64::total_cmp);
        let median = if repeated { residuals.get(residuals.len() / 2).copied().unwrap_or(0.0) } else { 0.0 };
        distances.extend(group.iter().map(|(n, residual)| (*n, (residual - median).abs())));
    }
    let mut sorted: Vec<f64> = distances.iter().map(|(_, distance)| *distance).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // The median of each speed is at no distance from itself and says nothing of the scatter.
    let telling = sorted.get(if repeated { groups.len() } else { 0 }..).unwrap_or(&[]);
    let median = telling.get(telling.len() / 2).copied().unwrap_or(0.0);
    let robust = (SIGMA_OF_MEDIAN * median).max(0.5 * sigma);
    let mut far: Vec<usize> =
        distances.iter().filter(|(_, distance)| *distance > OUTLYING * robust).map(|(n, _)| n + 1).collect();
    far.sort_unstable();
    far
}

#[cfg(test)]
mod tests;
