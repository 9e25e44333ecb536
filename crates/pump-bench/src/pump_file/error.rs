//! Pump files that cannot be used.

use std::path::PathBuf;

use pump_ctl::plan::PlanError;
use pump_model::ModelError;
use thiserror::Error;

use crate::displacement::DisplacementError;

/// A pump file that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PumpFileError {
    /// The file cannot be read.
    #[error("cannot read pump file {}", .path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Reason that the system gives.
        source: std::io::Error,
    },
    /// The name is neither a built-in pump nor a file.
    #[error("there is no pump `{name}`; built-in pumps: {known}; or name a TOML pump file")]
    Unknown {
        /// Name that was given.
        name: String,
        /// Names of the built-in pumps.
        known: String,
    },
    /// The text is not TOML, or it has unknown, missing or mistyped keys.
    #[error("pump file {origin}: {message}")]
    Syntax {
        /// Name of the file.
        origin: String,
        /// Message of the parser, with line and column.
        message: String,
    },
    /// The schema is unknown to this version.
    #[error("pump file {origin}: schema is `{schema}`; this version reads `pump/1`")]
    Schema {
        /// Name of the file.
        origin: String,
        /// Schema that the file names.
        schema: String,
    },
    /// A value is not allowed.
    #[error("pump file {origin}: {key} is {value}; allowed: {allowed}")]
    Value {
        /// Name of the file.
        origin: String,
        /// Table and key.
        key: &'static str,
        /// Value in the file.
        value: String,
        /// Values that are allowed.
        allowed: String,
    },
    /// The pump that the file describes cannot work.
    #[error("pump file {origin} cannot be used")]
    Model {
        /// Name of the file.
        origin: String,
        /// Reason that the model gives.
        source: ModelError,
    },
    /// The pump has no speed for the default rate.
    #[error("pump file {origin} cannot be used with its [pump] default_rate_ml_s")]
    Displacement {
        /// Name of the file.
        origin: String,
        /// Reason that the displacement gives.
        source: DisplacementError,
    },
    /// The motor or the limits cannot work.
    #[error("pump file {origin} cannot be used")]
    Limits {
        /// Name of the file.
        origin: String,
        /// Reason that the planner gives.
        source: PlanError,
    },
}
