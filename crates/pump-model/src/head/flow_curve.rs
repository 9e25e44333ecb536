//! Flow per radian of one port and its exact integral over the angle.

use libm::floor;

use core::ops::Range;

use crate::math::polynomial::{DEGREE, Polynomial};
use crate::units::TURN_RAD;

use super::geometry::Geometry;
use super::pulses::{Pulses, SAME_EDGE_RAD};
use super::roller_volume::{self, RollerVolume};
use crate::port::Port;

/// Largest number of pieces. Every edge of the roller volume appears once in a pitch; the pitch's start and
/// the end of the last piece add to them.
const MAX_PIECES: usize = roller_volume::MAX_PIECES + 3;

/// A stretch of the curve between two edges.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FlowPiece {
    /// Start of the piece within the pitch, rad.
    pub(crate) start_rad: f64,
    /// Length of the piece, rad.
    pub(crate) length_rad: f64,
    /// Volume since the start of the pitch, mL, over angle - start, rad.
    pub(crate) volume: Polynomial,
    /// Flow per radian, mL/rad: the derivative of `volume`.
    pub(crate) flow: Polynomial,
}

/// Flow per radian q(theta), mL/rad, and volume V(theta), mL, of one port: periodic pieces with closed-form
/// integrals.
///
/// Outlet: q(theta) = a - sum_k g(phi - (theta - k pitch)). Inlet: q(theta) = a - sum_k g(theta - psi - k
/// pitch). Both follow McIntyre et al.; g is the slope of the [`RollerVolume`]. Pulses that overlap add. V is
/// single-valued in theta: a motor in reverse runs back along the same curve.
///
/// Where rollers leave that take more than the bore delivers, q is negative and V falls
/// ([`Self::reverses`]). A volume then has several angles ([`Self::reaches`]).
///
/// ```
/// let pump = pump_model::Pump::three_roller();
/// let curve = pump.outlet_curve();
/// assert!((curve.pitch_ml() - 7.1062).abs() < 1e-4);
/// let angle_rad = curve.angle_rad(10.0);
/// assert!((curve.volume_ml(angle_rad) - 10.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowCurve {
    pieces: [FlowPiece; MAX_PIECES],
    count: usize,
    pitch_rad: f64,
    /// Reciprocal of the pitch, 1/rad.
    per_pitch: f64,
    pitch_ml: f64,
    /// True if the flow is not positive at some angle.
    reverses: bool,
}

impl FlowCurve {
    /// Builds the curve of a validated geometry. The caller still has to look at the volume of the pitch.
    pub(crate) fn new(geometry: &Geometry, roller: &RollerVolume, port: Port) -> Self {
        Self::of_pulses(
            geometry.pitch_rad(),
            geometry.nominal_ml_rad(),
            geometry.psi_rad(roller),
            roller,
            port,
        )
    }

    /// Builds the curve of rollers `pitch_rad` apart, between whose pulses `nominal` mL/rad flow. The inlet's pulse
    /// begins `psi` behind that of the outlet.
    pub(crate) fn of_pulses(
        pitch_rad: f64,
        nominal: f64,
        psi: f64,
        roller: &RollerVolume,
        port: Port,
    ) -> Self {
        let phi = roller.engagement_rad();
        let pulses = Pulses { roller, port, phi, psi, pitch_rad };

        let mut curve = Self {
            pieces: [FlowPiece::default(); MAX_PIECES],
            count: 0,
            pitch_rad,
            per_pitch: 1.0 / pitch_rad,
            pitch_ml: 0.0,
            reverses: false,
        };
        let mut start_rad = 0.0;
        while start_rad < pitch_rad {
            let end_rad = pulses.edge_after(start_rad);
            let length_rad = end_rad - start_rad;
            let mut volume = Polynomial { c: [0.0, nominal, 0.0, 0.0, 0.0, 0.0] };
            volume = volume.plus(&pulses.displaced(start_rad, length_rad).scaled(-1.0));
            volume.c[0] = curve.pitch_ml;
            curve.push(FlowPiece { start_rad, length_rad, volume, flow: volume.derivative() });
            curve.pitch_ml = volume.at(length_rad);
            start_rad = end_rad;
        }
        curve.reverses = curve.pieces().iter().any(|piece| !piece.flow.is_positive_to(piece.length_rad));
        curve
    }

