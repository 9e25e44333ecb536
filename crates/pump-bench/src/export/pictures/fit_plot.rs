//! The picture of a fit as SVG: measurements and fit above, residuals below.

use super::chart::{BLUE, Chart, Curve, Panel, Style, VERMILION};
use super::plot::envelope;
use crate::export::{Axes, Fitted, PlotError};

/// Largest number of points that are drawn as points. More of them are drawn as a line.
const MOST_POINTS: usize = 300;

/// Draws a fit as SVG. `points` stand in order of x.
///
/// # Errors
/// Returns the [`PlotError`] of a picture that cannot be drawn.
pub fn fit_svg(title: &str, axes: Axes, points: &[Fitted]) -> Result<String, PlotError> {
    let style = if points.len() > MOST_POINTS { Style::Line } else { Style::Points };
    let curve = |label, colour, style, value: fn(&Fitted) -> f64| Curve {
        label,
        colour,
        style,
        points: envelope(points, |point| (point.x, value(point))),
    };
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point.x), high.max(point.x)));
    let room = if style == Style::Points { 0.03 * (high - low) } else { 0.0 }.max(1e-9);
    let chart = Chart {
        title,
        label: axes.x,
        range: low - room..high + room,
        mark: None,
        panel_height: 320,
        panels: vec![
            Panel {
                label: axes.y,
                curves: vec![
                    curve("measured", BLUE, style, |point| point.measured),
                    curve("fitted", VERMILION, Style::Line, |point| point.fitted),
                ],
            },
            Panel {
                label: axes.left,
                curves: vec![curve("left over", BLUE, style, |point| point.measured - point.fitted)],
            },
        ],
    };
    chart.svg()
}
