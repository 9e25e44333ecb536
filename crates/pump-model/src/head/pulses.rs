//! The pulses that the rollers take from the flow of one port.

use crate::math::polynomial::Polynomial;
use crate::units::wrap;

use super::roller_volume::RollerVolume;
use crate::port::Port;

/// Distance below which two edges count as one, rad. An angle is known to 1e-15 rad; a step is 1e-4 or more.
pub(crate) const SAME_EDGE_RAD: f64 = 1e-12;

/// The pulses of all rollers at one port.
pub(super) struct Pulses<'a> {
    pub(super) roller: &'a RollerVolume,
    pub(super) port: Port,
    /// Engagement angle phi, rad.
    pub(super) phi: f64,
    /// Inlet phase psi, rad.
    pub(super) psi: f64,
    pub(super) pitch_rad: f64,
}

impl Pulses<'_> {
    /// Returns the next angle of the pitch at which a pulse changes its polynomial, or the pitch's end.
    pub(super) fn edge_after(&self, start_rad: f64) -> f64 {
        let starts = self.roller.pieces().iter().map(|piece| piece.start_rad);
        let edges = starts.chain([self.phi]).map(|x| self.edge(x));
        let distinct =
            |edge: &f64| edge - start_rad >= SAME_EDGE_RAD && self.pitch_rad - edge >= SAME_EDGE_RAD;
        edges.filter(distinct).fold(self.pitch_rad, f64::min)
    }

    /// Returns the angle of the pitch at which a roller is engaged by `x`.
    fn edge(&self, x: f64) -> f64 {
        let angle = match self.port {
            Port::Outlet => self.phi - x,
            Port::Inlet => self.psi + x,
        };
        wrap(angle, self.pitch_rad)
    }

    /// Returns the volume that the rollers take from the flow between `start` and `start + u`, as a
    /// polynomial in u up to a constant. No edge may lie inside.
    pub(super) fn displaced(&self, start: f64, length: f64) -> Polynomial {
        let middle = start + 0.5 * length;
        let mut sum = Polynomial::default();
        // The angle x of roller 0 in the middle of the stretch; the others stand whole pitches from it.
        let (first, direction) = match self.port {
            Port::Outlet => (self.phi - middle, -1.0),
            Port::Inlet => (middle - self.psi, 1.0),
        };
        let mut x_middle = wrap(first, self.pitch_rad);
        while x_middle < self.phi {
            let piece = self.roller.piece_at(x_middle);
            let x_start = x_middle - direction * 0.5 * length;
            // outlet: V(x_start) - V(x_start - u), inlet: V(x_start + u) - V(x_start)
            let volume =
                piece.volume.shifted(x_start - piece.start_rad).stretched(direction).scaled(direction);
            sum = sum.plus(&volume);
            x_middle += self.pitch_rad;
        }
        sum
    }
}
