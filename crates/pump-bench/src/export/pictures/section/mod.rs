//! The section through a pump head as SVG, to scale, with its dimensions by name.

mod dimensions;
mod head;
mod svg;

use pump_model::Geometry;
use pump_model::units::degrees;

use crate::numbers::significant;
use svg::{Svg, View};

/// Size of the picture, in px.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 760.0;

/// Thickness of the backplate in the picture, in mm over its radius.
const PLATE: f64 = 0.09;

/// Draws the section through a pump head as SVG, with a `title` on top. Its dimensions have the names under which a new
/// pump is described: tube, backplate, roller, offset, contact and rollers.
///
/// ```
/// use pump_bench::export::section_svg;
/// use pump_model::{Geometry, Variant};
///
/// let svg = section_svg("three-roller", &Geometry::published(3, Variant::Measured));
/// assert!(svg.contains("backplate 63 mm") && svg.contains("tube 10 x 14 mm"));
/// assert!(svg.contains("prefers-color-scheme:dark"));
/// ```
pub fn section_svg(title: &str, geometry: &Geometry) -> String {
    let mut svg = Svg::new(WIDTH, HEIGHT);
    let reach_mm = geometry.backplate_radius_mm * (1.0 + PLATE);
    let view = View { centre: (470.0, 375.0), scale: 265.0 / reach_mm };
    svg.text((WIDTH / 2.0, 34.0), &format!("{title}: {} rollers", geometry.rollers), "middle", 20.0);
    head::draw(&mut svg, &view, geometry);
    dimensions::draw(&mut svg, &view, geometry);
    let walls_mm = 2.0 * (geometry.tube_outer_radius_mm - geometry.bore_radius_mm);
    let gap_mm = geometry.backplate_radius_mm - geometry.roller_offset_mm - geometry.roller_radius_mm;
    let note = format!(
        "A roller leaves {} mm to the backplate (backplate - offset - roller), and two walls of the tube are {} mm. \
         The \
         backplate spans {}°.",
        millimetres(gap_mm),
        millimetres(walls_mm),
        significant(180.0 + 2.0 * degrees(geometry.contact_angle_rad), 4)
    );
    svg.text((WIDTH / 2.0, HEIGHT - 18.0), &note, "middle", 14.0);
    svg.finish()
}

/// Words a length in mm without digits that rounding made.
fn millimetres(mm: f64) -> String {
    significant((1e6 * mm).round() / 1e6, 4)
}
