//! Claims about the log of doses, and about copies of all records.

mod backups;
mod log;
