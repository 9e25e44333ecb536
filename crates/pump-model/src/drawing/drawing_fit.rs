//! The roller volume of a drawing as a piecewise polynomial, so that the curves that follow from it stay
//! exact.

use crate::error::ModelError;
use crate::head::geometry::Geometry;
use crate::head::roller_volume::{MAX_PIECES, RollerVolume};
use crate::math::polynomial::Polynomial;

use super::drawing::Drawing;

/// Largest error of V on a piece, as a part of V_r, at which the piece is not cut further.
const TOLERANCE: f64 = 2e-6;

/// Place at which a piece is cut, as a part of its length.
///
/// V goes as x^(5/2) after first contact and has a term in x^(3/2) after the tube has closed. Pieces
/// therefore become shorter towards their starts.
const CUT: f64 = 0.3;

/// Distance below which two corners count as one, rad.
const SAME_CORNER_RAD: f64 = 1e-9;

impl RollerVolume {
    /// Builds the curve from the pump's dimensions alone, for a pump without measurements.
    ///
    /// The quintics meet [`Drawing::volume_ml`] within 2e-6 of V_r everywhere. They join in value and slope,
    /// so the flow has no jump.
    ///
    /// The slope is within 0.5 % of the flow a between the rollers, except for a quarter of a degree after
    /// the tube has closed. There the slope falls as a root does, and pieces come within 2 % of a.
    ///
    /// # Errors
    ///
    /// Refuses dimensions that [`Drawing::new`] refuses, and curves with more pieces than there are places.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::{Geometry, RollerVolume, Variant};
    /// let drawn = RollerVolume::from_drawing(&Geometry::published(3, Variant::AsBuilt))?;
    /// assert!((drawn.total_ml() - 2.1147).abs() < 1e-4);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn from_drawing(geometry: &Geometry) -> Result<Self, ModelError> {
        let drawing = Drawing::new(geometry)?;
        let engagement_rad = drawing.engagement_rad();
        let pieces = Pieces::of(&drawing, TOLERANCE * drawing.volume_ml(engagement_rad))?;
        let mut curve = Self::empty(engagement_rad, engagement_rad - drawing.contact_rad());
        for piece in pieces.as_slice() {
            curve.append(piece.start_rad, piece.end_rad, &piece.volume)?;
        }
        Ok(curve)
    }
}

/// A quintic that replaces V over an interval.
#[derive(Debug, Clone, Copy, Default)]
struct DrawnPiece {
    start_rad: f64,
    end_rad: f64,
    /// Volume V, mL, over theta - start.
    volume: Polynomial,
    /// Largest difference of the quintic from V, mL.
    error_ml: f64,
}

impl DrawnPiece {
    fn new(drawing: &Drawing, start_rad: f64, end_rad: f64) -> Self {
        let length_rad = end_rad - start_rad;
        let at = |part: f64| drawing.volume_ml(start_rad + part * length_rad);
        let slopes = [start_rad, end_rad].map(|theta| drawing.slope_ml_rad(theta) * length_rad);
        let unit = through([at(0.0), at(LOBATTO[0]), at(LOBATTO[1]), at(1.0)], slopes);
        let errors = CHECKED.map(|part| (unit.at(part) - at(part)).abs());
        Self {
            start_rad,
            end_rad,
            volume: unit.stretched(1.0 / length_rad),
            error_ml: errors.into_iter().fold(0.0, f64::max),
        }
    }
}

/// Nodes between 0 and 1 at which a quintic meets V, besides both ends. They are the inner nodes of Lobatto's
/// quadrature with four nodes, at 1/2 -+ sqrt(1/20).
const LOBATTO: [f64; 2] = [0.276_393_202_250_021, 0.723_606_797_749_979];

/// Places at which the error of a quintic is checked. They lie around the places where u²(1 - u)² times the
/// nodes' factors is largest, 0.12, 0.5 and 0.88.
const CHECKED: [f64; 8] = [0.05, 0.1, 0.15, 0.4, 0.5, 0.6, 0.85, 0.93];

/// Returns the quintic over [0, 1] with given values at 0, both [`LOBATTO`] nodes and 1, and given slopes at
/// 0 and 1.
///
/// It is the cubic through the ends plus u²(1 - u)²(A + B u), where u(1 - u) = 1/5 at the nodes.
fn through([at_0, at_first, at_second, at_1]: [f64; 4], [slope_0, slope_1]: [f64; 2]) -> Polynomial {
    let rise = at_1 - at_0;
    let cubic = Polynomial {
        c: [at_0, slope_0, 3.0 * rise - 2.0 * slope_0 - slope_1, slope_0 + slope_1 - 2.0 * rise, 0.0, 0.0],
    };
    let [first, second] = LOBATTO;
    let left_first = 25.0 * (at_first - cubic.at(first));
    let left_second = 25.0 * (at_second - cubic.at(second));
    let b = (left_second - left_first) / (second - first);
    let a = left_first - b * first;
    cubic.plus(&Polynomial { c: [0.0, 0.0, a, b - 2.0 * a, a - 2.0 * b, b] })
}

/// Pieces in order of angle, at most [`MAX_PIECES`].
struct Pieces {
    places: [DrawnPiece; MAX_PIECES],
    count: usize,
}

impl Pieces {
    /// Starts with a piece from each corner to the next, and cuts the worst until no error exceeds
    /// `allowed_ml`.
    fn of(drawing: &Drawing, allowed_ml: f64) -> Result<Self, ModelError> {
        let mut pieces = Self { places: [DrawnPiece::default(); MAX_PIECES], count: 0 };
        let mut start_rad = 0.0;
        for end_rad in drawing.corners_rad() {
            if end_rad - start_rad > SAME_CORNER_RAD {
                pieces.insert(pieces.count, DrawnPiece::new(drawing, start_rad, end_rad))?;
                start_rad = end_rad;
            }
        }
        loop {
            let all = pieces.as_slice().iter().copied().enumerate();
            let worst = all.max_by(|(_, a), (_, b)| a.error_ml.total_cmp(&b.error_ml));
            let Some((number, piece)) = worst.filter(|(_, worst)| worst.error_ml > allowed_ml) else {
                return Ok(pieces);
            };
            let cut_rad = piece.start_rad + CUT * (piece.end_rad - piece.start_rad);
            if let Some(place) = pieces.places.get_mut(number) {
                *place = DrawnPiece::new(drawing, piece.start_rad, cut_rad);
            }
            pieces.insert(number + 1, DrawnPiece::new(drawing, cut_rad, piece.end_rad))?;
        }
    }

    fn as_slice(&self) -> &[DrawnPiece] {
        self.places.get(..self.count).unwrap_or(&self.places)
    }

    /// Inserts a piece at a number and moves those behind it one place on.
    fn insert(&mut self, number: usize, piece: DrawnPiece) -> Result<(), ModelError> {
        let behind = self
            .places
            .get_mut(number..=self.count)
            .ok_or(ModelError::TooManyPieces { allowed: MAX_PIECES })?;
        behind.rotate_right(1);
        if let Some(first) = behind.first_mut() {
            *first = piece;
        }
        self.count += 1;
        Ok(())
    }
}
