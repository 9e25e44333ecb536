//! The constructors that a generated source calls. `dose pumps show NAME --format rust` writes such sources.
//!
//! This module is no part of the API. A source names the [`FORMAT`] that it is written in, so a source for
//! another version of this crate does not compile.
//!
//! Each constructor returns `None` of values that no curve has. A source unwraps it in the initialiser of a
//! `static`, so a damaged source does not compile either, and no panic is left in the program.

use crate::head::flow_curve::FlowCurve;
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::line::line::Line;
use crate::math::polynomial::DEGREE;
use crate::pump::pump::Pump;

/// Version of the form of generated sources. It grows when a constructor or the meaning of a number changes.
pub const FORMAT: u32 = 1;

/// Start and length of a piece of a flow curve within the pitch, rad, and coefficients of its volume, mL,
/// lowest order first.
pub type FlowNumbers = (f64, f64, [f64; DEGREE + 1]);

/// Start of a piece of a roller volume, rad, and coefficients of V, mL, lowest order first.
pub type VolumeNumbers = (f64, [f64; DEGREE + 1]);

/// Makes a flow curve from its [`flow_pieces`].
pub const fn flow_curve(pitch_rad: f64, pitch_ml: f64, pieces: &[FlowNumbers]) -> Option<FlowCurve> {
    FlowCurve::of_pieces(pitch_rad, pitch_ml, pieces)
}

/// Makes a roller volume from its [`volume_pieces`].
pub const fn roller_volume(
    engagement_rad: f64,
    inset_rad: f64,
    total_ml: f64,
    pieces: &[VolumeNumbers],
) -> Option<RollerVolume> {
    RollerVolume::of_pieces(engagement_rad, inset_rad, total_ml, pieces)
}

/// Makes a pump from its parts and its curves, inlet first. [`Pump::new`] of the parts gives an equal pump.
pub const fn pump(
    geometry: Geometry,
    roller_volume: Option<RollerVolume>,
    lines: [Line; 2],
    curves: [Option<FlowCurve>; 2],
) -> Option<Pump> {
    match (roller_volume, curves) {
        (Some(volume), [Some(inlet), Some(outlet)]) => {
            Some(Pump::of_curves(geometry, volume, lines, [inlet, outlet]))
        }
        _ => None,
    }
}

/// Returns the pieces of a flow curve, for [`flow_curve`].
pub fn flow_pieces(curve: &FlowCurve) -> impl Iterator<Item = FlowNumbers> + '_ {
    curve.pieces().iter().map(|piece| (piece.start_rad, piece.length_rad, piece.volume.c))
}

/// Returns the pieces of a roller volume, for [`roller_volume`].
pub fn volume_pieces(curve: &RollerVolume) -> impl Iterator<Item = VolumeNumbers> + '_ {
    curve.pieces().iter().map(|piece| (piece.start_rad, piece.volume.c))
}
