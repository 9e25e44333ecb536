//! Configurations that cannot be used.

use std::path::PathBuf;

use thiserror::Error;

use crate::pump_file::PumpFileError;

/// A configuration that cannot be used, or a pump that it does not lead to.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("cannot read the configuration {}", .path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Reason that the system gives.
        source: std::io::Error,
    },
    /// The text is not TOML, or it has unknown, missing or mistyped keys.
    #[error("configuration {}: {message}", .path.display())]
    Syntax {
        /// Path of the file.
        path: PathBuf,
        /// Message of the parser, with line and column.
        message: String,
    },
    /// A value is not allowed.
    #[error("configuration {}: {key} is `{value}`; allowed: {allowed}", .path.display())]
    Value {
        /// Path of the file.
        path: PathBuf,
        /// Key in the file.
        key: String,
        /// Value in the file.
        value: String,
        /// Values that are allowed.
        allowed: String,
    },
    /// The name is neither configured nor built in, and no file.
    #[error(
        "there is no pump `{name}`; configured in {}: {configured}; built-in pumps: {built_in}; or name a TOML pump \
         file",
        .path.display()
    )]
    UnknownPump {
        /// Name that was given.
        name: String,
        /// Path of the configuration.
        path: PathBuf,
        /// Names that the configuration has.
        configured: String,
        /// Names of the built-in pumps.
        built_in: String,
    },
    /// No rack is configured under the name, and it is no file.
    #[error(
        "there is no rack `{name}`; {}; or name the file of a rack",
        match configured.as_str() {
            "" => "the configuration names none in [racks]".to_owned(),
            names => format!("configured: {names}"),
        }
    )]
    UnknownRack {
        /// Name that was given.
        name: String,
        /// Names that the configuration has.
        configured: String,
    },
    /// Two names of the configuration lead to one record.
    #[error(
        "the pumps `{name}` ({}) and `{other}` ({}) of the configuration have one id, `{id}`, so they would share a \
         record; {}",
        .file.display(),
        .other_file.display(),
        if file == other_file {
            "keep one of the names"
        } else {
            "give one of the files another [pump] id, or keep one of the names"
        }
    )]
    SameId {
        /// Identifier of both pumps.
        id: String,
        /// Name that was used.
        name: String,
        /// Pump file of that name.
        file: PathBuf,
        /// Other name.
        other: String,
        /// Pump file of the other name.
        other_file: PathBuf,
    },
    /// The name leads to another pump file already.
    #[error("the name `{name}` of the configuration is that of {} already", .file.display())]
    Taken {
        /// Name that was to be given.
        name: String,
        /// Pump file of that name.
        file: PathBuf,
    },
    /// The text has no place for the line of a new pump.
    #[error(
        "configuration {}: a pump cannot be written into it; write this line into [pumps]: {line}",
        .path.display()
    )]
    NoRoom {
        /// Path of the file.
        path: PathBuf,
        /// Line that names the pump.
        line: String,
    },
    /// The text has no line of its own for the pump.
    #[error("configuration {}: `{name}` cannot be taken out of it; delete its line in [pumps]", .path.display())]
    NoLine {
        /// Path of the file.
        path: PathBuf,
        /// Name of the pump.
        name: String,
    },
    /// The pump file cannot be used.
    #[error(transparent)]
    Pump(#[from] PumpFileError),
}
