//! Reasons why the history cannot be used.

use std::path::PathBuf;

use thiserror::Error;

/// History that cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum HistoryError {
    /// The file cannot be used.
    #[error("the history {} cannot be used: {source}", .path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: rusqlite::Error,
    },
    /// The file is of a later version.
    #[error("the history {} has version {found}, and this program reads {known}; use the later program, or move the \
             file away", .path.display())]
    Version {
        /// Path of the file.
        path: PathBuf,
        /// Version of the file.
        found: i64,
        /// Version that this program writes.
        known: i64,
    },
}
