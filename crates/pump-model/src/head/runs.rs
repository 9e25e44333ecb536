//! The runs of a flow curve: the stretches in which the flow has one sign, so that the volume rises or falls
//! throughout.

use crate::math::polynomial::Polynomial;

use super::flow_curve::FlowCurve;

/// A run within one piece of the curve, in the direction of the rotor.
pub(super) struct Run {
    /// Whole pitches before the run.
    pub(super) pitches: f64,
    /// Angle within the pitch at which the piece of the run starts, rad.
    piece_rad: f64,
    /// Volume of the piece since the start of the pitch, mL.
    volume: Polynomial,
    /// Place at which the rotor enters the run, as an angle since the piece's start, rad.
    enter_rad: f64,
    /// Place at which the rotor leaves the run, as an angle since the piece's start, rad.
    leave_rad: f64,
    /// True if the flow is positive in the run.
    pub(super) flows: bool,
}

/// The runs from an angle on, in one direction, without an end.
#[derive(Debug)]
pub(super) struct Runs<'a> {
    curve: &'a FlowCurve,
    forward: bool,
    pitches: f64,
    number: usize,
    place_rad: f64,
}

impl<'a> Runs<'a> {
    /// Starts at `angle_rad`, which must be finite.
    pub(super) fn new(curve: &'a FlowCurve, angle_rad: f64, forward: bool) -> Self {
        let (pitches, local_rad) = curve.split(angle_rad);
        let number = curve.index_of(local_rad);
        let place_rad = local_rad - curve.piece(number).start_rad;
        Self { curve, forward, pitches, number, place_rad }
    }

    /// Returns the whole pitches before the next run.
    pub(super) fn pitches(&self) -> f64 {
        self.pitches
    }

    /// Goes over to the first run of another pitch, that is the last one in reverse.
    pub(super) fn skip_to(&mut self, pitches: f64) {
        self.pitches = pitches;
        self.number = if self.forward { 0 } else { self.curve.pieces().len().saturating_sub(1) };
        self.place_rad = if self.forward { 0.0 } else { self.curve.piece(self.number).length_rad };
    }

    /// Goes over to the next piece if the rotor has passed this one.
    fn enter_piece(&mut self) {
        let last = self.curve.pieces().len().saturating_sub(1);
        if self.forward && self.place_rad >= self.curve.piece(self.number).length_rad {
            (self.number, self.place_rad) = (self.number + 1, 0.0);
            if self.number > last {
                self.skip_to(self.pitches + 1.0);
            }
        } else if !self.forward && self.place_rad <= 0.0 {
            match self.number.checked_sub(1) {
                Some(before) => {
                    self.number = before;
                    self.place_rad = self.curve.piece(before).length_rad;
                }
                None => self.skip_to(self.pitches - 1.0),
            }
        }
    }

    /// Returns the next run, and goes to its end.
    #[cold]
    #[inline(never)]
    pub(super) fn next(&mut self) -> Run {
        self.enter_piece();
        let piece = self.curve.piece(self.number);
        let enter_rad = self.place_rad;
        let turns = piece.flow.roots_in(0.0, piece.length_rad);
        let turns = turns.as_slice().iter().copied();
        let leave_rad = if self.forward {
            turns.filter(|turn| *turn > enter_rad).fold(piece.length_rad, f64::min)
        } else {
            turns.filter(|turn| *turn < enter_rad).fold(0.0, f64::max)
        };
        self.place_rad = leave_rad;
        Run {
            pitches: self.pitches,
            piece_rad: piece.start_rad,
            volume: piece.volume,
            enter_rad,
            leave_rad,
            flows: piece.flow.at(0.5 * (enter_rad + leave_rad)) > 0.0,
        }
    }
}

impl Run {
    fn angle_rad(&self, curve: &FlowCurve, place_rad: f64) -> f64 {
        self.pitches * curve.pitch_rad() + self.piece_rad + place_rad
    }

    /// Returns the angle at which the rotor enters the run, rad.
    pub(super) fn enter_rad(&self, curve: &FlowCurve) -> f64 {
        self.angle_rad(curve, self.enter_rad)
    }

    /// Returns the angle at which the rotor leaves the run, rad.
    pub(super) fn leave_rad(&self, curve: &FlowCurve) -> f64 {
        self.angle_rad(curve, self.leave_rad)
    }

    /// Returns the volumes since the start of the run's pitch where the rotor enters and leaves the run, mL.
    pub(super) fn ends_ml(&self) -> [f64; 2] {
        [self.enter_rad, self.leave_rad].map(|place_rad| self.volume.at(place_rad))
    }

    /// Returns the angle in the run at which the volume since the start of its pitch is `local_ml`, rad.
    pub(super) fn angle_of(&self, curve: &FlowCurve, local_ml: f64) -> f64 {
        let (low, high) = (self.enter_rad.min(self.leave_rad), self.enter_rad.max(self.leave_rad));
        self.angle_rad(curve, self.volume.solve_monotone(local_ml, low, high))
    }
}
