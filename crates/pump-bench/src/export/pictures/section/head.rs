//! The head itself: backplate, squeezed tube, rotor and rollers.

use std::f64::consts::{FRAC_PI_2, PI};

use pump_model::Geometry;

use super::PLATE;
use super::svg::{INK, Point, Svg, View};
use crate::export::pictures::Colour;

/// Distance between two points of the tube, as a part of the backplate's radius.
const STEP: f64 = 0.003;

/// Length of a straight end of the backplate, as a part of its radius.
const STRAIGHT: f64 = 0.3;

/// A place on the backplate's surface in mm, and the normal into the tube.
#[derive(Clone, Copy)]
struct Place {
    at: Point,
    normal: Point,
}

impl Place {
    /// Returns the point at a depth in mm from the surface toward the shaft.
    fn deep(&self, depth_mm: f64) -> Point {
        (self.at.0 + depth_mm * self.normal.0, self.at.1 + depth_mm * self.normal.1)
    }
}

/// Returns the polar angles of the rollers in rad. The first one is at the bottom of the picture.
pub(super) fn rollers_rad(geometry: &Geometry) -> impl Iterator<Item = f64> {
    let pitch_rad = geometry.pitch_rad();
    (0..geometry.rollers).map(move |roller| f64::from(roller) * pitch_rad - FRAC_PI_2)
}

/// Draws the head. The outlet is on the right, and the rotor turns counterclockwise.
pub(super) fn draw(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let places = backplate(geometry);
    let thickness: Vec<f64> = places.iter().map(|place| thickness_mm(geometry, place)).collect();
    let walls_mm = 2.0 * (geometry.tube_outer_radius_mm - geometry.bore_radius_mm);
    let lumen = |mm: f64| (mm - walls_mm).max(0.0);
    let band = |from: &dyn Fn(f64) -> f64, to: &dyn Fn(f64) -> f64| -> Vec<Point> {
        let outer = places.iter().zip(&thickness).map(|(place, mm)| view.at(place.deep(from(*mm))));
        let inner = places.iter().zip(&thickness).map(|(place, mm)| view.at(place.deep(to(*mm))));
        outer.chain(inner.collect::<Vec<_>>().into_iter().rev()).collect()
    };
    let plate_mm = PLATE * geometry.backplate_radius_mm;
    svg.area(&band(&|_| -plate_mm, &|_| 0.0), "#9aa0a6");
    svg.area(&band(&|_| 0.0, &|mm| mm), "#e8c9a0");
    svg.area(&band(&|mm| 0.5 * (mm - lumen(mm)), &|mm| 0.5 * (mm + lumen(mm))), "#cfe8f7");
    let edge: Vec<Point> =
        places.iter().zip(&thickness).map(|(place, mm)| view.at(place.deep(*mm))).collect();
    svg.line(&edge, Colour { red: 95, green: 75, blue: 50 }, 0.8);
    rotor(svg, view, geometry);
    for (place, name, x) in [(places.first(), "outlet", 1.0), (places.last(), "inlet", -1.0)] {
        let Some(place) = place else { continue };
        let (x_px, y_px) = view.at(place.deep(geometry.tube_outer_radius_mm));
        let (low, high) = ((x_px, y_px - 6.0), (x_px, y_px - 34.0));
        let (from, to) = if x > 0.0 { (low, high) } else { (high, low) };
        svg.arrow(from, to, INK, false);
        svg.text((x_px, y_px - 42.0), name, "middle", 15.0);
    }
}

fn rotor(svg: &mut Svg, view: &View, geometry: &Geometry) {
    let grey = Colour { red: 170, green: 170, blue: 175 };
    for polar_rad in rollers_rad(geometry) {
        let axis = view.polar(polar_rad, geometry.roller_offset_mm);
        svg.line(&[view.centre, axis], grey, 7.0);
    }
    for polar_rad in rollers_rad(geometry) {
        let axis = view.polar(polar_rad, geometry.roller_offset_mm);
        svg.disc(axis, view.scale * geometry.roller_radius_mm, "#ececef");
        svg.disc(axis, 2.5, "#404040");
    }
    svg.disc(view.centre, 5.0, "#404040");
}

/// Returns places on the backplate from the outlet's end to the inlet's: an arc with a straight at either end.
fn backplate(geometry: &Geometry) -> Vec<Place> {
    let (radius_mm, beta_rad) = (geometry.backplate_radius_mm, geometry.contact_angle_rad);
    let straight_mm = STRAIGHT * radius_mm;
    let ends = |length_mm: f64| (length_mm / (STEP * radius_mm)).ceil() as u32;
    let place = |polar_rad: f64, along_mm: f64| {
        let (sine, cosine) = polar_rad.sin_cos();
        let at = (radius_mm * cosine - along_mm * sine, radius_mm * sine + along_mm * cosine);
        Place { at, normal: (-cosine, -sine) }
    };
    let of_straight = ends(straight_mm);
    let part = |n: u32, of: u32| f64::from(n) / f64::from(of);
    let outlet = (0..of_straight).map(|n| place(beta_rad, straight_mm * (1.0 - part(n, of_straight))));
    let span_rad = PI + 2.0 * beta_rad;
    let of_arc = ends(radius_mm * span_rad);
    let arc = (0..=of_arc).map(|n| place(beta_rad - span_rad * part(n, of_arc), 0.0));
    let inlet = (1..=of_straight).map(|n| place(beta_rad - span_rad, -straight_mm * part(n, of_straight)));
    outlet.chain(arc).chain(inlet).collect()
}

/// Returns the thickness in mm that the rollers leave to the tube, along the normal of the backplate.
fn thickness_mm(geometry: &Geometry, place: &Place) -> f64 {
    let whole_mm = 2.0 * geometry.tube_outer_radius_mm;
    rollers_rad(geometry).fold(whole_mm, |thickness_mm, polar_rad| {
        let axis = (geometry.roller_offset_mm * polar_rad.cos(), geometry.roller_offset_mm * polar_rad.sin());
        let to = (axis.0 - place.at.0, axis.1 - place.at.1);
        let deep_mm = to.0 * place.normal.0 + to.1 * place.normal.1;
        let aside_mm = to.0 * place.normal.1 - to.1 * place.normal.0;
        // Along the normal, the far side of the head lies behind the shaft.
        let is_near = deep_mm > 0.0 && deep_mm < geometry.backplate_radius_mm;
        let square = geometry.roller_radius_mm * geometry.roller_radius_mm - aside_mm * aside_mm;
        if is_near && square > 0.0 { thickness_mm.min(deep_mm - square.sqrt()) } else { thickness_mm }
    })
}
