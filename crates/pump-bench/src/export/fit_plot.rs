//! One picture of a fit: what was measured and what was fitted, and below what the fit leaves over, as SVG.

use super::plot::envelope;
use crate::export::{BLUE, Chart, Curve, Panel, PlotError, Style, VERMILION};

/// More points than this are drawn as a line.
const MOST_POINTS: usize = 300;

/// A measurement beside its fit, as people see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// Where on the horizontal axis.
    pub x: f64,
    /// What was measured.
    pub measured: f64,
    /// What the fit says there.
    pub fitted: f64,
}

/// Names of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axes {
    /// Of the horizontal axis, with its unit.
    pub x: &'static str,
    /// Of what was measured, with its unit.
    pub y: &'static str,
    /// Of measured less fitted, with its unit.
    pub left: &'static str,
}

/// SVG of a fit; `points` in order of x.
pub fn svg(title: &str, axes: Axes, points: &[Fitted]) -> Result<String, PlotError> {
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
