//! The commands about the record: what stands in it, its doses, and its copies.

pub(crate) mod backup;
pub(crate) mod log;
pub(crate) mod status;

pub(crate) use status::{rows_of_all, tell_rows};
