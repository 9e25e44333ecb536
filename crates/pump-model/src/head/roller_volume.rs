//! The volume V(x) that a roller displaces while it engages, over its angle x.

use crate::error::{Allowed, ModelError, Parameter, within};
use crate::math::polynomial::{DEGREE, Polynomial};
use crate::units::{TURN_RAD, degrees, radians};

/// Largest number of pieces of a roller-volume curve.
pub const MAX_PIECES: usize = 24;

pub use super::paper::{
    ENGAGEMENT_DEG as PUBLISHED_ENGAGEMENT_DEG, ROLLER_VOLUME_ML as PUBLISHED_TOTAL_ML,
    VOLUME_COEFFICIENTS_DEG as PUBLISHED_COEFFICIENTS_DEG,
};

/// Stretch of the curve with one polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct VolumePiece {
    /// Start of the piece, rad.
    pub(crate) start_rad: f64,
    /// Volume V, mL, over x - start, rad.
    pub(crate) volume: Polynomial,
}

/// The volume of a roller that engages, from V(0) = 0 to V(phi) = V_r: a rising piecewise polynomial.
///
/// The derivative of V is g(x) = max(0, dV/dx), which makes the pulses of inlet and outlet.
///
/// ```
/// use pump_model::RollerVolume;
/// let roller = RollerVolume::measured()?;
/// assert!((roller.total_ml() - 2.105466).abs() < 1e-6);
/// assert!((roller.engagement_deg() - 50.53).abs() < 1e-12);
/// // Beyond full engagement the volume stays.
/// assert_eq!(roller.at(1.0), roller.total_ml());
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollerVolume {
    pieces: [VolumePiece; MAX_PIECES],
    count: usize,
    engagement_rad: f64,
    inset_rad: f64,
    total_ml: f64,
}

