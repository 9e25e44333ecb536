//! Weighed runs as points of a fit: measured over model volume against the speed.

use libm::{hypot, sqrt};
use pump_model::Pump;
use pump_model::identification::least_squares::{StraightLine, Terms};
use pump_model::units::rad_s;

use super::departures::{Departure, Departures};
use super::expected::Expected;
use crate::calibration::{CalibrationError, CalibrationRun, Weighing};

/// Speeds that differ by less than this part are one.
pub(super) const SAME_SPEED: f64 = 0.01;

/// A weighed run as a point of a fit.
struct Point {
    /// Cruise speed, in r/min, positive.
    rpm: f64,
    /// Cruise speed, in rad/s, negative in reverse.
    speed_rad_s: f64,
    /// Measured over model volume, over the [`Points::level`].
    ratio: f64,
    /// Standard uncertainty that is expected of the measured volume, as a part of it.
    sigma: f64,
    /// Part of that uncertainty that the pump's scatter makes.
    repeatability: f64,
    /// Part of that uncertainty that drop and start angle make.
    known: f64,
}

/// Weighed runs as points of a fit. There is at least one.
///
/// All errors are parts of the measured volume, so the fits take the ratios over their mean. A pump whose model is
/// twice as large has the same points, and half the level.
pub(super) struct Points {
    points: Vec<Point>,
    /// Mean of measured over model volume.
    pub(super) level: f64,
    /// Speeds of the runs, in r/min, rising.
    pub(super) speeds_rpm: Vec<f64>,
    /// Standard uncertainty of a reading and of the angles at which its run may have begun, as a part of the volume,
    /// mean of the runs.
    pub(super) reading: f64,
    /// True if the pump's scatter is a prior.
    pub(super) is_prior: bool,
}

impl Points {
    /// Returns the points of `runs` of `pump`, as it is without this calibration.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] without runs, and the errors of [`CalibrationRun::volumes_ml`].
    pub(super) fn of(
        pump: &Pump,
        runs: &[CalibrationRun],
        weighing: &Weighing<'_>,
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        let mut ratios = Vec::new();
        for (n, run) in runs.iter().enumerate() {
            let (measured_ml, model_ml) = run.volumes_ml(pump, weighing, n + 1)?;
            ratios.push((measured_ml / model_ml, model_ml));
        }
        let level = ratios.iter().map(|(ratio, _)| ratio).sum::<f64>() / ratios.len() as f64;
        let mut points = Vec::new();
        let mut reading_sum = 0.0;
        for (run, (ratio, model_ml)) in runs.iter().zip(ratios) {
            // By the mean of all runs, so that the weight of a run does not depend on its own reading.
            let volume_ml = level * model_ml;
            // Runs of one volume after each other may err by their angles alike, as readings do.
            let reading = hypot(expected.reading_ml / volume_ml, run.angle_standard_ml(pump) / model_ml);
            let repeatability = expected.repeatability_of(level * pump.revolution_ml(), volume_ml);
            let known = expected.known_of(level, volume_ml);
            let sigma = sqrt(repeatability * repeatability + known * known + reading * reading);
            reading_sum += hypot(reading, expected.density);
            points.push(Point {
                rpm: run.speed_rpm,
                speed_rad_s: rad_s(run.speed_rpm).copysign(run.turned_deg),
                ratio: ratio / level,
                // Nothing is ever repeated exactly: this keeps the weights of a pump that claims so finite.
                sigma: sigma.max(1e-9),
                repeatability,
                known,
            });
        }
        if points.is_empty() {
            return Err(CalibrationError::TooFew { given: 0, of: "runs", needed: 1 });
        }
        let speeds_rpm = distinct(points.iter().map(|point| point.rpm));
        let reading = reading_sum / points.len() as f64;
        Ok(Self { points, level, speeds_rpm, reading, is_prior: expected.is_prior })
    }

    /// Number of parameters of a line through the points: factor and slope, or the factor alone at one speed.
    pub(super) fn parameters(&self) -> usize {
        self.terms().count()
    }

