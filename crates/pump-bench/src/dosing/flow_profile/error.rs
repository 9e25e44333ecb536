//! The refusal of a table of a flow over time.

use thiserror::Error;

use crate::files::TableError;

/// Refusal of a table of a flow over time. Rows count as the lines of the file.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The header or the form of the table is wrong.
    #[error("the profile is a table with the columns time_s and flow_ml_s")]
    Table(#[source] TableError),
    /// A column is missing.
    #[error("the profile has no column `{column}`; its first line names the columns time_s and flow_ml_s")]
    Column {
        /// Name of the column.
        column: &'static str,
    },
    /// A row has no number where it needs one.
    #[error("the profile cannot be used")]
    Row {
        /// Number of the row.
        row: u64,
        /// Reason, with the line in the file.
        #[source]
        source: TableError,
    },
    /// The table has too many rows.
    #[error("the profile has {rows} rows; allowed: {most} at most")]
    TooLong {
        /// Number of rows.
        rows: usize,
        /// Most rows that are allowed.
        most: usize,
    },
    /// The times and the flows are not equally many.
    #[error("the profile has {times} times and {flows} flows; give a flow for each time")]
    Unequal {
        /// Number of times.
        times: usize,
        /// Number of flows.
        flows: usize,
    },
}
