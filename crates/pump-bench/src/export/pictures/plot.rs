//! The picture of a dose or a run as SVG: flows, pressures, speed and delivered volume over time.

use std::f64::consts::TAU;

use pump_model::units::rpm;

use super::chart::{BLUE, Chart, Curve, GREEN, GREY, Panel, Style, VERMILION};
use crate::export::PlotError;
use crate::simulation::Sample;

/// Number of bins over the width. Each keeps its smallest and its largest value, so that pulses narrower than
/// a pixel stay visible.
const BINS: usize = 1500;

/// Figures that a picture shows beside the waveform.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Marks {
    /// End of the motion, in s.
    pub motion_s: Option<f64>,
    /// Volume that was asked for, in mL, negative in reverse.
    pub asked_ml: Option<f64>,
    /// Mean volume of a revolution, in mL: the volume by this one constant is drawn beside the delivered one.
    pub revolution_ml: Option<f64>,
}

/// Draws a waveform as SVG with a `title` on top. A panel whose curves keep one value is left out.
///
/// # Errors
/// Returns the [`PlotError`] of a picture that cannot be drawn.
pub fn waveform_svg(title: &str, samples: &[Sample], marks: &Marks) -> Result<String, PlotError> {
    let curve = |label, colour, style, value: &dyn Fn(&Sample) -> f64| Curve {
        label,
        colour,
        style,
        points: envelope(samples, |sample| (sample.time_s, value(sample))),
    };
    // The ports share a flow and a pressure over long stretches, so the inlet lies as a band under the outlet.
    let ports = |label, inlet: &dyn Fn(&Sample) -> f64, outlet: &dyn Fn(&Sample) -> f64| Panel {
        label,
        curves: vec![
            curve("inlet", BLUE, Style::Band, inlet),
            curve("outlet", VERMILION, Style::Line, outlet),
        ],
    };
    let start_s = samples.first().map_or(0.0, |sample| sample.time_s);
    let end_s = samples.last().map_or(1.0, |sample| sample.time_s).max(start_s + 1e-9);
    let mut volumes = Vec::new();
    if let Some(asked_ml) = marks.asked_ml {
        let points = vec![(start_s, asked_ml), (end_s, asked_ml)];
        volumes.push(Curve { label: "requested", colour: GREEN, style: Style::Line, points });
    }
    if let (Some(revolution_ml), Some(first)) = (marks.revolution_ml, samples.first()) {
        let by_constant = |s: &Sample| (s.angle_rad - first.angle_rad) / TAU * revolution_ml;
        volumes.push(curve("by one constant", GREY, Style::Line, &by_constant));
    }
    volumes.push(curve("vessel", VERMILION, Style::Line, &|s| s.delivered_ml));
    let panels = [
        ports("flow at the rollers, mL/s", &|s| s.q_in_ml_s, &|s| s.q_out_ml_s),
        ports("pressure, kPa absolute", &|s| s.p_in_kpa, &|s| s.p_out_kpa),
        Panel {
            label: "speed, r/min",
            curves: vec![curve("pump head", BLUE, Style::Line, &|s| rpm(s.speed_rad_s))],
        },
        Panel { label: "delivered, mL", curves: volumes },
    ];
    let chart = Chart {
        title,
        label: "time, s",
        range: start_s..end_s,
        mark: marks.motion_s.map(|motion_s| (motion_s, "last step")),
        panel_height: 275,
        panels: panels.into_iter().filter(varies).collect(),
    };
    chart.svg()
}

/// Returns true if a curve of the panel takes more than one value.
fn varies(panel: &Panel) -> bool {
    panel.curves.iter().any(|curve| {
        let values = || curve.points.iter().map(|point| point.1);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        high - low > 1e-9 * high.abs().max(low.abs())
    })
}

/// Returns a curve with at most two points a bin: the smallest and the largest value, in order of time.
pub(super) fn envelope<T>(samples: &[T], point: impl Fn(&T) -> (f64, f64)) -> Vec<(f64, f64)> {
    let per_bin = samples.len().div_ceil(BINS).max(1);
    if per_bin <= 2 {
        return samples.iter().map(point).collect();
    }
    let mut points = Vec::with_capacity(2 * BINS + 2);
    for bin in samples.chunks(per_bin) {
        let all = || bin.iter().map(&point);
        let by_value = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1);
        if let (Some(low), Some(high)) = (all().min_by(by_value), all().max_by(by_value)) {
            let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
            points.extend([first, second]);
        }
    }
    points.extend(samples.last().map(point));
    points
}
