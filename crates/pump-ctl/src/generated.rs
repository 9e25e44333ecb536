//! The constructors that a generated source calls. `dose pumps show NAME --format rust` writes such sources.
//!
//! This module is no part of the API. A source names the [`FORMAT`] that it is written in, so a source for
//! another version of this crate does not compile. [`pump_model::generated`] has the constructors of a pump.

use crate::plan::{TORQUE_POINTS, TorqueCurve};

/// Version of the form of generated sources. It grows when a constructor that a source calls or the meaning of
/// a number changes.
pub const FORMAT: u32 = 2;

/// Makes a torque curve from its [`torque_points`], or `None` of points that no curve has.
pub const fn torque_curve(points: [(f64, f64); TORQUE_POINTS]) -> Option<TorqueCurve> {
    TorqueCurve::of_places(points)
}

/// Returns the points of a torque curve (rad/s, N m), rising in speed. The last point fills the places left.
pub fn torque_points(curve: &TorqueCurve) -> [(f64, f64); TORQUE_POINTS] {
    curve.places()
}
