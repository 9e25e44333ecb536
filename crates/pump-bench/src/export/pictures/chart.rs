//! Pictures as SVG: panels below one another, with curves or points over one horizontal axis.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::export::PlotError;

/// Size of a picture, of its letters and of the room for them, in px.
#[derive(Debug, Clone, Copy)]
struct Look {
    width: u32,
    title: u32,
    letters: u32,
    below: u32,
    beside: u32,
    /// Most numbers at the horizontal axis.
    numbers: usize,
    /// Room above the curves for each name of the legend, as a part of their height.
    name: f64,
}

/// The look on a screen.
const WIDE: Look =
    Look { width: 900, title: 20, letters: 13, below: 40, beside: 60, numbers: 11, name: 0.09 };
/// The look on a phone too, whose 330 px leave letters of 11 px (a font of n px is drawn with n/1.24).
const NARROW: Look =
    Look { width: 480, title: 22, letters: 20, below: 50, beside: 62, numbers: 7, name: 0.16 };

/// Height of a panel from which on its vertical axis has twice as many numbers, in px.
const HIGH: u32 = 360;
/// Factor by which the drawing is finer than the picture, since its points are whole pixels.
const FINE: u32 = 4;

/// The colour of a curve: red, green and blue, 0 to 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour {
    /// Red.
    pub(crate) red: u8,
    /// Green.
    pub(crate) green: u8,
    /// Blue.
    pub(crate) blue: u8,
}

/// Blue that colour-blind readers tell from the other colours (Okabe and Ito, 2008).
pub const BLUE: Colour = Colour { red: 0, green: 114, blue: 178 };
/// Vermilion that colour-blind readers tell from the other colours (Okabe and Ito, 2008).
pub const VERMILION: Colour = Colour { red: 213, green: 94, blue: 0 };
/// Green that colour-blind readers tell from the other colours (Okabe and Ito, 2008).
pub const GREEN: Colour = Colour { red: 0, green: 158, blue: 115 };
/// Purple that colour-blind readers tell from the other colours (Okabe and Ito, 2008).
pub const PURPLE: Colour = Colour { red: 204, green: 121, blue: 167 };

/// Grey of limits, marks and what only serves comparison.
pub const GREY: Colour = Colour { red: 119, green: 119, blue: 119 };

/// Colours on a dark screen, which is where the reader asked for one. The blue gives way to Okabe and Ito's sky blue.
const DARK: &str = "<style>@media (prefers-color-scheme:dark){\
    [fill=\"#FFFFFF\"]{fill:#15181c}[stroke=\"#FFFFFF\"]{stroke:#15181c}\
    [stroke=\"#000000\"]{stroke:#e8e8e8}[fill=\"#000000\"],text{fill:#e8e8e8}\
    [stroke=\"#0072B2\"]{stroke:#56b4e9}[fill=\"#0072B2\"]{fill:#56b4e9}\
    [stroke=\"#777777\"]{stroke:#a8a8a8}[fill=\"#777777\"]{fill:#a8a8a8}}</style>\n";

/// A style in which a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Line through the points of the curve.
    Line,
    /// Broad pale line, which stays visible under a line that runs on it.
    Band,
    /// Pale area that the points enclose. It lies under the lines that a panel names after it.
    Area,
    /// Points of the curve alone.
    Points,
    /// Points with their values above them: rounded to a whole number, and followed by the curve's label, which is the
    /// unit. They stand in no legend.
    Values,
}

/// A curve of one panel.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Name of the curve in the legend. A curve without one stands in no legend.
    pub label: &'static str,
    /// Colour of the curve, one of this module's.
    pub colour: Colour,
    /// Style of the curve.
    pub style: Style,
    /// Points of the curve as (horizontal, vertical), in order.
    pub points: Vec<(f64, f64)>,
}

/// Curves over one vertical axis. A legend names them if there are several.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Name of the vertical axis, with its unit.
    pub label: &'static str,
    /// Curves of the panel.
    pub curves: Vec<Curve>,
}

