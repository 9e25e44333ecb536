//! The orders with their times, givers and ends: a file of SQLite that users may open.
//!
//! Journals and logs of the pumps are the truth about volumes. The history adds the orders, their keys, the events of
//! the service and the runs of the schedule. A history that was lost takes the doses over from the logs of the pumps.

mod error;
mod history;
mod logins;
mod marks;
mod record;

pub use self::error::HistoryError;
pub use self::history::History;
pub(crate) use self::marks::Marks;
pub use self::record::{EventRecord, Key, OrderRecord, OrderState};