impl RollerVolume {
    /// Builds the curve from polynomial coefficients in mL over degrees, highest order first, as measured
    /// curves are published. Where the polynomial falls the volume is held (g = 0).
    ///
    /// # Errors
    ///
    /// Refuses an engagement angle outside 0 to 360 degrees, coefficients that are not finite, and a curve
    /// that does not rise.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::roller_volume::{RollerVolume, PUBLISHED_COEFFICIENTS_DEG, PUBLISHED_ENGAGEMENT_DEG};
    /// let v = RollerVolume::from_polynomial_deg(PUBLISHED_COEFFICIENTS_DEG, PUBLISHED_ENGAGEMENT_DEG)?;
    /// assert!((v.total_ml() - 2.105466).abs() < 1e-6);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn from_polynomial_deg(highest_first: [f64; 6], engagement_deg: f64) -> Result<Self, ModelError> {
        within(Parameter::EngagementAngle, engagement_deg, Allowed::POSITIVE)?;
        within(Parameter::EngagementAngle, engagement_deg, 0.0..360.0)?;
        for value in highest_first {
            within(Parameter::RollerVolumeCoefficient, value, Allowed::FINITE)?;
        }
        let curve = Self::of_valid(highest_first, engagement_deg);
        if curve.total_ml > 0.0 { Ok(curve) } else { Err(ModelError::RollerVolumeFlat { engagement_deg }) }
    }

    /// Builds the curve of [`Self::from_polynomial_deg`] from coefficients that are known to be valid.
    pub(crate) fn of_valid(highest_first: [f64; 6], engagement_deg: f64) -> Self {
        let mut c = highest_first;
        c.reverse();
        let volume = Polynomial { c }.stretched(360.0 / TURN_RAD);
        let engagement_rad = radians(engagement_deg);

        let mut curve = Self::empty(engagement_rad, 0.0);
        let slope = volume.derivative();
        let turns = slope.roots_in(0.0, engagement_rad);
        let mut start = 0.0;
        for &end in turns.as_slice().iter().chain(core::iter::once(&engagement_rad)) {
            if end > start {
                let rises = slope.at(0.5 * (start + end)) > 0.0;
                // A quintic turns four times at most, and there is a place for each of its five pieces.
                curve.push(start, end, rises.then(|| volume.shifted(start)));
            }
            start = end;
        }
        curve
    }

    /// Returns a curve without a piece, which [`Self::append`] completes.
    pub(crate) fn empty(engagement_rad: f64, inset_rad: f64) -> Self {
        Self {
            pieces: [VolumePiece::default(); MAX_PIECES],
            count: 0,
            engagement_rad,
            inset_rad,
            total_ml: 0.0,
        }
    }

    /// Returns the curve that McIntyre et al. measured.
    ///
    /// # Errors
    ///
    /// Never fails: the published coefficients are valid. The result is that of
    /// [`Self::from_polynomial_deg`].
    pub fn measured() -> Result<Self, ModelError> {
        Self::from_polynomial_deg(PUBLISHED_COEFFICIENTS_DEG, PUBLISHED_ENGAGEMENT_DEG)
    }

    /// Builds a curve from pieces that were computed before: start, rad, and coefficients of V, mL, lowest
    /// order first. Returns none if there are no pieces, more than [`MAX_PIECES`] of them, a value that is
    /// not finite, or pieces out of order.
    pub(crate) const fn of_pieces(
        engagement_rad: f64,
        inset_rad: f64,
        total_ml: f64,
        pieces: &[(f64, [f64; DEGREE + 1])],
    ) -> Option<Self> {
        const UNUSED: VolumePiece =
            VolumePiece { start_rad: 0.0, volume: Polynomial { c: [0.0; DEGREE + 1] } };
        let mut places = [UNUSED; MAX_PIECES];
        let mut count = 0;
        let mut least_rad = 0.0;
        let engages = engagement_rad > 0.0 && engagement_rad < TURN_RAD && inset_rad.is_finite();
        let is_positive = total_ml > 0.0 && total_ml.is_finite();
        if pieces.is_empty() || pieces.len() > MAX_PIECES || !(engages && is_positive) {
            return None;
        }
        while count < MAX_PIECES && count < pieces.len() {
            let (start_rad, c) = pieces[count];
            let volume = Polynomial { c };
            if !(start_rad >= least_rad && start_rad <= engagement_rad && volume.is_finite()) {
                return None;
            }
            places[count] = VolumePiece { start_rad, volume };
            least_rad = start_rad;
            count += 1;
        }
        Some(Self { pieces: places, count, engagement_rad, inset_rad, total_ml })
    }

    /// Returns this curve's shape with another total volume, mL.
    ///
    /// # Errors
    ///
    /// Refuses a total that is not finite and positive.
    pub fn scaled_to(&self, total_ml: f64) -> Result<Self, ModelError> {
        within(Parameter::RollerVolume, total_ml, Allowed::POSITIVE)?;
        Ok(Self { total_ml, ..self.scaled(total_ml / self.total_ml) })
    }

    /// Returns this curve's shape with every volume times `factor`, which must be positive.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut scaled = *self;
        for piece in &mut scaled.pieces {
            piece.volume = piece.volume.scaled(factor);
        }
        scaled.total_ml *= factor;
        scaled
    }

    /// Returns this curve's shape and total over another engagement angle, degrees.
    ///
    /// # Errors
    ///
    /// Refuses an angle that is not finite and positive.
    pub fn stretched_to(&self, engagement_deg: f64) -> Result<Self, ModelError> {
        within(Parameter::EngagementAngle, engagement_deg, Allowed::POSITIVE)?;
        let engagement_rad = radians(engagement_deg);
        let factor = engagement_rad / self.engagement_rad;
        let mut stretched = Self { engagement_rad, ..*self };
        for piece in &mut stretched.pieces {
            piece.start_rad *= factor;
            piece.volume = piece.volume.stretched(1.0 / factor);
        }
        Ok(stretched)
    }

    /// Returns the engagement angle phi, rad.
    pub fn engagement_rad(&self) -> f64 {
        self.engagement_rad
    }

    /// Returns the engagement angle phi, degrees.
    pub fn engagement_deg(&self) -> f64 {
        degrees(self.engagement_rad)
    }

    /// Returns the angle inside the backplate's arc at which a roller is fully engaged, rad.
    ///
    /// It is phi - eta_c if the engagement is drawn. It is 0 if the engagement is measured: then the arc's
    /// end is taken for the end of the engagement (McIntyre et al.).
    pub fn inset_rad(&self) -> f64 {
        self.inset_rad
    }

    /// Returns the roller volume V_r = V(phi), mL.
    pub fn total_ml(&self) -> f64 {
        self.total_ml
    }

    /// Returns the volume V(x), mL; 0 below 0 and V_r beyond phi.
    pub fn at(&self, x_rad: f64) -> f64 {
        if x_rad <= 0.0 {
            0.0
        } else if x_rad >= self.engagement_rad {
            self.total_ml
        } else {
            let piece = self.piece_at(x_rad);
            piece.volume.at(x_rad - piece.start_rad)
        }
    }

    /// Returns the pulse g(x) = dV/dx, mL/rad; 0 outside 0 to phi.
    ///
    /// ```
    /// let roller = pump_model::RollerVolume::measured()?;
    /// let (x, h) = (0.5, 1e-6);
    /// let rise_ml_rad = (roller.at(x + h) - roller.at(x - h)) / (2.0 * h);
    /// assert!((roller.slope_ml_rad(x) - rise_ml_rad).abs() < 1e-8);
    /// assert_eq!(roller.slope_ml_rad(-0.1), 0.0);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn slope_ml_rad(&self, x_rad: f64) -> f64 {
        if !(0.0..=self.engagement_rad).contains(&x_rad) {
            return 0.0;
        }
        let piece = self.piece_at(x_rad);
        piece.volume.derivative().at(x_rad - piece.start_rad)
    }

    /// Returns the stretches over which the volume is held, rad: from, to.
    pub fn held_rad(&self) -> impl Iterator<Item = (f64, f64)> {
        let ends = self.pieces().iter().skip(1).map(|next| next.start_rad).chain([self.engagement_rad]);
        let held = |piece: &VolumePiece| piece.volume.c.iter().skip(1).all(|c| *c == 0.0);
        self.pieces()
            .iter()
            .zip(ends)
            .filter(move |(piece, _)| held(piece))
            .map(|(piece, end)| (piece.start_rad, end))
    }

    pub(crate) fn pieces(&self) -> &[VolumePiece] {
        self.pieces.get(..self.count).unwrap_or(&self.pieces)
    }

    /// Returns the piece that contains `x_rad`, which must lie in [0, phi].
    pub(crate) fn piece_at(&self, x_rad: f64) -> VolumePiece {
        self.pieces().iter().rev().find(|piece| piece.start_rad <= x_rad).copied().unwrap_or_default()
    }

    /// Appends the stretch [start, end] and returns true if there was a place. `local` is V over x - start,
    /// rad, up to a constant; none if the volume is held.
    pub(crate) fn push(&mut self, start: f64, end: f64, local: Option<Polynomial>) -> bool {
        let mut local = local.unwrap_or_default();
        local.c[0] = self.total_ml;
        let Some(piece) = self.pieces.get_mut(self.count) else {
            return false;
        };
        *piece = VolumePiece { start_rad: start, volume: local };
        self.count += 1;
        self.total_ml = local.at(end - start);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_curve_passes_the_measured_points_within_its_residual() {
        let curve = RollerVolume::measured().unwrap();
        // Value of the polynomial at its minimum (0.567 deg), where the curve starts to rise from 0.
        const OFFSET_ML: f64 = -0.001_182_011;
        let measured = crate::head::paper::VOLUME_POINTS;
        let square: f64 = measured
            .iter()
            .map(|&(deg, ml)| {
                let error = curve.at(radians(deg)) + OFFSET_ML - ml;
                error * error
            })
            .sum();
        let rms = libm::sqrt(square / measured.len() as f64);
        assert!((0.007..0.0078).contains(&rms), "RMS {rms} mL");
    }

    #[test]
    fn volume_rises_and_is_flat_where_the_polynomial_falls() {
        let curve = RollerVolume::measured().unwrap();
        assert_eq!(curve.at(radians(0.5)), 0.0);
        assert!(curve.at(radians(0.6)) > 0.0);
        let mut last = 0.0;
        for n in 0..=5053 {
            let volume = curve.at(radians(f64::from(n) * 0.01));
            assert!(volume >= last, "falls at {n}");
            last = volume;
        }
        assert_eq!(curve.at(9.0), curve.total_ml());
    }

    #[test]
    fn a_stretched_curve_has_at_the_stretched_angle_what_it_had_before() {
        let curve = RollerVolume::measured().unwrap();
        let stretched = curve.stretched_to(1.1 * curve.engagement_deg()).unwrap();
        for deg in [0.3, 5.0, 20.0, 50.0, 50.53, 70.0] {
            assert!((stretched.at(radians(1.1 * deg)) - curve.at(radians(deg))).abs() < 1e-12, "{deg}");
        }
        assert_eq!(stretched.total_ml(), curve.total_ml());
        assert!(curve.stretched_to(0.0).is_err());
    }

    #[test]
    fn flat_or_absurd_curves_are_refused() {
        assert!(matches!(
            RollerVolume::from_polynomial_deg([0.0; 6], 50.0),
            Err(ModelError::RollerVolumeFlat { .. })
        ));
        assert!(RollerVolume::from_polynomial_deg(PUBLISHED_COEFFICIENTS_DEG, f64::NAN).is_err());
        assert!(RollerVolume::from_polynomial_deg([f64::INFINITY; 6], 50.0).is_err());
    }
}
