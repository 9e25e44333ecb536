//! Why a line cannot be identified.

use thiserror::Error;

use crate::error::{Allowed, ModelError};

/// Measurements that are refused or say too little, with what is wrong and what to do.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// There is nothing to fit.
    #[error("{given} {of}; {needed} at least are needed for {parameters} parameters and how sure they are")]
    TooFew {
        /// Number of readings.
        given: usize,
        /// Kind of reading.
        of: &'static str,
        /// Number of readings that is needed.
        needed: usize,
        /// Number of parameters that are sought.
        parameters: usize,
    },
    /// A measured value that is none.
    #[error("{quantity} of {of} {number} is {value}; allowed: {allowed}")]
    Value {
        /// Name of the quantity, with its unit.
        quantity: &'static str,
        /// Kind of reading.
        of: &'static str,
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
        of: &'static str,
        /// Parameter that was sought.
        parameter: &'static str,
        /// Why it was not found, and what to do.
        why: &'static str,
    },
    /// A waveform of which the pump explains nothing.
    #[error(
        "the fit explains {explained_percent:.1} % of how the samples of pressure vary (a constant pressure \
         explains 0), so they do not determine the line; allowed: {least_percent} % at least; check speed, \
         start angle, port and units, and whether the pump turned; of a record that is noise for the most part \
         average over pitches; seek the reservoir's pressure too if the sensor may be off"
    )]
    Unexplained {
        /// By how much the squares of the residuals are less than those about the mean of the samples, %; negative if
        /// they are more.
        explained_percent: f64,
        /// How much they must be less, %.
        least_percent: f64,
    },
    /// Two parameters that are one.
    #[error("{first} and {second} are the same in a steady state; seek one of them")]
    Same {
        /// One.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// The search for the least squares did not end.
    #[error(
        "the fit did not converge in {steps} steps (RMS {rms_kpa:.3} kPa); start from a line that is nearer, \
         seek fewer parameters, and check speed, start angle and units"
    )]
    NotConverged {
        /// How many were made.
        steps: u32,
        /// Root of the mean square of the residuals where it stopped, kPa.
        rms_kpa: f64,
    },
    /// The residuals look alike for so long that nobody can say how sure the fit is.
    #[error(
        "what the fit leaves over stays alike for more than {samples} samples: the model misses something, or \
         the record is much denser than the noise; keep every tenth sample, or check speed, angle and line"
    )]
    Alike {
        /// Over how many samples it was looked at.
        samples: usize,
    },
    /// The model of the pump refuses.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Name of a measured value in errors: its quantity with the unit, the kind of reading, and the reading's index from 0.
pub(super) type Reading = (&'static str, &'static str, usize);

/// Refuses a measured value that is not allowed.
pub(super) fn within(reading: Reading, value: f64, allowed: Allowed) -> Result<(), IdentificationError> {
    if allowed.admits(value) { Ok(()) } else { Err(refused(reading, value, allowed)) }
}

/// The error of a measured value that is not allowed.
pub(super) fn refused(
    (quantity, of, index): Reading,
    value: f64,
    allowed: impl Into<Allowed>,
) -> IdentificationError {
    IdentificationError::Value { quantity, of, number: index + 1, value, allowed: allowed.into() }
}