    /// Builds a curve from pieces that were computed before: start and length within the pitch, rad, and
    /// coefficients of the volume, mL, lowest order first. Returns none if there are no pieces, more than
    /// [`MAX_PIECES`] of them, a value that is not finite, or pieces out of order.
    pub(crate) const fn of_pieces(
        pitch_rad: f64,
        pitch_ml: f64,
        pieces: &[(f64, f64, [f64; DEGREE + 1])],
    ) -> Option<Self> {
        const NONE: Polynomial = Polynomial { c: [0.0; DEGREE + 1] };
        const UNUSED: FlowPiece = FlowPiece { start_rad: 0.0, length_rad: 0.0, volume: NONE, flow: NONE };
        let mut places = [UNUSED; MAX_PIECES];
        let mut count = 0;
        let mut next_rad = 0.0;
        let mut reverses = false;
        let is_positive = pitch_rad > 0.0 && pitch_rad <= TURN_RAD && pitch_ml > 0.0 && pitch_ml.is_finite();
        if pieces.is_empty() || pieces.len() > MAX_PIECES || !is_positive {
            return None;
        }
        while count < MAX_PIECES && count < pieces.len() {
            let (start_rad, length_rad, c) = pieces[count];
            let follows = start_rad >= next_rad - SAME_EDGE_RAD && start_rad <= next_rad + SAME_EDGE_RAD;
            let volume = Polynomial { c };
            if !(follows && length_rad > 0.0 && volume.is_finite()) {
                return None;
            }
            let flow = volume.derivative();
            places[count] = FlowPiece { start_rad, length_rad, volume, flow };
            reverses = reverses || !flow.is_positive_to(length_rad);
            next_rad = start_rad + length_rad;
            count += 1;
        }
        let is_whole = next_rad >= pitch_rad - SAME_EDGE_RAD && next_rad <= pitch_rad + SAME_EDGE_RAD;
        if !is_whole {
            return None;
        }
        Some(Self { pieces: places, count, pitch_rad, per_pitch: 1.0 / pitch_rad, pitch_ml, reverses })
    }

