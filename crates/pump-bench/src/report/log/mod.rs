//! The log for people, for spreadsheets and for programs.

mod rows;
mod totals;

pub use rows::{LOG_CSV_HEADER, log_csv, log_json, log_text};
pub use totals::{LogTotal, LogTotals};
