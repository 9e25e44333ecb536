//! The picture of a dose as SVG: flows, pressures, speed and delivered volume over time.

use pump_model::units::rpm;

use super::chart::{BLUE, Chart, Curve, Panel, Style, VERMILION};
use crate::export::PlotError;
use crate::simulation::Sample;

/// Number of bins over the width. Each keeps its smallest and its largest value, so that pulses narrower than
/// a pixel stay visible.
const BINS: usize = 1500;

/// Draws a waveform as SVG with a `title` on top. `motion_s` marks the end of the motion, if it is given.
///
/// # Errors
/// Returns the [`PlotError`] of a picture that cannot be drawn.
pub fn waveform_svg(title: &str, samples: &[Sample], motion_s: Option<f64>) -> Result<String, PlotError> {
    let curve = |label, colour, value: fn(&Sample) -> f64| Curve {
        label,
        colour,
        style: Style::Line,
        points: envelope(samples, |sample| (sample.time_s, value(sample))),
    };
    let panel = |label, curves| Panel { label, curves };
    let end_s = samples.last().map_or(1.0, |sample| sample.time_s).max(1e-9);
    let chart = Chart {
        title,
        label: "time, s",
        range: 0.0..end_s,
        mark: motion_s.map(|motion_s| (motion_s, "last step")),
        panel_height: 275,
        panels: vec![
            panel(
                "flow at the rollers, mL/s",
                vec![curve("inlet", BLUE, |s| s.q_in_ml_s), curve("outlet", VERMILION, |s| s.q_out_ml_s)],
            ),
            panel(
                "pressure, kPa absolute",
                vec![curve("inlet", BLUE, |s| s.p_in_kpa), curve("outlet", VERMILION, |s| s.p_out_kpa)],
            ),
            panel("speed, r/min", vec![curve("pump head", BLUE, |s| rpm(s.speed_rad_s))]),
            panel("delivered, mL", vec![curve("vessel", VERMILION, |s| s.delivered_ml)]),
        ],
    };
    chart.svg()
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