/// A picture of panels below one another.
#[derive(Debug, Clone)]
pub struct Chart<'a> {
    /// Title on top of the picture.
    pub title: &'a str,
    /// Name of the horizontal axis, with its unit.
    pub label: &'a str,
    /// Range of the horizontal axis.
    pub range: Range<f64>,
    /// Place on the horizontal axis to mark, and the name of the mark.
    pub mark: Option<(f64, &'static str)>,
    /// Height of a panel, in px.
    pub panel_height: u32,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
}

/// Area of the drawing in which one panel stands.
type Area<'s> = DrawingArea<SVGBackend<'s>, Shift>;

/// Coordinates of one panel, ready for its curves.
type Plane<'a, 's> = ChartContext<'a, SVGBackend<'s>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Returns a length of the picture in pixels of the drawing.
fn px(length: u32) -> i32 {
    (length * FINE) as i32
}

impl Chart<'_> {
    /// Draws the picture as SVG.
    ///
    /// # Errors
    /// Returns the [`PlotError`] of a picture that cannot be drawn.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.svg_of(WIDE)
    }

    /// Draws a narrow picture with large letters as SVG, which is readable on a phone. Its labels must be short.
    ///
    /// # Errors
    /// Returns the [`PlotError`] of a picture that cannot be drawn.
    pub fn narrow_svg(&self) -> Result<String, PlotError> {
        self.svg_of(NARROW)
    }

    fn svg_of(&self, look: Look) -> Result<String, PlotError> {
        let mut svg = String::new();
        let size = (look.width, self.panel_height * self.panels.len() as u32);
        self.draw(&mut svg, size, look).map_err(|error| PlotError { reason: error.to_string() })?;
        let size = |scale| format!("width=\"{}\" height=\"{}\"", size.0 * scale, size.1 * scale);
        // The view box keeps the fine size.
        let svg = svg.replacen(&size(FINE), &size(1), 1);
        let (head, body) = svg.split_once('\n').unwrap_or((&svg, ""));
        Ok(format!("{head}\n{DARK}{body}"))
    }

    /// Draws the panels into `svg`; `size` is the picture's width and height, in px.
    fn draw(&self, svg: &mut String, size: (u32, u32), look: Look) -> Result<(), Box<dyn Error>> {
        let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
        root.fill(&WHITE)?;
        let root = root.margin(px(8), 0, 0, 0).titled(self.title, ("sans-serif", px(look.title)))?;
        let areas = root.split_evenly((self.panels.len(), 1));
        for (n, (panel, area)) in self.panels.iter().zip(&areas).enumerate() {
            self.draw_panel(n, panel, area, look)?;
        }
        root.present()?;
        Ok(())
    }

    /// Draws the panel with this number, from 0 at the top.
    fn draw_panel(&self, n: usize, panel: &Panel, area: &Area<'_>, look: Look) -> Result<(), Box<dyn Error>> {
        let (low, high) = range(&panel.curves);
        // Room for the legend above the curves.
        let entries = panel.curves.iter().filter(|curve| curve.style != Style::Values).count();
        let room = if entries > 1 { (look.name * entries as f64).max(0.25) } else { 0.0 };
        let high = high + room * (high - low);
        let is_last = n + 1 == self.panels.len();
        let mut plane = ChartBuilder::on(area)
            .margin_left(px(14))
            .margin_right(px(20))
            .margin_top(px(8))
            .x_label_area_size(px(if is_last { look.below } else { 22 }))
            .y_label_area_size(px(look.beside))
            .build_cartesian_2d(self.range.clone(), low..high)?;
        plane
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(BLACK.mix(0.12))
            .x_desc(if is_last { self.label } else { "" })
            .y_desc(panel.label)
            .x_labels(look.numbers)
            .y_labels(if self.panel_height < HIGH { 6 } else { 12 })
            .x_label_formatter(&shortest)
            .y_label_formatter(&shortest)
            .label_style(("sans-serif", px(look.letters)))
            .axis_desc_style(("sans-serif", px(look.letters + 1)))
            .draw()?;
        if let Some((place, name)) = self.mark {
            let line = LineSeries::new([(place, low), (place, high)], BLACK.mix(0.4).stroke_width(FINE));
            let drawn = plane.draw_series(line)?;
            if n == 0 {
                drawn.label(name).legend(|(x, y)| {
                    PathElement::new([(x, y), (x + px(16), y)], BLACK.mix(0.4).stroke_width(FINE))
                });
            }
        }
        for curve in &panel.curves {
            curve.draw(&mut plane, look)?;
        }
        if entries != 1 {
            draw_legend(&mut plane, look)?;
        }
        Ok(())
    }
}

