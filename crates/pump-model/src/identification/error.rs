//! Errors of the identification of lines.

use core::fmt;

use thiserror::Error;

use crate::error::{Allowed, ModelError, Parameter, Shown};

use super::readings::Readings;
use super::sought_parameter::SoughtParameter;

/// Reason why measurements are refused or say too little. It names the fault and the remedy.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// There are too few readings for a fit.
    #[error("{given} {of}; {needed} at least are needed for {parameters} parameters and their uncertainties")]
    TooFew {
        /// Number of readings.
        given: usize,
        /// Kind of reading.
        of: Readings,
        /// Number of readings that is needed.
        needed: usize,
        /// Number of parameters that are sought.
        parameters: usize,
    },
    /// A measured value lies outside its range.
    #[error("{parameter} of {} {number} is {}; allowed: {allowed}", of.single(), Shown(*value))]
    OutOfRange {
        /// Quantity that was measured.
        parameter: Parameter,
        /// Kind of reading.
        of: Readings,
        /// Number of the reading, from 1.
        number: usize,
        /// Value that was read.
        value: f64,
        /// Values that are accepted.
        allowed: Allowed,
    },
    /// The readings do not determine a parameter.
    #[error("the {of} do not determine the {parameter}: {why}")]
    Undetermined {
        /// Kind of reading.
        of: Readings,
        /// Parameter that was sought.
        parameter: SoughtParameter,
        /// Reason why the parameter was not found, and a remedy.
        why: &'static str,
    },
    /// The pump explains nothing of a waveform.
    #[error(
        "the fit explains {} % of how the samples of pressure vary (a constant pressure explains 0), so they \
         do not determine the line; allowed: {least_percent} % at least; check speed, start angle, port and \
         units, and that the pump turned; average a noisy record over pitches; seek the reservoir's pressure \
         too if the sensor may be off",
        Explained(*explained_percent)
    )]
    Unexplained {
        /// Part of the samples' variance that the fit explains, %; negative if the residuals are larger than
        /// the deviations from the mean.
        explained_percent: f64,
        /// Smallest part that a fit must explain, %.
        least_percent: f64,
    },
    /// Two sought parameters are one and the same.
    #[error("{first} and {second} are the same in a steady state; seek one of them")]
    Same {
        /// One of the two parameters.
        first: SoughtParameter,
        /// The other parameter.
        second: SoughtParameter,
    },
    /// The search for the least squares did not end.
    #[error(
        "the fit did not converge in {steps} steps (RMS {rms_kpa:.3} kPa); start from a line that is nearer, \
         seek fewer parameters, and check speed, start angle and units"
    )]
    NotConverged {
        /// Number of steps that were made.
        steps: u32,
        /// Root of the mean square of the residuals where the search stopped, kPa.
        rms_kpa: f64,
    },
    /// The residuals stay alike for so long that the fit has no uncertainty.
    #[error(
        "the residual of the fit stays alike for more than {samples} samples: the model misses something, or \
         the record is much denser than the noise; keep every tenth sample, or check speed, angle and line"
    )]
    Alike {
        /// Number of samples over which the residuals were compared.
        samples: usize,
    },
    /// The caller of the search stopped it.
    #[error("the search was stopped")]
    Stopped,
    /// There is no room for the numbers of the fit.
    #[error("no memory for {given} {of}")]
    NoMemory {
        /// Number of readings.
        given: usize,
        /// Kind of reading.
        of: Readings,
    },
    /// The model of the pump refuses its parameters.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Place of a measured value: its quantity, the kind of reading, and the reading's index from 0.
pub(super) type ReadingName = (Parameter, Readings, usize);

/// Refuses a measured value that is not allowed.
pub(super) fn within(reading: ReadingName, value: f64, allowed: Allowed) -> Result<(), IdentificationError> {
    if allowed.admits(value) { Ok(()) } else { Err(refused(reading, value, allowed)) }
}

/// Returns the error for a measured value that is not allowed.
pub(super) fn refused(
    (parameter, of, index): ReadingName,
    value: f64,
    allowed: impl Into<Allowed>,
) -> IdentificationError {
    IdentificationError::OutOfRange { parameter, of, number: index + 1, value, allowed: allowed.into() }
}

/// Part of a variance that a fit explains, %. How much less than nothing it explains tells nobody anything.
struct Explained(f64);

impl fmt::Display for Explained {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 0.0 { f.write_str("less than 0") } else { write!(f, "{:.1}", self.0) }
    }
}
