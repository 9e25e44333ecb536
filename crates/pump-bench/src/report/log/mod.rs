//! The log for people, for spreadsheets and for programs.

mod rows;
mod span;
mod totals;

pub use rows::{LOG_CSV_HEADER, log_csv, log_json, log_text};
pub use span::{LeftOut, LogPlace, LogSpan};
pub use totals::{LogTotal, LogTotals};
