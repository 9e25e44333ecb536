//! The fit of a line or of a law to weighed runs.

use libm::sqrt;
use pump_model::Pump;
use pump_model::identification::least_squares::StraightLine;

use super::Displacement;
use crate::calibration::fit::departures::{Departures, VarianceRatio};
use crate::calibration::fit::expected::Expected;
use crate::calibration::fit::law_fit::{LawFit, LawToFit};
use crate::calibration::fit::points::{Points, distinct};
use crate::calibration::fit::prior::{ScatterPrior, Shown};
use crate::calibration::fit::scatter::Scatter;
use crate::calibration::fit::speed_bend::SpeedBend;
use crate::calibration::{CalibrationError, CalibrationRun, Weighing};

impl Displacement {
    /// Fits a line to `runs` of `pump`, the pump as it is without this calibration. The weight of a run is 1
    /// over the sum of the squares of its repeatability and of the reading's share in it.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] without runs. Errors that name a run if its volume is implausible, or
    /// cannot be told.
    pub fn fit(
        pump: &Pump,
        runs: &[CalibrationRun],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        let points = Points::of(pump, runs, weighing, expected)?;
        let line = points.over_speed()?;
        let departures = points.departures_from_line(&line);
        let errors = Errors::of(&points, points.parameters(), &line, &departures);
        Ok(Self::of(&points, &line, &departures, &errors, Shape::Line))
    }

    /// Fits a line to `runs` of `pump`, with a bend if the runs ask for one at four speeds or more.
    ///
    /// # Errors
    ///
    /// Errors of [`Self::fit`].
    pub(crate) fn fit_best(
        pump: &Pump,
        runs: &[CalibrationRun],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        let points = Points::of(pump, runs, weighing, expected)?;
        let line = points.over_speed()?;
        let Some(bend) = SpeedBend::asked_for(&points, &line) else {
            return Self::fit(pump, runs, weighing, expected);
        };
        let bent = points.weighted().map(|(rpm, ..)| line.at(rpm) + bend.at(rpm - line.reference));
        let departures = points.departures(bent);
        let errors = Errors::of(&points, points.parameters() + 1, &line, &departures);
        Ok(Self::of(&points, &line, &departures, &errors, Shape::Bent(bend)))
    }

    /// Fits `law` to `runs` of `pump`, the pump as it is without this calibration. The fit needs three speeds.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] with fewer than three speeds. [`CalibrationError::NoLaw`] if the runs are
    /// not those of the law. Errors that name a run if its volume is implausible, or cannot be told.
    pub(crate) fn fit_law(
        law: &LawToFit<'_>,
        pump: &Pump,
        runs: &[CalibrationRun],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        const NEEDED: usize = 3;
        let given = distinct(runs.iter().map(|run| run.speed_rpm)).len();
        if given < NEEDED {
            return Err(CalibrationError::TooFew { given, of: "speeds for a speed law", needed: NEEDED });
        }
        let points = Points::of(pump, runs, weighing, expected)?;
        let line = points.over_speed()?;
        let over = law.line(&points)?;
        let departures = points.departures(over.fitted());
        let errors = Errors::of(&points, points.parameters(), &line, &departures);
        let degrees_of_freedom = errors.scatter.degrees_of_freedom();
        let standards = errors.standards(&over.line);
        let law = over.law(standards, (points.level, points.reading), degrees_of_freedom)?;
        Ok(Self::of(&points, &line, &departures, &errors, Shape::Law(law)))
    }

    fn of(
        points: &Points,
        line: &StraightLine,
        departures: &Departures,
        errors: &Errors,
        shape: Shape,
    ) -> Self {
        let level = points.level;
        let [factor_standard, slope_standard_per_rpm] = errors.standards(line).map(|part| level * part);
        let (bend, law) = match shape {
            Shape::Line => (None, None),
            Shape::Bent(bend) => (Some(bend.times(level)), None),
            Shape::Law(law) => (None, Some(law)),
        };
        Self {
            reference_rpm: line.reference,
            factor: level * line.offset.value,
            factor_standard,
            slope_per_rpm: level * line.slope.value,
            slope_standard_per_rpm,
            scatter: errors.scatter,
            prior: errors.prior,
            bend,
            lack_of_fit: departures.lack_of_fit(if bend.is_some() { 3 } else { 2 }),
            reading: points.reading,
            outliers: departures.outliers(errors.mean_sigma),
            speeds_rpm: points.speeds_rpm.clone(),
            law,
        }
    }
}

/// Shape over the speed that was fitted beside the line.
enum Shape {
    Line,
    Bent(SpeedBend),
    Law(LawFit),
}

/// Errors of the runs beside those that were expected.
struct Errors {
    scatter: Scatter,
    /// Prior that stands beside the scatter.
    prior: Option<ScatterPrior>,
    /// Standard deviation that was expected of a run, mean of the runs by their weights.
    mean_sigma: f64,
    /// Error of the factor, over the error that was expected.
    of_factor: f64,
    /// Error of the slope, over the error that was expected.
    of_slope: f64,
}

impl Errors {
    /// Returns the errors of the runs about a fit with so many parameters.
    fn of(points: &Points, parameters: usize, line: &StraightLine, departures: &Departures) -> Self {
        let mean_sigma = sqrt(departures.runs() as f64 * line.offset.variance);
        let seen = departures.variance_ratio(parameters);
        let prior = points.is_prior.then(|| Self::prior(points, departures.runs(), seen, mean_sigma));
        let errors = match seen {
            Some(VarianceRatio { degrees_of_freedom, ratio }) => {
                let error = sqrt(ratio);
                let scatter = Scatter::Seen { degrees_of_freedom, standard: error * mean_sigma };
                Self { scatter, prior, mean_sigma, of_factor: error, of_slope: error }
            }
            // Without a scatter that contains it the reading has a share of its own in the factor.
            None => Self {
                scatter: Scatter::Expected,
                prior,
                mean_sigma,
                of_factor: points.scatter_in_mean(),
                of_slope: 1.0,
            },
        };
        match prior {
            Some(prior) => {
                let error = prior.error_of_one() / mean_sigma;
                Self { of_factor: error, of_slope: error, ..errors }
            }
            None => errors,
        }
    }

    /// Returns the prior pooled with what `weighed` runs show.
    fn prior(points: &Points, weighed: usize, seen: Option<VarianceRatio>, mean_sigma: f64) -> ScatterPrior {
        let [own, known] = points.parts();
        let (ratio, degrees_of_freedom) =
            seen.map_or((0.0, 0), |seen| (seen.ratio, seen.degrees_of_freedom.get()));
        let weighed = u32::try_from(weighed).unwrap_or(u32::MAX);
        ScatterPrior::pooled_with(&Shown { own, known, ratio, degrees_of_freedom, weighed }, mean_sigma)
    }

    /// Returns the standard errors of the offset and the slope of a line over the level.
    fn standards(&self, line: &StraightLine) -> [f64; 2] {
        [self.of_factor * sqrt(line.offset.variance), self.of_slope * sqrt(line.slope.variance)]
    }
}
