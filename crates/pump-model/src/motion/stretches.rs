//! Stretches of a motion, in each of which the flow at the rollers is one polynomial of the angle.

use crate::head::flow_curve::FlowCurve;
use crate::math::polynomial::{Polynomial, shifted_quartic};

use super::flow::{DEGREE, Flow};
use super::leg::Leg;
use super::walk::{Pitch, Walk};

/// Time interval inside one leg and one piece of the flow curve, with no edge and no corner inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Start of the stretch, s.
    pub start_s: f64,
    /// End of the stretch, s; infinite for the rest after the last leg.
    pub end_s: f64,
    /// Leg that contains the stretch.
    pub leg: Leg,
    /// Flow per radian, mL/rad, over the angle since the piece's start.
    pub(crate) flow: Polynomial,
    /// Angle of the leg's start since the piece's start, rad.
    offset_rad: f64,
}

impl Stretch {
    /// Returns a stretch without motion from `start_s` on, for ever.
    pub(crate) fn rest(start_s: f64) -> Self {
        let still = Polynomial::default();
        let leg = Leg::rest(start_s, 0.0);
        Self { start_s, end_s: f64::INFINITY, leg, flow: still, offset_rad: 0.0 }
    }

    /// Returns the flow at the rollers at time `t_s`, mL/s. It holds a little outside the stretch too: the
    /// polynomial goes on.
    #[inline]
    pub fn flow_ml_s(&self, t_s: f64) -> f64 {
        let elapsed = t_s - self.leg.start_s;
        let speed = self.leg.speed_rad_s + self.leg.acceleration_rad_s2 * elapsed;
        self.flow.at(self.offset_rad + self.leg.turned(elapsed)) * speed
    }

    /// Returns the flow per radian at time `t_s`, mL/rad. At an edge it is the value on this side.
    #[inline]
    pub fn flow_ml_rad(&self, t_s: f64) -> f64 {
        self.flow.at(self.offset_rad + self.leg.turned(t_s - self.leg.start_s))
    }

    /// Returns the flow as a polynomial in the time since the stretch's start, mL/s.
    pub(crate) fn flow(&self) -> Flow {
        self.flow_of(&self.flow)
    }

    /// Returns the flow that `per_rad`, a function of the angle since the piece's start, makes in this motion,
    /// as a polynomial in the time since the stretch's start.
    pub(crate) fn flow_of(&self, per_rad: &Polynomial) -> Flow {
        let elapsed = self.start_s - self.leg.start_s;
        let (acceleration, speed) = (self.leg.acceleration_rad_s2, self.leg.speed_at(self.start_s));
        let [c0, c1, c2, c3, c4, _] = per_rad.c;
        if acceleration == 0.0 && [c1, c2, c3, c4] == [0.0; 4] {
            // Between the pulses of two rollers the flow is even.
            return Flow::even(c0 * speed);
        }
        let q = shifted_quartic([c0, c1, c2, c3, c4], self.offset_rad + self.leg.turned(elapsed));
        if acceleration == 0.0 {
            let mut c = [0.0; DEGREE + 1];
            let mut power = speed;
            for (to, from) in c.iter_mut().zip(q) {
                *to = from * power;
                power *= speed;
            }
            return Flow { c, degree: 4 };
        }
        // The flow is q(v) (speed + acceleration t) with v = speed t + acceleration t²/2, by Horner's rule.
        let mut c = [0.0; DEGREE + 1];
        for (n, coefficient) in q.iter().rev().enumerate() {
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

    /// Returns the time derivative of the flow at time `t_s`, mL/s².
    pub fn flow_rate_ml_s2(&self, t_s: f64) -> f64 {
        let elapsed = t_s - self.leg.start_s;
        let speed = self.leg.speed_rad_s + self.leg.acceleration_rad_s2 * elapsed;
        let angle = self.offset_rad + self.leg.turned(elapsed);
        self.flow.slope_at(angle) * speed * speed + self.flow.at(angle) * self.leg.acceleration_rad_s2
    }
}

/// Stretches of a motion in order of time. After the last leg the rotor rests for ever.
#[derive(Debug, Clone)]
pub struct Stretches<'a, M> {
    curve: &'a FlowCurve,
    walk: Walk<&'a FlowCurve, M>,
}

impl<'a, M: Iterator<Item = Leg>> Stretches<'a, M> {
    /// Returns the stretches of `legs`, each of which must start when and where the one before ends.
    pub fn new(curve: &'a FlowCurve, legs: impl IntoIterator<IntoIter = M>) -> Self {
        Self { curve, walk: Walk::new(curve, legs) }
    }

    /// Returns the start of the next stretch, s.
    pub fn time_s(&self) -> f64 {
        self.walk.time_s()
    }
}

impl<M: Iterator<Item = Leg>> Iterator for Stretches<'_, M> {
    type Item = Stretch;

    fn next(&mut self) -> Option<Stretch> {
        let passage = self.walk.next()?;
        let flow = self.curve.piece(passage.piece).flow;
        Some(Stretch {
            start_s: passage.start_s,
            end_s: passage.end_s,
            leg: passage.leg,
            flow,
            offset_rad: passage.offset_rad,
        })
    }
}

impl Pitch for &FlowCurve {
    fn pitch_rad(&self) -> f64 {
        FlowCurve::pitch_rad(self)
    }
    fn last(&self) -> usize {
        self.pieces().len() - 1
    }
    fn index_of(&self, local_rad: f64) -> usize {
        FlowCurve::index_of(self, local_rad)
    }
    fn piece_rad(&self, number: usize) -> (f64, f64) {
        let piece = self.piece(number);
        (piece.start_rad, piece.length_rad)
    }
}
