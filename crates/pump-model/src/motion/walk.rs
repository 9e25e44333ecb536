//! Passages of a motion from one piece of a pitch to the next.

use libm::floor;

use super::leg::Leg;

/// Pitch that is cut into pieces, from 0 on and without gaps.
pub(crate) trait Pitch {
    /// Returns the angle after which the pieces repeat, rad.
    fn pitch_rad(&self) -> f64;
    /// Returns the number of the last piece; the first is 0.
    fn last(&self) -> usize;
    /// Returns the number of the piece at an angle of the pitch, rad.
    fn index_of(&self, local_rad: f64) -> usize;
    /// Returns the start of a piece within the pitch and its length, rad.
    fn piece_rad(&self, number: usize) -> (f64, f64);
}

/// Time interval inside one leg and one piece, with no edge and no corner inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passage {
    /// Start of the passage, s.
    pub(crate) start_s: f64,
    /// End of the passage, s; infinite for the rest after the last leg.
    pub(crate) end_s: f64,
    /// Leg that contains the passage.
    pub(crate) leg: Leg,
    /// Number of the piece.
    pub(crate) piece: usize,
    /// Angle of the leg's start since the piece's start, rad.
    pub(crate) offset_rad: f64,
}

/// Passages of a motion in order of time. After the last leg the rotor rests for ever.
///
/// The walk counts from piece to piece and never looks a piece up from a time or an angle, so rounding at an
/// edge decides nothing.
#[derive(Debug, Clone)]
pub(crate) struct Walk<P, M> {
    pitch: P,
    legs: M,
    /// Leg under way, and the rest of it after a reversal.
    leg: Leg,
    after_reversal: Option<Leg>,
    ended: bool,
    time_s: f64,
    pitches: f64,
    piece: usize,
}

impl<P: Pitch, M: Iterator<Item = Leg>> Walk<P, M> {
    /// Returns the passages of `legs`, each of which must start when and where the one before ends.
    pub(crate) fn new(pitch: P, legs: impl IntoIterator<IntoIter = M>) -> Self {
        let mut legs = legs.into_iter();
        let first = legs.next();
        let leg = first.unwrap_or(Leg::rest(0.0, 0.0));
        let (leg, after_reversal) = leg.split_at_reversal();
        let pitches = floor(leg.angle_rad / pitch.pitch_rad());
        let piece = pitch.index_of(leg.angle_rad - pitches * pitch.pitch_rad());
        Self { pitch, legs, leg, after_reversal, ended: first.is_none(), time_s: leg.start_s, pitches, piece }
    }

    /// Returns the start of the next passage, s.
    pub(crate) fn time_s(&self) -> f64 {
        self.time_s
    }

    fn next_leg(&mut self) {
        let next = self.after_reversal.take().or_else(|| self.legs.next());
        let next = next.unwrap_or_else(|| {
            self.ended = true;
            Leg::rest(self.leg.end_s(), self.leg.end_angle_rad())
        });
        (self.leg, self.after_reversal) = next.split_at_reversal();
    }

    fn next_piece(&mut self) {
        let last = self.pitch.last();
        if self.leg.direction() > 0.0 {
            if self.piece == last {
                self.piece = 0;
                self.pitches += 1.0;
            } else {
                self.piece += 1;
            }
        } else if self.piece == 0 {
            self.piece = last;
            self.pitches -= 1.0;
        } else {
            self.piece -= 1;
        }
    }
}

impl<P: Pitch, M: Iterator<Item = Leg>> Iterator for Walk<P, M> {
    type Item = Passage;

    fn next(&mut self) -> Option<Passage> {
        loop {
            if self.ended && self.time_s.is_infinite() {
                return None;
            }
            let (start_rad, length_rad) = self.pitch.piece_rad(self.piece);
            let piece_rad = self.pitches * self.pitch.pitch_rad() + start_rad;
            let edge_rad = match self.leg.direction() {
                forward if forward > 0.0 => Some(piece_rad + length_rad),
                reverse if reverse < 0.0 => Some(piece_rad),
                _ => None,
            };
            let edge_s = edge_rad
                .map(|edge| edge - self.leg.angle_rad)
                // Rounding may leave the start of a leg a hair beyond the edge.
                .map(|turn| if turn * self.leg.direction() < 0.0 { 0.0 } else { turn })
                .and_then(|turn| self.leg.time_to_turn(turn))
                .map(|elapsed| self.leg.start_s + elapsed);
            let start_s = self.time_s;
            let passage = |end_s| Passage {
                start_s,
                end_s,
                leg: self.leg,
                piece: self.piece,
                offset_rad: self.leg.angle_rad - piece_rad,
            };
            let leg_end_s = self.leg.end_s();
            let found = match edge_s {
                Some(edge_s) if edge_s < leg_end_s => {
                    let found = passage(edge_s.max(start_s));
                    self.next_piece();
                    found
                }
                _ => {
                    let found = passage(leg_end_s.max(start_s));
                    if leg_end_s.is_finite() {
                        self.next_leg();
                    } else {
                        self.ended = true;
                    }
                    found
                }
            };
            self.time_s = found.end_s;
            if found.end_s > start_s {
                return Some(found);
            }
        }
    }
}
