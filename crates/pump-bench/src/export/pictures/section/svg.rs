//! Shapes and texts of an SVG, and the view from mm to px.

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::export::pictures::Colour;

/// A point of the picture in px, or of the head in mm.
pub(super) type Point = (f64, f64);

/// Colour of outlines and texts.
pub(super) const INK: Colour = Colour { red: 40, green: 40, blue: 40 };

/// Colours on a dark screen, which is where the reader asked for one. Areas are dark there, and what lies on them is
/// light.
const DARK: &str = "<style>@media (prefers-color-scheme:dark){\
    [fill=\"white\"]{fill:#15181c}\
    [fill=\"#282828\"]{fill:#e8e8e8}[stroke=\"#282828\"]{stroke:#e8e8e8}\
    [fill=\"#0072b2\"]{fill:#56b4e9}[stroke=\"#0072b2\"]{stroke:#56b4e9}\
    [fill=\"#9aa0a6\"]{fill:#5f656b}[fill=\"#e8c9a0\"]{fill:#7d6341}[fill=\"#cfe8f7\"]{fill:#2a4f63}\
    [fill=\"#ececef\"]{fill:#33373d}[fill=\"#404040\"]{fill:#c8c8c8}\
    [stroke=\"#5f4b32\"]{stroke:#c9b18a}[stroke=\"#aaaaaf\"]{stroke:#74787e}}</style>";

/// The view of the head: the shaft's place in px, and px per mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) centre: Point,
    pub(super) scale: f64,
}

impl View {
    /// Returns the place of a point of the head in mm, whose y points up.
    pub(super) fn at(&self, (x_mm, y_mm): Point) -> Point {
        (self.centre.0 + self.scale * x_mm, self.centre.1 - self.scale * y_mm)
    }

    /// Returns the place at a polar angle in rad and a distance from the shaft in mm.
    pub(super) fn polar(&self, angle_rad: f64, radius_mm: f64) -> Point {
        self.at((radius_mm * angle_rad.cos(), radius_mm * angle_rad.sin()))
    }
}

/// An SVG that grows.
pub(super) struct Svg {
    text: String,
}

impl Svg {
    /// Begins a picture of this size in px, white by day and dark on a dark screen.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n"
        );
        let _ = writeln!(text, "{DARK}");
        let _ = writeln!(text, "<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>");
        Self { text }
    }

    /// Draws a filled area.
    pub(super) fn area(&mut self, points: &[Point], fill: &str) {
        let points = list(points);
        let _ = writeln!(self.text, "<polygon points=\"{points}\" fill=\"{fill}\"/>");
    }

    /// Draws a line through points.
    pub(super) fn line(&mut self, points: &[Point], colour: Colour, width: f64) {
        let (points, colour) = (list(points), hex(colour));
        let _ = writeln!(
            self.text,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        );
    }

    /// Draws a disc with an outline.
    pub(super) fn disc(&mut self, (x, y): Point, radius: f64, fill: &str) {
        let ink = hex(INK);
        let _ = writeln!(
            self.text,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{fill}\" stroke=\"{ink}\" \
             stroke-width=\"1.2\"/>"
        );
    }

    /// Draws an arrow from one point to another. Its head is on the second, and on the first too if it is `double`.
    pub(super) fn arrow(&mut self, from: Point, to: Point, colour: Colour, double: bool) {
        self.line(&[from, to], colour, 2.0);
        self.tip(from, to, colour);
        if double {
            self.tip(to, from, colour);
        }
    }

    /// Draws the head of an arrow that points from one point to another.
    pub(super) fn tip(&mut self, from: Point, to: Point, colour: Colour) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1e-9);
        let (along, across) = ((dx / length, dy / length), (-dy / length, dx / length));
        // A short arrow has a head that leaves room for its shaft.
        let size = 11.0_f64.min(0.4 * length);
        let corner = |side: f64| {
            let back = (to.0 - size * along.0, to.1 - size * along.1);
            (back.0 + side * 0.36 * size * across.0, back.1 + side * 0.36 * size * across.1)
        };
        self.area(&[to, corner(1.0), corner(-1.0)], &hex(colour));
    }

    /// Writes a text. `anchor` is start, middle or end.
    pub(super) fn text(&mut self, (x, y): Point, words: &str, anchor: &str, size: f64) {
        let words = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let ink = hex(INK);
        let _ = writeln!(
            self.text,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size}\" \
             fill=\"{ink}\">{words}</text>"
        );
    }

    /// Returns the picture.
    pub(super) fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Returns the points of an arc around the shaft, from one polar angle to another.
pub(super) fn arc(view: &View, radius_mm: f64, from_rad: f64, to_rad: f64) -> Vec<Point> {
    let steps = (180.0 * (to_rad - from_rad).abs() / TAU).ceil().max(2.0) as u32;
    (0..=steps)
        .map(|n| view.polar(from_rad + (to_rad - from_rad) * f64::from(n) / f64::from(steps), radius_mm))
        .collect()
}

fn list(points: &[Point]) -> String {
    points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

fn hex(colour: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue)
}
