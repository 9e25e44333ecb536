//! The dimensions of the head, each with an arrow, its name and its value.

use std::f64::consts::FRAC_PI_2;

use pump_model::Geometry;
use pump_model::units::{degrees, radians};

use super::svg::{INK, Point, Svg, View, arc};
use super::{HEIGHT, PLATE, WIDTH, millimetres};
use crate::export::pictures::{BLUE, Colour, GREEN, PURPLE, VERMILION};
use crate::numbers::significant;

/// Size of the labels, in px.
const SIZE: f64 = 17.0;

/// Grey of the lines that lead from a label to its arrow.
const LEADER: Colour = Colour { red: 130, green: 130, blue: 130 };

/// Radius of the enlarged tube, in px, and its centre.
const TUBE: f64 = 58.0;
const TUBE_AT: Point = (888.0, HEIGHT - 190.0);

/// Draws every dimension. Labels stand in columns beside the head, so that none lies on another.
pub(super) fn draw(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let roller_rad = -FRAC_PI_2;
    let axis = view.polar(roller_rad, geometry.roller_offset_mm);
    svg.arrow(view.centre, axis, BLUE, true);
    let middle = (axis.0, 0.5 * (view.centre.1 + axis.1));
    label(svg, "offset", &format!("{} mm", millimetres(geometry.roller_offset_mm)), (20.0, middle.1), middle);

    let rim = (
        axis.0 - 0.94 * view.scale * geometry.roller_radius_mm,
        axis.1 + 0.34 * view.scale * geometry.roller_radius_mm,
    );
    svg.arrow(axis, rim, VERMILION, false);
    let at = (20.0, (rim.1 + 60.0).min(HEIGHT - 60.0));
    label(svg, "roller", &format!("{} mm", millimetres(geometry.roller_radius_mm)), at, rim);

    backplate(svg, view, geometry);
    contact(svg, view, geometry);
    tube(svg, view, geometry);
}

/// Draws the radius of the backplate between two rollers.
fn backplate(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let polar_rad = (0.5 * geometry.pitch_rad()).min(radians(50.0)) - FRAC_PI_2;
    let rim = view.polar(polar_rad, geometry.backplate_radius_mm);
    svg.arrow(view.centre, rim, GREEN, false);
    let words = format!("{} mm", millimetres(geometry.backplate_radius_mm));
    let outside = view.polar(polar_rad, (1.0 + PLATE) * geometry.backplate_radius_mm);
    let at = (WIDTH - 20.0, (outside.1 + 10.0).clamp(300.0, HEIGHT - 350.0));
    label(svg, "backplate", &words, at, rim);
}

/// Draws the contact angle at the outlet's end of the backplate, from the horizontal.
fn contact(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let beta_rad = geometry.contact_angle_rad;
    let [inner, radius, outer] =
        [1.0, 1.08, 1.14].map(|part| part * (1.0 + PLATE) * geometry.backplate_radius_mm);
    for polar_rad in [0.0, beta_rad] {
        svg.line(&[view.polar(polar_rad, inner), view.polar(polar_rad, outer)], PURPLE, 1.2);
    }
    let points = arc(view, radius, 0.0, beta_rad);
    svg.line(&points, PURPLE, 2.0);
    if let [.., before, last] = points[..] {
        svg.tip(before, last, PURPLE);
    }
    let end = view.polar(0.5 * beta_rad, radius);
    let words = format!("{}°", significant((1e6 * degrees(beta_rad)).round() / 1e6, 4));
    label(svg, "contact", &words, (WIDTH - 20.0, 200.0), end);
}

/// Draws the tube across, enlarged, with bore and outer diameter.
fn tube(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let bore = TUBE * geometry.bore_radius_mm / geometry.tube_outer_radius_mm;
    svg.disc(TUBE_AT, TUBE, "#e8c9a0");
    svg.disc(TUBE_AT, bore, "#cfe8f7");
    let (x, y) = TUBE_AT;
    svg.arrow((x - bore, y), (x + bore, y), INK, true);
    let below = y + TUBE + 14.0;
    for side in [-TUBE, TUBE] {
        svg.line(&[(x + side, y), (x + side, below + 5.0)], LEADER, 1.0);
    }
    svg.arrow((x - TUBE, below), (x + TUBE, below), INK, true);
    let [bore_mm, outer_mm] = [geometry.bore_radius_mm, geometry.tube_outer_radius_mm]
        .map(|radius_mm| millimetres(2.0 * radius_mm));
    svg.text((x, below + 22.0), &format!("tube {bore_mm} x {outer_mm} mm"), "middle", SIZE);
    svg.text((x, below + 40.0), "bore x outer diameter", "middle", 13.0);
    // To the tube in the head, where no roller squeezes it.
    let polar_rad = (0.5 * geometry.pitch_rad()).min(radians(50.0)) - FRAC_PI_2;
    let aside_rad = polar_rad - radians(6.0).min(0.12 * geometry.pitch_rad());
    let place = view.polar(aside_rad, geometry.backplate_radius_mm - geometry.tube_outer_radius_mm);
    svg.line(&[(x - TUBE, y), place], LEADER, 1.0);
    svg.disc(place, 2.5, "#828282");
}

/// Writes a label, name and value, and leads from it to a point of its arrow.
fn label(svg: &mut Svg, name: &str, value: &str, at: Point, to: Point) {
    let is_left = at.0 < 0.5 * WIDTH;
    let words = format!("{name} {value}");
    let width = 8.0 + 0.58 * SIZE * words.chars().count() as f64;
    let from = (if is_left { at.0 + width } else { at.0 - width }, at.1 - 0.3 * SIZE);
    svg.line(&[from, to], LEADER, 1.0);
    svg.text(at, &words, if is_left { "start" } else { "end" }, SIZE);
}
