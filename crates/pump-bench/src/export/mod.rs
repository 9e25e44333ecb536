//! Files that a bench writes: CSV, pictures and Rust source.

mod csv;
mod fitted;
#[cfg(feature = "plot")]
mod pictures;
mod plot_error;
mod rust_source;

pub(crate) use csv::TRACE_HEADER;
pub use csv::{write_flow_steps, write_samples, write_steps};
pub use fitted::{Axes, Fitted};
#[cfg(feature = "plot")]
pub(crate) use pictures::tube_svg;
#[cfg(feature = "plot")]
pub use pictures::{
    BLUE, Chart, Colour, Curve, GREEN, GREY, Marks, PURPLE, Panel, Style, VERMILION, fit_svg, section_svg,
    waveform_svg,
};
pub use plot_error::PlotError;
pub use rust_source::rust_source;
