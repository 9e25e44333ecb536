//! The report of a rack: a row a pump, and a total.

mod pump_row;
mod rack_report;
mod text;

pub use pump_row::{RackDose, RackPumpReport};
pub use rack_report::{RackEnd, RackFault, RackReport, RackTotal};