    /// Returns the line of the ratios over their level, over the speed in r/min, or their mean if there is one speed.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Undetermined`] if the runs determine no line.
    pub(super) fn over_speed(&self) -> Result<StraightLine, CalibrationError> {
        let points = self.points.iter().map(|point| (point.rpm, point.ratio, point.sigma));
        StraightLine::about_mean(points, self.terms()).ok_or(CalibrationError::Undetermined {
            what: "the displacement factor",
            why: "the runs give no line over the speed; check speeds and readings",
        })
    }

    /// Returns the line of the ratios over their level, over `x`, one for each run, or `None` if x is the same in all
    /// runs.
    pub(super) fn over(&self, x: &[f64]) -> Option<StraightLine> {
        let points = self.points.iter().zip(x).map(|(point, x)| (*x, point.ratio, point.sigma));
        StraightLine::about_mean(points, Terms { offset: true, slope: true, bend: false })
    }

    /// Returns the standard error that the scatter alone is expected to leave in the weighted mean of the runs, over
    /// that with the readings: sqrt(sum w² s² / sum w).
    pub(super) fn scatter_in_mean(&self) -> f64 {
        let (mut squares, mut weights) = (0.0, 0.0);
        for point in &self.points {
            let weight = 1.0 / (point.sigma * point.sigma);
            let scatter = hypot(point.repeatability, point.known);
            squares += weight * weight * scatter * scatter;
            weights += weight;
        }
        sqrt(squares / weights)
    }

    /// Returns the parts of the expected variance that the pump's scatter makes, and that drop and start angle make:
    /// means of the runs.
    pub(super) fn parts(&self) -> [f64; 2] {
        let count = self.points.len() as f64;
        let part = |of: fn(&Point) -> f64| {
            self.points.iter().map(|point| (of(point) / point.sigma).powi(2)).sum::<f64>() / count
        };
        [part(|point| point.repeatability), part(|point| point.known)]
    }

    /// Cruise speed of each run, in r/min, ratio over the level, and weight.
    pub(super) fn weighted(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.points.iter().map(|point| (point.rpm, point.ratio, 1.0 / (point.sigma * point.sigma)))
    }

    /// Cruise speed of each run, in rad/s, negative in reverse.
    pub(super) fn speeds_rad_s(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| point.speed_rad_s)
    }

    /// Returns the departures of the ratios from a line over the speed.
    pub(super) fn departures_from_line(&self, line: &StraightLine) -> Departures {
        self.departures(self.points.iter().map(|point| line.at(point.rpm)))
    }

    /// Returns the departures of the ratios from fitted values, one for each run.
    pub(super) fn departures(&self, fitted: impl Iterator<Item = f64>) -> Departures {
        let distance = |point: &Point, speed_rpm: &f64| (point.rpm - speed_rpm).abs();
        let mut by_speed = vec![Vec::new(); self.speeds_rpm.len()];
        for (n, (point, fitted)) in self.points.iter().zip(fitted).enumerate() {
            let nearest = self
                .speeds_rpm
                .iter()
                .enumerate()
                .min_by(|(_, one), (_, other)| distance(point, one).total_cmp(&distance(point, other)));
            if let Some(group) = nearest.and_then(|(group, _)| by_speed.get_mut(group)) {
                let weight = 1.0 / (point.sigma * point.sigma);
                group.push(Departure { run: n + 1, residual: point.ratio - fitted, weight });
            }
        }
        Departures::new(by_speed)
    }

    fn terms(&self) -> Terms {
        Terms { offset: true, slope: self.speeds_rpm.len() > 1, bend: false }
    }
}

/// Returns the speeds that are not the same, rising. Each is the mean of its runs.
pub(super) fn distinct(speeds: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut speeds: Vec<f64> = speeds.collect();
    speeds.sort_unstable_by(f64::total_cmp);
    let groups = speeds.chunk_by(|one, next| *next <= one * (1.0 + SAME_SPEED));
    groups.map(|group| group.iter().sum::<f64>() / group.len() as f64).collect()
}
