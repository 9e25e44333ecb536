//! Roller volumes that grow piece by piece and are held where they would fall.

use crate::error::ModelError;
use crate::head::roller_volume::{MAX_PIECES, RollerVolume};
use crate::math::polynomial::{Polynomial, Roots};

impl RollerVolume {
    /// Appends the stretch [start, end]. `volume`, over x - start in rad, gives the gain there; where it
    /// falls the volume is held.
    pub(crate) fn append(&mut self, start: f64, end: f64, volume: &Polynomial) -> Result<(), ModelError> {
        /// Largest negative slope, as a part of the largest slope, that counts as rounding.
        const ROUNDING: f64 = 1e-12;
        let length = end - start;
        let slope = volume.derivative();
        let ((_, least), (_, most)) = slope.range_in(0.0, length);
        let turns = if least >= -ROUNDING * most { Roots::default() } else { slope.roots_in(0.0, length) };
        let mut from = 0.0;
        for &to in turns.as_slice().iter().chain(core::iter::once(&length)) {
            if to > from {
                let rises = slope.at(0.5 * (from + to)) > 0.0;
                if !self.push(start + from, start + to, rises.then(|| volume.shifted(from))) {
                    return Err(ModelError::TooManyPieces { allowed: MAX_PIECES });
                }
            }
            from = to;
        }
        Ok(())
    }
}
