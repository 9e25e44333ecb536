//! Draws the pictures of the page.

use std::error::Error;

use pump_bench::export::{BLUE, Chart, Colour, Curve, GREEN, PURPLE, Panel, Style, VERMILION};

use crate::back_flow::BackFlows;
use crate::dose_error::DoseError;

/// Points over a horizontal axis.
type Points = Vec<(f64, f64)>;

fn line(label: &'static str, colour: Colour, points: &Points) -> Curve {
    Curve { label, colour, style: Style::Line, points: points.clone() }
}

fn over_angle(title: &str, panel_height: u32, panels: Vec<Panel>) -> Result<String, Box<dyn Error>> {
    let label = "start angle, deg";
    Ok(Chart { title, label, range: 0.0..120.0, mark: None, panel_height, panels }.svg()?)
}

/// Draws the errors of a small and a large dose over the start angle.
pub(crate) fn error_over_angle(small: &DoseError, large: &DoseError) -> Result<String, Box<dyn Error>> {
    let panel = |label, errors: &DoseError| Panel {
        label,
        curves: vec![
            line("one constant", VERMILION, &errors.one_constant),
            line("planned, pump and angle depart", GREEN, &errors.departing),
            line("planned from the angle", BLUE, &errors.planned),
        ],
    };
    let panels = vec![panel("error of 1 mL, mL", small), panel("error of 25 mL, mL", large)];
    over_angle("Error at the rollers over the start angle", 320, panels)
}

/// Draws the largest errors over the volume of the dose.
pub(crate) fn error_over_volume(naive: &Points, departing: &Points) -> Result<String, Box<dyn Error>> {
    let curves = vec![
        line("one constant", VERMILION, naive),
        line("planned, pump and angle depart", GREEN, departing),
    ];
    let panels = vec![Panel { label: "largest error, % of the dose", curves }];
    let end = naive.last().map_or(1.0, |point| point.0);
    let title = "Largest error over all start angles";
    let label = "volume of the dose, mL";
    Ok(Chart { title, label, range: 0.0..end, mark: None, panel_height: 340, panels }.svg()?)
}

/// Draws the back flow of two doses over the start angle.
pub(crate) fn back_flow_over_angle(
    doses: [(&'static str, &BackFlows, &BackFlows); 2],
) -> Result<String, Box<dyn Error>> {
    let panels = doses.map(|(label, fastest, aware)| Panel {
        label,
        curves: vec![
            line("fastest ramps", VERMILION, &fastest.nominal_ul),
            line("line-aware ramps", BLUE, &aware.nominal_ul),
            line("line-aware, C 20 % less", GREEN, &aware.stiffer_ul),
            line("line-aware, C 20 % more", PURPLE, &aware.softer_ul),
        ],
    });
    over_angle("Back flow over the start angle", 320, panels.into())
}

/// Draws the largest back flow over the volume of the dose, a panel for each rate.
pub(crate) fn back_flow_over_volume(
    rates: [(&'static str, &Points, &Points); 2],
) -> Result<String, Box<dyn Error>> {
    let panels = rates.map(|(label, fastest, aware)| Panel {
        label,
        curves: vec![line("fastest ramps", VERMILION, fastest), line("line-aware ramps", BLUE, aware)],
    });
    let end = rates[0].1.last().map_or(1.0, |point| point.0);
    let title = "Largest back flow over all start angles";
    let label = "volume of the dose, mL";
    Ok(Chart { title, label, range: 0.0..end, mark: None, panel_height: 300, panels: panels.into() }.svg()?)
}