    /// Returns this curve with flow and volume times `factor`, which must be positive.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut scaled = *self;
        for piece in &mut scaled.pieces {
            piece.volume = piece.volume.scaled(factor);
            piece.flow = piece.flow.scaled(factor);
        }
        scaled.pitch_ml *= factor;
        scaled
    }

    /// Returns this curve counted from another zero: its value at an angle is that of this curve at the
    /// angle + `zero_rad`.
    ///
    /// `zero_rad` must be finite. Returns none if there is no room for the piece that the new zero cuts in
    /// two.
    pub(crate) fn shifted(&self, zero_rad: f64) -> Option<Self> {
        let (_, first_rad) = self.split(zero_rad);
        let cut = self.index_of(first_rad);
        let mut shifted =
            Self { pieces: [FlowPiece::default(); MAX_PIECES], count: 0, pitch_ml: 0.0, ..*self };
        let mut rest_rad = self.pitch_rad;
        // The piece at the new zero comes first, from the zero on, and again last, up to the zero.
        for (number, piece) in self.pieces().iter().enumerate().cycle().skip(cut).take(self.count + 1) {
            let first = shifted.count == 0;
            let skipped_rad = if first && number == cut { first_rad - piece.start_rad } else { 0.0 };
            let length_rad = (piece.length_rad - skipped_rad).min(rest_rad);
            if length_rad < SAME_EDGE_RAD {
                continue;
            }
            if shifted.count == MAX_PIECES {
                return None;
            }
            let mut volume = piece.volume.shifted(skipped_rad);
            volume.c[0] = shifted.pitch_ml;
            let start_rad = self.pitch_rad - rest_rad;
            shifted.push(FlowPiece { start_rad, length_rad, volume, flow: volume.derivative() });
            shifted.pitch_ml = volume.at(length_rad);
            rest_rad -= length_rad;
        }
        // A pitch has one volume, wherever it begins.
        shifted.pitch_ml = self.pitch_ml;
        Some(shifted)
    }

    /// Appends a piece. A piece that continues the same constant flow makes the last one longer.
    fn push(&mut self, piece: FlowPiece) {
        let is_constant = piece.flow.c.iter().skip(1).all(|c| *c == 0.0);
        match self.count.checked_sub(1).and_then(|last| self.pieces.get_mut(last)) {
            Some(last) if is_constant && last.flow == piece.flow => last.length_rad += piece.length_rad,
            _ => {
                // There are as many places as edges.
                if let Some(place) = self.pieces.get_mut(self.count) {
                    *place = piece;
                    self.count += 1;
                }
            }
        }
    }

    /// Returns the angle between rollers, rad: the period of the flow.
    pub fn pitch_rad(&self) -> f64 {
        self.pitch_rad
    }

    /// Returns the volume of a pitch, mL.
    pub fn pitch_ml(&self) -> f64 {
        self.pitch_ml
    }

    /// Returns the flow per radian at `angle_rad`, mL/rad. At an edge this is the value just after it.
    pub fn flow_ml_rad(&self, angle_rad: f64) -> f64 {
        let (_, local_rad) = self.split(angle_rad);
        let piece = self.piece_at(local_rad);
        piece.flow.at(local_rad - piece.start_rad)
    }

    /// Returns true if the flow is not positive at some angle, so that the volume falls there or stays.
    ///
    /// Heads with narrow bores, thick walls and many rollers take more at a roller's exit than the bore
    /// delivers.
    pub fn reverses(&self) -> bool {
        self.reverses
    }

    /// Returns the largest flow per radian in either direction over a pitch, mL/rad.
    pub fn largest_flow_ml_rad(&self) -> f64 {
        let (low, high) = self.flow_range_ml_rad();
        high.max(-low)
    }

    /// Returns the speed that makes `flow_ml_s` while the rollers stand at `angle_rad`, rad/s, negative for a
    /// flow in reverse: flow over flow per radian. It follows a flow that changes all the time.
    ///
    /// Where the flow of a head reverses, no forward speed makes a positive flow: the speed has the other sign
    /// there, and it grows without bound where the flow changes its sign.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// // Where a roller leaves the outlet, the rotor must turn faster.
    /// let [least, most] = [0.2, 1.2].map(|angle_rad| curve.speed_for_flow(5.0, angle_rad));
    /// assert!((most * curve.flow_ml_rad(1.2) - 5.0).abs() < 1e-12 && least > most);
    /// ```
    pub fn speed_for_flow(&self, flow_ml_s: f64, angle_rad: f64) -> f64 {
        flow_ml_s / self.flow_ml_rad(angle_rad)
    }

    /// Returns the volume from angle 0 to `angle_rad`, mL; negative below 0. It is exact up to rounding.
    pub fn volume_ml(&self, angle_rad: f64) -> f64 {
        let (pitches, local_rad) = self.split(angle_rad);
        let piece = self.piece_at(local_rad);
        pitches * self.pitch_ml + piece.volume.at(local_rad - piece.start_rad)
    }

    /// Returns the angle at which the volume since angle 0 is `volume_ml`, rad: the inverse of
    /// [`Self::volume_ml`].
    ///
    /// On a head whose flow reverses it is the first such angle on the way from angle 0.
    pub fn angle_rad(&self, volume_ml: f64) -> f64 {
        if self.reverses {
            return self.reaches(0.0, volume_ml, 0.0).next().map_or(0.0, |reach| reach.angle_rad);
        }
        let pitches = floor(volume_ml / self.pitch_ml);
        let local = volume_ml - pitches * self.pitch_ml;
        let piece = self.pieces().iter().rev().find(|piece| piece.volume.c[0] <= local);
        let piece = piece.unwrap_or(self.piece(0));
        pitches * self.pitch_rad + piece.start_rad + piece.volume.solve_monotone(local, 0.0, piece.length_rad)
    }

    /// Returns the smallest and largest flow per radian over a pitch, mL/rad.
    pub fn flow_range_ml_rad(&self) -> (f64, f64) {
        self.pieces().iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), piece| {
            let (smallest, largest) = piece.flow.range_in(0.0, piece.length_rad);
            (low.min(smallest.1), high.max(largest.1))
        })
    }

    /// Returns the part of a pitch in which rollers take from the flow: its start and its length, rad.
    ///
    /// Elsewhere the flow is constant, at its largest. Where pulses leave no gap, the part is the whole
    /// pitch.
    pub fn uneven_part(&self) -> (f64, f64) {
        let largest = self.flow_range_ml_rad().1;
        let is_even = |piece: &&FlowPiece| {
            let [c0, rest @ ..] = piece.flow.c;
            // The flow of the bare tube is a sum that may round.
            rest.iter().all(|c| *c == 0.0) && c0 >= largest * (1.0 - 1e-12)
        };
        let (mut from_rad, mut length_rad) = (0.0, 0.0);
        let mut longest = (0.0, 0.0);
        // The loop goes round twice: a shifted curve has its even part partly at the end of the pitch and
        // partly at its start.
        for piece in self.pieces().iter().chain(self.pieces()) {
            if !is_even(&piece) {
                length_rad = 0.0;
                continue;
            }
            if length_rad == 0.0 {
                from_rad = piece.start_rad;
            }
            length_rad = (length_rad + piece.length_rad).min(self.pitch_rad);
            if length_rad > longest.1 {
                longest = (from_rad, length_rad);
            }
        }
        let (from_rad, length_rad) = longest;
        if length_rad == 0.0 {
            return (0.0, self.pitch_rad);
        }
        let start_rad = from_rad + length_rad;
        let start_rad = if start_rad >= self.pitch_rad { start_rad - self.pitch_rad } else { start_rad };
        let start_rad = if self.pitch_rad - start_rad < SAME_EDGE_RAD { 0.0 } else { start_rad };
        (start_rad, self.pitch_rad - length_rad)
    }

    pub(crate) fn pieces(&self) -> &[FlowPiece] {
        self.pieces.get(..self.count).unwrap_or(&self.pieces)
    }

    /// Returns a piece by its number, which must be less than the number of pieces.
    pub(crate) fn piece(&self, number: usize) -> &FlowPiece {
        let [first, ..] = &self.pieces;
        self.pieces().get(number).unwrap_or(first)
    }

    /// Returns flow per radian, mL/rad, and volume, mL, at an angle given as whole pitches and the rest.
    pub(crate) fn flow_and_volume_at(&self, (pitches, local_rad): (f64, f64)) -> (f64, f64) {
        let piece = self.piece_at(local_rad);
        let u = local_rad - piece.start_rad;
        (piece.flow.at(u), pitches * self.pitch_ml + piece.volume.at(u))
    }

    /// Returns the piece at an angle of this pitch and its end within the pitch, rad.
    pub(crate) fn piece_to_its_end(&self, local_rad: f64) -> (&FlowPiece, f64) {
        let piece = self.piece_at(local_rad);
        let next = self.pieces().iter().find(|next| next.start_rad > piece.start_rad);
        (piece, next.map_or(self.pitch_rad, |next| next.start_rad))
    }

    /// True if [`Self::split`] finds `pitches` whole pitches and a rest within `local_rad`, a part of the
    /// pitch. On a seam, where the split may have to correct its rounding, this is false.
    #[inline]
    pub(crate) fn is_within(&self, angle_rad: f64, pitches: f64, local_rad: &Range<f64>) -> bool {
        let turned = angle_rad * self.per_pitch;
        let whole = pitches <= turned && turned < pitches + 1.0;
        whole && local_rad.contains(&(angle_rad - pitches * self.pitch_rad))
    }

    /// Splits an angle into whole pitches and the angle within the pitch.
    pub(crate) fn split(&self, angle_rad: f64) -> (f64, f64) {
        let pitches = floor(angle_rad * self.per_pitch);
        let local_rad = angle_rad - pitches * self.pitch_rad;
        // The product may round over a whole number that the quotient would not.
        if local_rad >= self.pitch_rad {
            (pitches + 1.0, local_rad - self.pitch_rad)
        } else if local_rad < 0.0 {
            (pitches - 1.0, local_rad + self.pitch_rad)
        } else {
            (pitches, local_rad)
        }
    }

    /// Returns the piece that contains an angle of this pitch: the last that starts there or before.
    fn piece_at(&self, local_rad: f64) -> &FlowPiece {
        let [first, ..] = &self.pieces;
        let later = self.pieces().iter().skip(1).take_while(|piece| piece.start_rad <= local_rad);
        later.last().unwrap_or(first)
    }

    /// Returns the number of the piece that contains an angle of this pitch.
    pub(crate) fn index_of(&self, local_rad: f64) -> usize {
        self.pieces().iter().rposition(|piece| piece.start_rad <= local_rad).unwrap_or(0)
    }
}
