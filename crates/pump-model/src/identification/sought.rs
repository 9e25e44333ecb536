//! Parameters of a waveform's fit, and the choice of those that it seeks.

use super::error::IdentificationError;
use super::recording::{Motion, Recording, SAMPLES};

/// Number of parameters: ln R, ln C, ln L, angle in rad, start in s, pressure in kPa. The logarithms keep a
/// line physical.
pub(super) const N: usize = 6;
pub(super) const ANGLE: usize = 3;
pub(super) const START: usize = 4;
pub(super) const PRESSURE: usize = 5;
pub(super) const NAMES: [&str; N] =
    ["resistance", "compliance", "inertance", "start angle", "start time", "reservoir pressure"];

/// Parameters that a fit seeks. It holds the others at the values of the pump and the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sought {
    /// True if the fit seeks R.
    pub resistance: bool,
    /// True if the fit seeks C.
    pub compliance: bool,
    /// True if the fit seeks L.
    pub inertance: bool,
    /// True if the fit seeks an angle, which it adds to that of the motion.
    pub angle: bool,
    /// True if the fit seeks a start, which it adds to the time of the motion. It finds one only where the
    /// first guess is near.
    pub start: bool,
    /// True if the fit seeks the reservoir's pressure, and with it the offset of the sensor.
    pub pressure: bool,
}

impl Sought {
    /// Choice of R, C and L.
    pub const LINE: Self = Self {
        resistance: true,
        compliance: true,
        inertance: true,
        angle: false,
        start: false,
        pressure: false,
    };

    /// True if anything is sought that shows in the shape of the pressure and not in its mean.
    pub(super) fn is_of_shape(self) -> bool {
        self.compliance || self.inertance || self.angle || self.start
    }

    fn flags(self) -> [bool; N] {
        [self.resistance, self.compliance, self.inertance, self.angle, self.start, self.pressure]
    }

    /// Returns the parameters that are sought. Refuses parameters that cannot be told apart, and a recording
    /// with no more samples than parameters.
    pub(super) fn checked(self, recording: &Recording<'_>) -> Result<[bool; N], IdentificationError> {
        if self.angle && self.start && matches!(recording.motion, Motion::Steady { .. }) {
            return Err(IdentificationError::Same { first: NAMES[ANGLE], second: NAMES[START] });
        }
        let flags = self.flags();
        let (parameters, given) = (count(flags), recording.samples.len());
        if given <= parameters || parameters == 0 {
            let needed = parameters + 1;
            return Err(IdentificationError::TooFew { given, of: SAMPLES, needed, parameters });
        }
        Ok(flags)
    }
}

/// Returns the number of parameters that are sought.
pub(super) fn count(flags: [bool; N]) -> usize {
    flags.iter().filter(|is_sought| **is_sought).count()
}