impl Curve {
    /// Draws the curve and names it for the legend.
    fn draw(&self, plane: &mut Plane<'_, '_>, look: Look) -> Result<(), Box<dyn Error>> {
        let Colour { red, green, blue } = self.colour;
        let colour = RGBColor(red, green, blue);
        let points = self.points.iter().copied();
        let width = match self.style {
            Style::Values => return self.draw_values(plane, colour, look),
            Style::Area => return self.draw_area(plane, colour),
            Style::Points => {
                let drawn =
                    plane.draw_series(points.map(|point| Circle::new(point, px(3), colour.filled())))?;
                if !self.label.is_empty() {
                    drawn
                        .label(self.label)
                        .legend(move |(x, y)| Circle::new((x + px(8), y), px(3), colour.filled()));
                }
                return Ok(());
            }
            Style::Line => FINE * 5 / 4,
            Style::Band => FINE * 5,
        };
        let shade = if self.style == Style::Band { colour.mix(0.4) } else { colour.mix(1.0) };
        let drawn = plane.draw_series(LineSeries::new(points, shade.stroke_width(width)))?;
        if !self.label.is_empty() {
            drawn.label(self.label).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + px(16), y)], shade.stroke_width(width.max(FINE * 2)))
            });
        }
        Ok(())
    }

    /// Draws the area that the points enclose.
    fn draw_area(&self, plane: &mut Plane<'_, '_>, colour: RGBColor) -> Result<(), Box<dyn Error>> {
        let shade = colour.mix(0.35).filled();
        let drawn = plane.draw_series([Polygon::new(self.points.clone(), shade)])?;
        if !self.label.is_empty() {
            drawn
                .label(self.label)
                .legend(move |(x, y)| Rectangle::new([(x, y - px(5)), (x + px(16), y + px(5))], shade));
        }
        Ok(())
    }

    /// Draws points with their values above them.
    fn draw_values(
        &self,
        plane: &mut Plane<'_, '_>,
        colour: RGBColor,
        look: Look,
    ) -> Result<(), Box<dyn Error>> {
        let font = TextStyle::from(("sans-serif", px(look.letters)).into_font());
        plane.draw_series(self.points.iter().map(|point| {
            let words = format!("{:.0}{}", point.1, self.label);
            let above = Text::new(words, (-px(look.letters + 1), -px(look.letters + 11)), font.clone());
            EmptyElement::at(*point) + Circle::new((0, 0), px(4), colour.filled()) + above
        }))?;
        Ok(())
    }
}

/// Returns the number at a mark of an axis without needless decimals.
fn shortest(value: &f64) -> String {
    let digits = format!("{value:.9}");
    match digits.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_owned(),
        short => short.to_owned(),
    }
}

/// Draws the legend of a panel in its upper right corner.
fn draw_legend<'a, 's: 'a>(plane: &mut Plane<'a, 's>, look: Look) -> Result<(), Box<dyn Error>> {
    plane
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .legend_area_size(px(20))
        .margin(px(4))
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2))
        .label_font(("sans-serif", px(look.letters)))
        .draw()?;
    Ok(())
}

/// Returns the range of a panel's vertical axis: the range of its curves with a little room.
fn range(curves: &[Curve]) -> (f64, f64) {
    let values = curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.1));
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    // A flat curve gets room too, or else its axis would show rounding.
    let room = (0.06 * (high - low)).max(1e-3 * high.abs()).max(1e-9);
    (low - room, high + room)
}
