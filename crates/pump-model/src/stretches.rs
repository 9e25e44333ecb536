//! Cuts a motion into stretches in which the flow at the rollers is one polynomial of the angle.

use crate::flow_curve::FlowCurve;
use crate::math::floor;
use crate::motion::Leg;
use crate::polynomial::Polynomial;
use crate::propagator::{DEGREE, Flow};

/// A time interval inside one leg and one piece of the flow curve: no edge and no corner inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// When it starts, s.
    pub start_s: f64,
    /// When it ends, s; infinite for the rest after the last leg.
    pub end_s: f64,
    /// The motion.
    pub leg: Leg,
    /// Flow per radian, mL/rad, over the angle since the piece's start.
    flow: Polynomial,
    flow_slope: Polynomial,
    /// Angle of the leg's start since the piece's start, rad.
    offset_rad: f64,
}

impl Stretch {
    /// No motion from `start_s` on, for ever.
    pub(crate) fn rest(start_s: f64) -> Self {
        let still = Polynomial::default();
        let leg = Leg::rest(start_s, 0.0);
        Self { start_s, end_s: f64::INFINITY, leg, flow: still, flow_slope: still, offset_rad: 0.0 }
    }

    /// Flow at the rollers at time `t_s`, mL/s. Valid a little outside the stretch too: the polynomial goes on.
    pub fn flow_ml_s(&self, t_s: f64) -> f64 {
        let elapsed = t_s - self.leg.start_s;
        let speed = self.leg.speed_rad_s + self.leg.acceleration_rad_s2 * elapsed;
        self.flow.at(self.offset_rad + self.leg.turned(elapsed)) * speed
    }

    /// Flow per radian at time `t_s`, mL/rad: at an edge, that of this side of it.
    pub fn flow_ml_rad(&self, t_s: f64) -> f64 {
        self.flow.at(self.offset_rad + self.leg.turned(t_s - self.leg.start_s))
    }

    /// The flow as a polynomial in time since the stretch's start, mL/s.
    pub(crate) fn flow(&self) -> Flow {
        let elapsed = self.start_s - self.leg.start_s;
        let (acceleration, speed) = (self.leg.acceleration_rad_s2, self.leg.speed_at(self.start_s));
        let q = self.flow.shifted(self.offset_rad + self.leg.turned(elapsed)).c;
        if acceleration == 0.0 {
            let mut c = [0.0; DEGREE + 1];
            let mut power = speed;
            for (to, from) in c.iter_mut().zip(q).take(5) {
                *to = from * power;
                power *= speed;
            }
            return Flow { c, degree: 4 };
        }
        // q(v) (speed + acceleration t) with v = speed t + acceleration t²/2, by Horner's rule.
        let mut c = [0.0; DEGREE + 1];
        for (n, coefficient) in q.iter().take(5).rev().enumerate() {
            let (mut below, mut two_below) = (0.0, 0.0);
            for c in c.iter_mut().take(2 * n + 1) {
                let old = *c;
                *c = speed * below + 0.5 * acceleration * two_below;
                (below, two_below) = (old, below);
            }
            c[0] += coefficient;
        }
        let mut below = 0.0;
        for c in &mut c {
            let old = *c;
            *c = speed * old + acceleration * below;
            below = old;
        }
        Flow { c, degree: DEGREE }
    }

    /// Time derivative of the flow, mL/s².
    pub fn flow_rate_ml_s2(&self, t_s: f64) -> f64 {
        let elapsed = t_s - self.leg.start_s;
        let speed = self.leg.speed_rad_s + self.leg.acceleration_rad_s2 * elapsed;
        let angle = self.offset_rad + self.leg.turned(elapsed);
        self.flow_slope.at(angle) * speed * speed + self.flow.at(angle) * self.leg.acceleration_rad_s2
    }
}

/// The stretches of a motion in order of time. After the last leg the rotor rests for ever.
///
/// Which piece of the curve applies is counted from piece to piece, never looked up from a time or an angle, so
/// rounding at an edge decides nothing.
#[derive(Debug, Clone)]
pub struct Stretches<'a, M> {
    curve: &'a FlowCurve,
    legs: M,
    /// The leg under way and what is left of it after a reversal.
    leg: Leg,
    after_reversal: Option<Leg>,
    ended: bool,
    time_s: f64,
    pitch: f64,
    piece: usize,
}

impl<'a, M: Iterator<Item = Leg>> Stretches<'a, M> {
    /// Stretches of `legs`, each of which must start when and where the one before ends.
    pub fn new(curve: &'a FlowCurve, legs: impl IntoIterator<IntoIter = M>) -> Self {
        let mut legs = legs.into_iter();
        let first = legs.next();
        let leg = first.unwrap_or(Leg::rest(0.0, 0.0));
        let (leg, after_reversal) = leg.split_at_reversal();
        let pitch = floor(leg.angle_rad / curve.pitch_rad());
        let piece = curve.index_of(leg.angle_rad - pitch * curve.pitch_rad());
        Self { curve, legs, leg, after_reversal, ended: first.is_none(), time_s: leg.start_s, pitch, piece }
    }

    /// When the next stretch starts, s.
    pub fn time_s(&self) -> f64 {
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
        let last = self.curve.pieces().len() - 1;
        if self.leg.direction() > 0.0 {
            if self.piece == last {
                self.piece = 0;
                self.pitch += 1.0;
            } else {
                self.piece += 1;
            }
        } else if self.piece == 0 {
            self.piece = last;
            self.pitch -= 1.0;
        } else {
            self.piece -= 1;
        }
    }
}

impl<M: Iterator<Item = Leg>> Iterator for Stretches<'_, M> {
    type Item = Stretch;

    fn next(&mut self) -> Option<Stretch> {
        loop {
            if self.ended && self.time_s.is_infinite() {
                return None;
            }
            let piece = self.curve.piece(self.piece);
            let piece_rad = self.pitch * self.curve.pitch_rad() + piece.start_rad;
            let edge_rad = match self.leg.direction() {
                forward if forward > 0.0 => Some(piece_rad + piece.length_rad),
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
            let stretch = |end_s| Stretch {
                start_s,
                end_s,
                leg: self.leg,
                flow: piece.flow,
                flow_slope: piece.flow.derivative(),
                offset_rad: self.leg.angle_rad - piece_rad,
            };
            let leg_end_s = self.leg.end_s();
            let found = match edge_s {
                Some(edge_s) if edge_s < leg_end_s => {
                    let found = stretch(edge_s.max(start_s));
                    self.next_piece();
                    found
                }
                _ => {
                    let found = stretch(leg_end_s.max(start_s));
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
