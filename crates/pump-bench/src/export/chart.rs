//! Pictures as SVG: panels below one another, each with curves or points over the same axis.

use std::ops::Range;

use plotters::prelude::*;
use thiserror::Error;

/// Width of a picture, px.
const WIDTH: u32 = 900;
/// The drawing is this much finer than the picture, since its points are whole pixels.
const FINE: u32 = 4;

/// The colour of a curve.
pub type Colour = RGBColor;
/// Colours that stay apart for colour-blind readers (Okabe and Ito, 2008).
pub const BLUE: Colour = RGBColor(0, 114, 178);
/// Another of them.
pub const VERMILION: Colour = RGBColor(213, 94, 0);
/// Another of them.
pub const GREEN: Colour = RGBColor(0, 158, 115);
/// Another of them.
pub const PURPLE: Colour = RGBColor(204, 121, 167);

/// A picture that could not be drawn.
#[derive(Debug, Error)]
#[error("the plot could not be drawn: {0}")]
pub struct PlotError(String);

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line through its points.
    Line,
    /// Its points alone.
    Points,
}

/// A curve of one panel.
pub struct Curve {
    /// Its name in the legend.
    pub label: &'static str,
    /// One of the colours of this module.
    pub colour: Colour,
    /// Line or points.
    pub style: Style,
    /// (horizontal, vertical), in order.
    pub points: Vec<(f64, f64)>,
}

/// Curves over one vertical axis; with more than one, a legend names them.
pub struct Panel {
    /// Name of the vertical axis, with its unit.
    pub label: &'static str,
    /// What is drawn.
    pub curves: Vec<Curve>,
}

/// A picture.
pub struct Chart<'a> {
    /// What stands on top.
    pub title: &'a str,
    /// Name of the horizontal axis, with its unit.
    pub label: &'a str,
    /// Of the horizontal axis.
    pub range: Range<f64>,
    /// Something that happens at one place of the horizontal axis, and its name.
    pub mark: Option<(f64, &'static str)>,
    /// Height of a panel, px.
    pub panel_height: u32,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// A length of the picture in pixels of the drawing.
fn px(length: u32) -> i32 {
    (length * FINE) as i32
}

impl Chart<'_> {
    /// The picture as SVG.
    pub fn svg(&self) -> Result<String, PlotError> {
        let mut svg = String::new();
        let size = (WIDTH, self.panel_height * self.panels.len() as u32);
        self.draw(&mut svg, size).map_err(|error| PlotError(error.to_string()))?;
        let size = |scale| format!("width=\"{}\" height=\"{}\"", size.0 * scale, size.1 * scale);
        // The view box keeps the fine size.
        Ok(svg.replacen(&size(FINE), &size(1), 1))
    }

    fn draw(&self, svg: &mut String, size: (u32, u32)) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
        root.fill(&WHITE)?;
        let root = root.margin(px(8), 0, 0, 0).titled(self.title, ("sans-serif", px(20)))?;
        let areas = root.split_evenly((self.panels.len(), 1));
        for (n, (panel, area)) in self.panels.iter().zip(&areas).enumerate() {
            let (low, high) = range(&panel.curves);
            // Room for the legend above the curves.
            let entries = panel.curves.len();
            let room = if entries > 1 { (0.09 * entries as f64).max(0.25) } else { 0.0 };
            let high = high + room * (high - low);
            let is_last = n + 1 == self.panels.len();
            let mut chart = ChartBuilder::on(area)
                .margin_left(px(14))
                .margin_right(px(20))
                .margin_top(px(8))
                .x_label_area_size(px(if is_last { 40 } else { 22 }))
                .y_label_area_size(px(60))
                .build_cartesian_2d(self.range.clone(), low..high)?;
            chart
                .configure_mesh()
                .light_line_style(WHITE)
                .bold_line_style(BLACK.mix(0.12))
                .x_desc(if is_last { self.label } else { "" })
                .y_desc(panel.label)
                .y_labels(6)
                .label_style(("sans-serif", px(13)))
                .axis_desc_style(("sans-serif", px(14)))
                .draw()?;
            if let Some((place, name)) = self.mark {
                let line = LineSeries::new([(place, low), (place, high)], BLACK.mix(0.4).stroke_width(FINE));
                let drawn = chart.draw_series(line)?;
                if n == 0 {
                    drawn.label(name).legend(|(x, y)| {
                        PathElement::new([(x, y), (x + px(16), y)], BLACK.mix(0.4).stroke_width(FINE))
                    });
                }
            }
            for curve in &panel.curves {
                let colour = curve.colour;
                let points = curve.points.iter().copied();
                match curve.style {
                    Style::Line => chart
                        .draw_series(LineSeries::new(points, colour.stroke_width(FINE * 5 / 4)))?
                        .label(curve.label)
                        .legend(move |(x, y)| {
                            PathElement::new([(x, y), (x + px(16), y)], colour.stroke_width(FINE * 2))
                        }),
                    Style::Points => chart
                        .draw_series(points.map(|point| Circle::new(point, px(3), colour.filled())))?
                        .label(curve.label)
                        .legend(move |(x, y)| Circle::new((x + px(8), y), px(3), colour.filled())),
                };
            }
            if panel.curves.len() == 1 {
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
