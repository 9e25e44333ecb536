//! Files that a bench reads and writes: tables in, whole files out.

mod plain;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
mod small_records;
mod staged;
mod table;
mod without_links;

pub use plain::{
    FileError, MOST_PUMP_FILE_BYTES, MOST_TABLE_BYTES, is_one_file, names_in, place_of, read_text,
};
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
pub(crate) use small_records::{read_plain, replace_plain};
pub use staged::Staged;
pub(crate) use staged::{folder_of, sync_folder};
pub use table::TableError;
pub(crate) use table::{Row, Table};
pub(crate) use without_links::{check_plain, create_folders, open_plain};
