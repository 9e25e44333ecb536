//! Backups: all records of a folder in one file, and their return.

mod archive;
mod error;
mod folders;
mod position;
mod restore;

pub use archive::{BackedUp, backup, is_backup};
pub use error::BackupError;
pub use position::Position;
pub use restore::{Restored, restore};
