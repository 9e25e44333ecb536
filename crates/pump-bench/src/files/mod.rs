//! Files that a bench reads and writes: tables in, whole files out.

mod staged;
mod table;

pub use staged::Staged;
pub(crate) use staged::{folder_of, sync_folder};
pub use table::TableError;
pub(crate) use table::{Row, Table};
