//! Pictures as SVG.

mod chart;
mod fit_plot;
mod plot;
mod section;
mod tube_plot;

pub use chart::{BLUE, Chart, Colour, Curve, GREEN, GREY, PURPLE, Panel, Style, VERMILION};
pub use fit_plot::fit_svg;
pub use plot::{Marks, waveform_svg};
pub use section::section_svg;
pub(crate) use tube_plot::tube_svg;
