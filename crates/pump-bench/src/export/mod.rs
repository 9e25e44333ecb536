//! Files that a bench writes: CSV, pictures and Rust source.

mod chart;
pub mod csv;
pub mod fit_plot;
pub mod plot;
mod rust_source;

pub use chart::{BLUE, Chart, Colour, Curve, GREEN, PURPLE, Panel, PlotError, Style, VERMILION};
pub use fit_plot::{Axes, Fitted};
pub use rust_source::rust_source;
