//! The parameters of a waveform's fit, and those that it seeks.

use super::error::IdentificationError;
use super::recording::{Motion, Recording, SAMPLES};

/// Parameters: ln R, ln C, ln L, angle in rad, start in s, pressure in kPa; the logarithms keep a line physical.
pub(super) const N: usize = 6;
pub(super) const ANGLE: usize = 3;
pub(super) const START: usize = 4;
pub(super) const PRESSURE: usize = 5;
pub(super) const NAMES: [&str; N] =
    ["resistance", "compliance", "inertance", "start angle", "start time", "reservoir pressure"];

/// Parameters that a fit seeks; it holds the others as the pump and the recording have them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sought {
    /// The fit seeks R.
    pub resistance: bool,
    /// The fit seeks C.
    pub compliance: bool,
    /// The fit seeks L.
    pub inertance: bool,
    /// The fit seeks an angle, which it adds to that of the motion.
    pub angle: bool,
    /// The fit seeks a start, which it adds to the time of the motion. It finds one only where the first guess is near.
    pub start: bool,
    /// The fit seeks the reservoir's pressure, and with it the offset of the sensor.
    pub pressure: bool,
}

impl Sought {
    /// R, C and L.
    pub const LINE: Self = Self {
        resistance: true,
        compliance: true,
        inertance: true,
        angle: false,
        start: false,
        pressure: false,
    };

    /// True if anything is sought that the mean pressure does not tell.
    pub(super) fn is_of_shape(self) -> bool {
        self.compliance || self.inertance || self.angle || self.start
    }

    fn flags(self) -> [bool; N] {
        [self.resistance, self.compliance, self.inertance, self.angle, self.start, self.pressure]
    }

    /// Parameters that are sought, if they can be told apart and the recording has more samples than there are of them.
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

/// Number of parameters that are sought.
pub(super) fn count(flags: [bool; N]) -> usize {
    flags.iter().filter(|is_sought| **is_sought).count()
}
