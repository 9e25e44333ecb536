//! Parameters of a waveform's fit, and the choice of those that it seeks.

use super::error::IdentificationError;
use super::readings::Readings;
use super::recording::{Recording, RotorMotion};
use super::sought_parameter::SoughtParameter;

/// Number of parameters: ln R, ln C, ln L, angle in rad, start in s, pressure in kPa. The logarithms keep a
/// line physical.
pub(super) const N: usize = 6;
pub(super) const ANGLE: usize = 3;
pub(super) const START: usize = 4;
pub(super) const PRESSURE: usize = 5;
/// Parameters in the order of the search.
pub(super) const SEARCHED: [SoughtParameter; N] = [
    SoughtParameter::Resistance,
    SoughtParameter::Compliance,
    SoughtParameter::Inertance,
    SoughtParameter::StartAngle,
    SoughtParameter::StartTime,
    SoughtParameter::ReservoirPressure,
];

/// Parameters that a fit seeks. It holds the others at the values of the pump and the recording.
///
/// ```
/// use pump_model::identification::Sought;
///
/// let sought = Sought::LINE.with_inertance(false).with_pressure(true);
/// assert!(sought.resistance && sought.pressure && !sought.inertance);
/// assert_eq!(Sought::new().with_resistance(true).with_compliance(true).with_inertance(true), Sought::LINE);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
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
    pub const LINE: Self = Self::new().with_resistance(true).with_compliance(true).with_inertance(true);

    /// Choice of nothing, to which parameters are added.
    pub const fn new() -> Self {
        Self {
            resistance: false,
            compliance: false,
            inertance: false,
            angle: false,
            start: false,
            pressure: false,
        }
    }

    /// Says whether the fit seeks R.
    #[must_use]
    pub const fn with_resistance(self, resistance: bool) -> Self {
        Self { resistance, ..self }
    }

    /// Says whether the fit seeks C.
    #[must_use]
    pub const fn with_compliance(self, compliance: bool) -> Self {
        Self { compliance, ..self }
    }

    /// Says whether the fit seeks L.
    #[must_use]
    pub const fn with_inertance(self, inertance: bool) -> Self {
        Self { inertance, ..self }
    }

    /// Says whether the fit seeks an angle.
    #[must_use]
    pub const fn with_angle(self, angle: bool) -> Self {
        Self { angle, ..self }
    }

    /// Says whether the fit seeks a start.
    #[must_use]
    pub const fn with_start(self, start: bool) -> Self {
        Self { start, ..self }
    }

    /// Says whether the fit seeks the reservoir's pressure.
    #[must_use]
    pub const fn with_pressure(self, pressure: bool) -> Self {
        Self { pressure, ..self }
    }

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
        if self.angle && self.start && matches!(recording.motion, RotorMotion::Steady { .. }) {
            return Err(IdentificationError::Same { first: SEARCHED[ANGLE], second: SEARCHED[START] });
        }
        let flags = self.flags();
        let (parameters, given) = (count(flags), recording.samples.len());
        if given <= parameters || parameters == 0 {
            let needed = parameters + 1;
            return Err(IdentificationError::TooFew { given, of: Readings::Samples, needed, parameters });
        }
        Ok(flags)
    }
}

/// Returns the number of parameters that are sought.
pub(super) fn count(flags: [bool; N]) -> usize {
    flags.iter().filter(|is_sought| **is_sought).count()
}
