//! The error of a dose at the rollers: with one constant, planned from the angle, and on a pump that differs.

use std::error::Error;

use pump_ctl::plan::Ramps;
use pump_model::Pump;
use pump_model::units::{degrees, radians};

use crate::trial::{Trial, delivered_ml};

/// Rate of the doses, mL/s. The error does not depend on it.
const RATE_ML_S: f64 = 5.0;

/// Departure of the roller volume from the paper's own mean, mL: the difference of the paper's two figures is
/// 0.045, its standard uncertainty 0.026.
const ROLLER_VOLUME_ML: f64 = 0.026;

/// Error with which an angle is read by eye, degrees.
const READ_DEG: f64 = 1.0;

/// Errors of doses of one volume, each over the start angle in degrees, in mL.
pub(crate) struct DoseError {
    /// Steps by the mean volume of a revolution alone.
    pub(crate) one_constant: Vec<(f64, f64)>,
    /// Steps planned from the start angle.
    pub(crate) planned: Vec<(f64, f64)>,
    /// Steps planned from the start angle, on a pump that departs from its file: the worst of four pumps, whose
    /// rollers hold more or less and stand before or behind the angle that was read.
    pub(crate) departing: Vec<(f64, f64)>,
}

impl DoseError {
    pub(crate) fn new(trial: &Trial, volume_ml: f64, angles: u32) -> Result<Self, Box<dyn Error>> {
        let mut errors = Self { one_constant: Vec::new(), planned: Vec::new(), departing: Vec::new() };
        let naive = trial.steps_by_one_constant(volume_ml);
        let step_rad = trial.step_rad();
        let others =
            [trial.with_roller_volume(ROLLER_VOLUME_ML)?, trial.with_roller_volume(-ROLLER_VOLUME_ML)?];
        for start_rad in trial.start_angles(angles) {
            let deg = degrees(start_rad);
            let error = |pump: &Pump, at_rad, steps| delivered_ml(pump, at_rad, steps, step_rad) - volume_ml;
            let steps = trial.plan(start_rad, volume_ml, RATE_ML_S, Ramps::Fastest)?.steps();
            errors.one_constant.push((deg, error(&trial.pump, start_rad, naive)));
            errors.planned.push((deg, error(&trial.pump, start_rad, steps)));
            let mut worst: f64 = 0.0;
            for other in &others {
                for read_deg in [-READ_DEG, READ_DEG] {
                    let found = error(other, start_rad + radians(read_deg), steps);
                    if found.abs() > worst.abs() {
                        worst = found;
                    }
                }
            }
            errors.departing.push((deg, worst));
        }
        Ok(errors)
    }
}

/// Returns the largest of the values without their signs.
pub(crate) fn largest(points: &[(f64, f64)]) -> f64 {
    points.iter().fold(0.0, |largest: f64, point| largest.max(point.1.abs()))
}

/// Returns the mean of the values.
pub(crate) fn mean(points: &[(f64, f64)]) -> f64 {
    points.iter().map(|point| point.1).sum::<f64>() / points.len() as f64
}
