//! Volumes of turns whose start is only known to lie in an interval.

use crate::math::polynomial::Polynomial;

use super::flow_curve::FlowCurve;

impl FlowCurve {
    /// Returns the smallest and largest volume of a turn by `turn_rad` from an uncertain start, mL.
    ///
    /// The turn is negative in reverse. It starts anywhere within `half_width_rad` (not negative) of
    /// `start_rad`; half a pitch and more is any angle.
    ///
    /// The result is exact up to rounding. Between the edges that start and end meet, the volume is one
    /// polynomial of the start angle. Its extremes lie where the flow at the end equals that at the start, or
    /// at the stretch's ends.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// let (least_ml, most_ml) = curve.turn_range_ml(0.0, 0.5 * curve.pitch_rad(), 0.6283);
    /// assert!((least_ml - 0.8276).abs() < 1e-4 && (most_ml - 2.7634).abs() < 1e-4);
    /// // Whole pitches deliver the same from anywhere.
    /// let (least_ml, most_ml) = curve.turn_range_ml(0.0, 0.5 * curve.pitch_rad(), 2.0 * curve.pitch_rad());
    /// assert!(most_ml - least_ml < 1e-12 && (most_ml - 2.0 * curve.pitch_ml()).abs() < 1e-12);
    /// ```
    pub fn turn_range_ml(&self, start_rad: f64, half_width_rad: f64, turn_rad: f64) -> (f64, f64) {
        let half_width_rad = half_width_rad.min(0.5 * self.pitch_rad());
        // Angles count from the start's own pitch, so whole pitches are as exact far from angle 0 as near it.
        let (_, local_rad) = self.split(start_rad - half_width_rad);
        let mut start = CurvePlace::at(self, (0.0, local_rad));
        let mut end = CurvePlace::at(self, self.split(local_rad + turn_rad));
        let mut left_rad = 2.0 * half_width_rad;
        let (mut least_ml, mut most_ml) = (f64::INFINITY, f64::NEG_INFINITY);
        // Within a pitch each place leaves every piece once, and the piece where it began perhaps twice.
        for _ in 0..2 * self.pieces().len() + 3 {
            let length_rad = left_rad.min(start.left_rad).min(end.left_rad);
            let volume = end.volume(self).plus(&start.volume(self).scaled(-1.0));
            let ((_, smallest_ml), (_, largest_ml)) = volume.range_in(0.0, length_rad);
            least_ml = least_ml.min(smallest_ml);
            most_ml = most_ml.max(largest_ml);
            left_rad -= length_rad;
            if left_rad <= 0.0 {
                break;
            }
            start.go(self, length_rad);
            end.go(self, length_rad);
        }
        (least_ml, most_ml)
    }
}

/// Place on the curve. It goes from piece to piece by count, so rounding at an edge decides nothing.
struct CurvePlace {
    pitches: f64,
    piece: usize,
    /// Angle left to the piece's end, rad.
    left_rad: f64,
}

impl CurvePlace {
    fn at(curve: &FlowCurve, (pitches, local_rad): (f64, f64)) -> Self {
        let number = curve.index_of(local_rad);
        let piece = curve.piece(number);
        let left_rad = (piece.start_rad + piece.length_rad - local_rad).max(0.0);
        Self { pitches, piece: number, left_rad }
    }

    /// Returns the volume since the start of pitch 0, mL, over the angle since this place, rad.
    fn volume(&self, curve: &FlowCurve) -> Polynomial {
        let piece = curve.piece(self.piece);
        let mut volume = piece.volume.shifted(piece.length_rad - self.left_rad);
        volume.c[0] += self.pitches * curve.pitch_ml();
        volume
    }

    /// Goes on by `angle_rad`, at most to the end of the piece, and then over to the next piece.
    fn go(&mut self, curve: &FlowCurve, angle_rad: f64) {
        self.left_rad -= angle_rad;
        if self.left_rad <= 0.0 {
            self.piece += 1;
            if self.piece >= curve.pieces().len() {
                self.piece = 0;
                self.pitches += 1.0;
            }
            self.left_rad = curve.piece(self.piece).length_rad;
        }
    }
}
