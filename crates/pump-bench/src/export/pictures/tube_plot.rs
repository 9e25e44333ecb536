//! The picture of a tube's calibrations as SVG.

use super::chart::{BLUE, Chart, Curve, Panel, Style, VERMILION};
use crate::export::PlotError;

/// Draws factors over days as SVG. Each point is a day, a factor, and its expanded uncertainty.
///
/// # Errors
/// Returns the [`PlotError`] of a picture that cannot be drawn.
pub(crate) fn tube_svg(title: &str, points: &[(f64, f64, f64)]) -> Result<String, PlotError> {
    if points.is_empty() {
        let reason = "this tube has no calibration on record; calibrate it first".to_owned();
        return Err(PlotError { reason });
    }
    let days = points.iter().map(|(day, ..)| *day).fold(0.0, f64::max);
    let room = (0.03 * days).max(0.5);
    let curve = |label, colour, style, value: fn(&(f64, f64, f64)) -> f64| Curve {
        label,
        colour,
        style,
        points: points.iter().map(|point| (point.0, value(point))).collect(),
    };
    let chart = Chart {
        title,
        label: "days since the first calibration",
        range: -room..days + room,
        mark: None,
        panel_height: 320,
        panels: vec![Panel {
            label: "measured over model volume",
            curves: vec![
                curve("factor", BLUE, Style::Points, |point| point.1),
                curve("bound", VERMILION, Style::Line, |point| point.1 + point.2),
                curve("", VERMILION, Style::Line, |point| point.1 - point.2),
            ],
        }],
    };
    chart.svg()
}
