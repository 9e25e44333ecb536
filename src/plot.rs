//! One picture of a dose: flows, pressures, speed and delivered volume over time, as SVG.

use plotters::prelude::*;
use pump_model::math::rpm;
use thiserror::Error;

use crate::sample::Sample;

/// Width and height of the picture, px.
const SIZE: (u32, u32) = (900, 1100);
/// The drawing is this much finer than the picture, since its points are whole pixels.
const FINE: u32 = 4;
/// Bins over the width: each keeps its smallest and largest value, so that pulses narrower than a pixel stay visible.
const BINS: usize = 1500;

/// Colours that stay apart for colour-blind readers (Okabe and Ito, 2008).
const BLUE: RGBColor = RGBColor(0, 114, 178);
const VERMILION: RGBColor = RGBColor(213, 94, 0);

/// A length of the picture in pixels of the drawing.
fn px(length: u32) -> i32 {
    (length * FINE) as i32
}

/// A picture that could not be drawn.
#[derive(Debug, Error)]
#[error("the plot could not be drawn: {0}")]
pub struct PlotError(String);

/// A curve of one panel.
struct Curve {
    label: &'static str,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

/// SVG of a waveform; `title` stands on top, `motion_s` is marked as the end of motion where it is given.
pub fn svg(title: &str, samples: &[Sample], motion_s: Option<f64>) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, title, samples, motion_s).map_err(|error| PlotError(error.to_string()))?;
    let size = |scale| format!("width=\"{}\" height=\"{}\"", SIZE.0 * scale, SIZE.1 * scale);
    // The view box keeps the fine size.
    Ok(svg.replacen(&size(FINE), &size(1), 1))
}

fn draw(
    svg: &mut String,
    title: &str,
    samples: &[Sample],
    motion_s: Option<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (SIZE.0 * FINE, SIZE.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.margin(px(8), 0, 0, 0).titled(title, ("sans-serif", px(20)))?;
    let panels = root.split_evenly((4, 1));
    let curve =
        |label, colour, value: fn(&Sample) -> f64| Curve { label, colour, points: envelope(samples, value) };
    let contents = [
        (
            "flow at the rollers, mL/s",
            vec![curve("inlet", BLUE, |s| s.q_in_ml_s), curve("outlet", VERMILION, |s| s.q_out_ml_s)],
        ),
        (
            "pressure, kPa absolute",
            vec![curve("inlet", BLUE, |s| s.p_in_kpa), curve("outlet", VERMILION, |s| s.p_out_kpa)],
        ),
        ("speed, r/min", vec![curve("pump head", BLUE, |s| rpm(s.speed_rad_s))]),
        ("delivered, mL", vec![curve("vessel", VERMILION, |s| s.delivered_ml)]),
    ];
    let end_s = samples.last().map_or(1.0, |sample| sample.time_s).max(1e-9);
    for (n, ((label, curves), panel)) in contents.iter().zip(&panels).enumerate() {
        let (low, high) = range(curves);
        // Room for the legend above the curves.
        let high = if curves.len() > 1 { high + 0.25 * (high - low) } else { high };
        let mut chart = ChartBuilder::on(panel)
            .margin_left(px(14))
            .margin_right(px(20))
            .margin_top(px(8))
            .x_label_area_size(px(if n == 3 { 40 } else { 22 }))
            .y_label_area_size(px(60))
            .build_cartesian_2d(0.0..end_s, low..high)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(BLACK.mix(0.12))
            .x_desc(if n == 3 { "time, s" } else { "" })
            .y_desc(*label)
            .y_labels(6)
            .label_style(("sans-serif", px(13)))
            .axis_desc_style(("sans-serif", px(14)))
            .draw()?;
        if let Some(motion_s) = motion_s {
            let line =
                LineSeries::new([(motion_s, low), (motion_s, high)], BLACK.mix(0.4).stroke_width(FINE));
            let drawn = chart.draw_series(line)?;
            if n == 0 {
                drawn.label("last step").legend(|(x, y)| {
                    PathElement::new([(x, y), (x + px(16), y)], BLACK.mix(0.4).stroke_width(FINE))
                });
            }
        }
        for curve in curves {
            let colour = curve.colour;
            chart
                .draw_series(LineSeries::new(
                    curve.points.iter().copied(),
                    colour.stroke_width(FINE * 5 / 4),
                ))?
                .label(curve.label)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + px(16), y)], colour.stroke_width(FINE * 2))
                });
        }
        if curves.len() == 1 {
            continue;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .legend_area_size(px(20))
            .margin(px(4))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.2))
            .label_font(("sans-serif", px(13)))
            .draw()?;
    }
    root.present()?;
    Ok(())
}

/// The axis range of a panel: its curves with a little room.
fn range(curves: &[Curve]) -> (f64, f64) {
    let values = curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.1));
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    // A flat curve gets room too, or its axis would show rounding.
    let room = (0.06 * (high - low)).max(1e-3 * high.abs()).max(1e-9);
    (low - room, high + room)
}

/// The curve with at most two points a bin, its smallest and its largest, in order of time.
fn envelope(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> Vec<(f64, f64)> {
    let per_bin = samples.len().div_ceil(BINS).max(1);
    if per_bin <= 2 {
        return samples.iter().map(|sample| (sample.time_s, value(sample))).collect();
    }
    let point = |sample: &Sample| (sample.time_s, value(sample));
    let mut points = Vec::with_capacity(2 * BINS + 2);
    for bin in samples.chunks(per_bin) {
        let by_value = |a: &&Sample, b: &&Sample| value(a).total_cmp(&value(b));
        if let (Some(low), Some(high)) = (bin.iter().min_by(by_value), bin.iter().max_by(by_value)) {
            let (first, second) = if low.time_s <= high.time_s { (low, high) } else { (high, low) };
            points.extend([point(first), point(second)]);
        }
    }
    points.extend(samples.last().map(point));
    points
}
