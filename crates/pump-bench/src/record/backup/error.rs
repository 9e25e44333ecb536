//! Backups that cannot be made or restored.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::Position;
use crate::record::FolderError;

/// Backup that cannot be made or restored. Nothing was changed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BackupError {
    /// A file cannot be read or written.
    #[error("cannot {action} {}", .path.display())]
    File {
        /// Operation that failed.
        action: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Cause of the failure.
        source: io::Error,
    },
    /// A pump is in use, or its folder cannot be locked.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The file is no backup, or is damaged.
    #[error("{} is no whole backup: {message}", .path.display())]
    Damaged {
        /// Path of the backup.
        path: PathBuf,
        /// Damage of the file.
        message: String,
    },
    /// The backup would turn the record of a pump back.
    #[error(
        "the backup would turn the record of {record} back: the record stands at {here}, and the backup at {there}"
    )]
    TurnsBack {
        /// Pump and drive, as `pump/drive`.
        record: String,
        /// Position of the record here.
        here: Position,
        /// Position of the record in the backup.
        there: Position,
    },
    /// The record here is not the beginning of that in the backup.
    #[error(
        "the backup has another history of {record}: the record here stands at {here}, and that entry is not in the \
         backup, which stands at {there}"
    )]
    OtherHistory {
        /// Pump and drive, as `pump/drive`.
        record: String,
        /// Position of the record here.
        here: Position,
        /// Position of the record in the backup.
        there: Position,
    },
    /// A file here is not that of the backup, and the journal does not tell which is newer.
    #[error("{} is not that of the backup, which has {there}; nothing tells which of them is newer", .path.display())]
    Differs {
        /// Path of the file here.
        path: PathBuf,
        /// Contents of the backup in its place.
        there: &'static str,
    },
}
