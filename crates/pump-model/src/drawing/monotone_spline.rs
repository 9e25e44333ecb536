//! Rising cubic splines through measured points.

use crate::error::ModelError;
use crate::head::roller_volume::{MAX_PIECES, RollerVolume};
use crate::math::polynomial::Polynomial;

/// Largest number of different angles that a spline goes through.
pub(crate) const MAX_KNOTS: usize = MAX_PIECES + 1;

/// Mean of the volumes at one angle, or of neighbours that would fall.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Knot {
    pub(super) x_rad: f64,
    pub(super) volume_ml: f64,
    /// Number of points that the volume comes from.
    pub(super) weight: f64,
    /// Slope of the fit there; 0 for a mean, which has none.
    pub(super) slope_ml_rad: f64,
}

/// Knots in order of angle.
pub(crate) struct Knots {
    places: [Knot; MAX_KNOTS],
    count: usize,
}

impl Knots {
    /// Collects knots from points (rad, mL) in any order. Volumes at the same angle are averaged.
    pub(crate) fn of(points: impl Iterator<Item = (f64, f64)>) -> Result<Self, ModelError> {
        let mut knots = Self { places: [Knot::default(); MAX_KNOTS], count: 0 };
        for (x_rad, volume_ml) in points {
            let number = knots.as_slice().iter().take_while(|knot| knot.x_rad < x_rad).count();
            let used = knots.count;
            let behind = knots.places.get_mut(number..).unwrap_or_default();
            match behind.first_mut() {
                Some(knot) if number < used && knot.x_rad == x_rad => {
                    knot.weight += 1.0;
                    knot.volume_ml += (volume_ml - knot.volume_ml) / knot.weight;
                }
                _ if used == MAX_KNOTS => return Err(ModelError::TooManyPieces { allowed: MAX_PIECES }),
                _ => {
                    behind.rotate_right(1);
                    if let Some(place) = behind.first_mut() {
                        *place = Knot { x_rad, volume_ml, weight: 1.0, slope_ml_rad: 0.0 };
                    }
                    knots.count += 1;
                }
            }
        }
        Ok(knots)
    }

    /// Collects the knots of a fit, in order of angle.
    pub(super) fn fitted(fitted: impl Iterator<Item = Knot>) -> Self {
        let mut knots = Self { places: [Knot::default(); MAX_KNOTS], count: 0 };
        for (place, knot) in knots.places.iter_mut().zip(fitted) {
            *place = knot;
            knots.count += 1;
        }
        knots
    }

    fn as_slice(&self) -> &[Knot] {
        self.places.get(..self.count).unwrap_or(&self.places)
    }

    /// Returns the neighbours between which the volume falls: both angles, rad, and the fall, mL.
    pub(crate) fn into_falls(self) -> impl Iterator<Item = (f64, f64, f64)> {
        let knots = || self.places.into_iter().take(self.count);
        let pairs = knots().zip(knots().skip(1));
        pairs
            .map(|(a, b)| (a.x_rad, b.x_rad, a.volume_ml - b.volume_ml))
            .filter(|(_, _, fall_ml)| *fall_ml > 0.0)
    }

    /// Returns the spline through the knots.
    ///
    /// The cubics have the slopes of Fritsch and Butland ("A method for constructing local monotone piecewise
    /// cubic interpolants", SIAM J. Sci. Stat. Comput. 5, 1984), which neither overshoot nor swing. At both
    /// ends the slope is 0, as it is where a roller begins to touch and where it has fully engaged. The flow
    /// therefore has no jump.
    pub(crate) fn spline(mut self) -> Result<RollerVolume, ModelError> {
        pool(self.places.get_mut(..self.count).unwrap_or_default());
        self.with_slopes(butland)
    }

    /// Returns the spline of a fit, whose volume and slope at the first knot are 0, made to rise.
    pub(super) fn fitted_spline(mut self) -> Result<RollerVolume, ModelError> {
        let behind = self.places.get_mut(1..self.count).unwrap_or_default();
        pool(behind);
        behind.iter_mut().for_each(|knot| knot.volume_ml = knot.volume_ml.max(0.0));
        self.with_slopes(limited)
    }

    /// Returns the cubics through the knots, with slope 0 at both ends and `slope` of each three neighbours.
    fn with_slopes(&self, slope_at: fn(&Knot, &Knot, &Knot) -> f64) -> Result<RollerVolume, ModelError> {
        let knots = self.as_slice();
        let mut curve = RollerVolume::empty(knots.last().map_or(0.0, |knot| knot.x_rad), 0.0);
        let mut slope = 0.0;
        for (n, (from, to)) in knots.iter().zip(knots.iter().skip(1)).enumerate() {
            let next_slope = knots.get(n + 2).map_or(0.0, |next| slope_at(from, to, next));
            let length = to.x_rad - from.x_rad;
            let rise = to.volume_ml - from.volume_ml;
            let (s0, s1) = (slope * length, next_slope * length);
            let unit =
                Polynomial { c: [0.0, s0, 3.0 * rise - 2.0 * s0 - s1, s0 + s1 - 2.0 * rise, 0.0, 0.0] };
            curve.append(from.x_rad, to.x_rad, &unit.stretched(1.0 / length))?;
            slope = next_slope;
        }
        Ok(curve)
    }
}

/// Gives falling neighbours their common mean, until none falls.
///
/// The result is the rising volumes with the least sum of squared changes (isotonic regression by pooling
/// adjacent violators, Ayer et al., Ann. Math. Statist. 26, 1955).
fn pool(knots: &mut [Knot]) {
    for end in 1..knots.len() {
        // The knots up to here rise already. The new one takes along all that lie higher than the mean of
        // the rest.
        let Some((new, before)) = knots.get_mut(..=end).and_then(<[Knot]>::split_last_mut) else {
            continue;
        };
        let (mut mean_ml, mut weight, mut taken) = (new.volume_ml, new.weight, 0);
        for knot in before.iter().rev() {
            if knot.volume_ml <= mean_ml {
                break;
            }
            weight += knot.weight;
            mean_ml += (knot.volume_ml - mean_ml) * knot.weight / weight;
            taken += 1;
        }
        new.volume_ml = mean_ml;
        before.iter_mut().rev().take(taken).for_each(|knot| knot.volume_ml = mean_ml);
    }
}

/// Returns the slope of a fit at the middle of three knots, within the range in which cubics rise: 0 to three times
/// the slope on either side (Fritsch and Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 17,
/// 1980).
fn limited(before: &Knot, here: &Knot, after: &Knot) -> f64 {
    let left_slope = (here.volume_ml - before.volume_ml) / (here.x_rad - before.x_rad);
    let right_slope = (after.volume_ml - here.volume_ml) / (after.x_rad - here.x_rad);
    here.slope_ml_rad.min(3.0 * left_slope).min(3.0 * right_slope).max(0.0)
}

/// Returns the slope at the middle of three knots: a weighted harmonic mean of the slopes on both sides. It
/// is 0 where either side does not rise.
fn butland(before: &Knot, here: &Knot, after: &Knot) -> f64 {
    let (left, right) = (here.x_rad - before.x_rad, after.x_rad - here.x_rad);
    let left_slope = (here.volume_ml - before.volume_ml) / left;
    let right_slope = (after.volume_ml - here.volume_ml) / right;
    if left_slope <= 0.0 || right_slope <= 0.0 {
        return 0.0;
    }
    let (w_left, w_right) = (left + 2.0 * right, 2.0 * left + right);
    (w_left + w_right) / (w_left / left_slope + w_right / right_slope)
}
