//! Heads whose drawings are published, with their sources. No dimension is guessed.

use pump_model::units::radians;
use pump_model::{Geometry, Variant};

/// A head with a published drawing.
pub(crate) struct Design {
    /// Name of the head, and its source.
    pub(crate) name: &'static str,
    pub(crate) source: &'static str,
    pub(crate) geometry: Geometry,
}

/// Returns the heads of the default pulse.
pub(crate) fn designs() -> Vec<Design> {
    vec![
        Design {
            name: "McIntyre et al., 3 and 2 rollers",
            source: "Table 1 of the paper",
            // Both heads of the paper have one drawing: a roller leaves the tube alike, however many there are.
            geometry: Geometry::published(3, Variant::Measured),
        },
        Design {
            name: "Planetary pump of Drmn4ea",
            source: "OpenSCAD text at tim.cexx.org/?p=1282, also at appropedia.org/3D_printed_peristaltic_pump",
            geometry: planetary(),
        },
        Design {
            name: "MLAB PERISTALTIC01",
            source: "github.com/mlab-modules/PERISTALTIC01, hw/cad/configuration.scad and hw/cad/src/pump-v3.scad",
            // r_hose 22, d_hose 9, hose_wall 1.5, d_bearing 14, arm_num 3, all mm. The file's hose_clearance of 0.2
            // leaves the tube open, and the file says to reduce it where suction lacks: here it is 0.
            geometry: bearings(3, 22.0, 0.0, 9.0, 1.5, 14.0),
        },
        Design {
            name: "Phisik, first version",
            source: "github.com/Phisik/Peristaltic-Pump, SCAD/SCAD/settings.h and SCAD/SCAD/pump.scad",
            // r_hose 23, hose_groove 1.5, d_hose 7, hose_wall 0.75, d_bearing 14, arm_num 3, all mm; hose_clearance 0.
            geometry: bearings(3, 23.0, 1.5, 7.0, 0.75, 14.0),
        },
        Design {
            name: "Gear pump of clothbot",
            source: "github.com/clothbot/makerbot, pump_v2/gear_pump.scad",
            geometry: gear_pump(),
        },
    ]
}

/// Returns the angle of first contact to full engagement of a head of which the tube's wall is not published, deg:
/// phi needs its outer diameter alone. The head is github.com/bgamari/peristaltic-pump, pump.scad: `tube_dia` 5,
/// `pump_dia` 150, `bearing_outer_dia` 22, `fudge` 0.3 `tube_dia`, and 4 rollers at (150 - 22 - 2 * 1.5)/2 mm.
pub(crate) fn angle_of_an_unknown_wall_deg() -> f64 {
    let (inner, roller, offset) = (75.0_f64 - 5.0, 11.0, 62.5);
    let contact = ((inner - roller) / offset).acos();
    let half = (inner * inner + offset * offset - roller * roller) / (2.0 * inner * offset);
    (contact + half.acos()).to_degrees()
}

/// Returns a head of ball bearings that press the tube against a half circle. The tube goes straight on at both ends,
/// so beta is 0. `r_bearing = r_hose + d_hose/2 - 2 hose_wall - d_bearing/2` in both files, with the groove added.
fn bearings(rollers: u32, r_hose: f64, groove: f64, d_hose: f64, wall: f64, d_bearing: f64) -> Geometry {
    let backplate_radius_mm = r_hose + groove + 0.5 * d_hose;
    let roller_radius_mm = 0.5 * d_bearing;
    Geometry {
        rollers,
        bore_radius_mm: 0.5 * d_hose - wall,
        tube_outer_radius_mm: 0.5 * d_hose,
        backplate_radius_mm,
        contact_angle_rad: 0.0,
        roller_radius_mm,
        // A nanometre keeps rounding from opening the tube.
        roller_offset_mm: backplate_radius_mm - 2.0 * wall - roller_radius_mm + 1e-6,
    }
}

/// Returns the planetary pump: `tubing_od` 4.7625, `tubing_wall_thickness` 0.79375, `tubing_squish_ratio` 0.5, `D`
/// 51.7, 3 planets of 7 teeth, a sun of about 9 teeth, `P` 45 deg, `DR` 0.5. The planets are the rollers. The tube
/// enters and leaves on parallel lines, so beta is 0.
fn planetary() -> Geometry {
    use core::f64::consts::PI;
    let (od, wall, squish, ring_mm) = (4.7625, 0.79375, 0.5, 51.7);
    let (planets, teeth, sun) = (3.0_f64, 7.0, 9.0);
    let pairs = (2.0 / planets * (sun + teeth)).round();
    let pairs = if pairs * planets % 2.0 == 0.0 { pairs } else { pairs + 1.0 };
    let sun = pairs * planets / 2.0 - teeth;
    let ring = sun + 2.0 * teeth;
    let pitch_diameter = 0.9 * ring_mm / (1.0 + (PI / (2.0 * ring)).min(PI * 0.5 / ring));
    let pitch = pitch_diameter * PI / ring;
    let outer_radius = |teeth: f64| teeth * pitch / (2.0 * PI) + pitch / 4.0;
    Geometry {
        rollers: 3,
        bore_radius_mm: 0.5 * od - wall,
        tube_outer_radius_mm: 0.5 * od,
        backplate_radius_mm: outer_radius(ring) + 2.0 * wall * (1.0 - squish),
        contact_angle_rad: 0.0,
        roller_radius_mm: outer_radius(teeth),
        roller_offset_mm: pitch_diameter / 2.0 * (sun + teeth) / ring,
    }
}

/// Returns the gear pump: Tygon of 1/16 by 3/16 in, 3 conical rollers of 15 to 18 mm (here 16.5) at `gear_d` 20 +
/// `gear_clearance` 0.4, `gear_spacing` 0 in the assembly, in a ring of radius `gear_d` + roller radius + od - id. A
/// quarter of the ring is cut away, so it spans 270 deg.
fn gear_pump() -> Geometry {
    let (bore_mm, outer_mm) = (25.4 / 16.0, 25.4 * 3.0 / 16.0);
    let roller_radius_mm = 0.5 * 16.5;
    Geometry {
        rollers: 3,
        bore_radius_mm: 0.5 * bore_mm,
        tube_outer_radius_mm: 0.5 * outer_mm,
        backplate_radius_mm: 20.0 + roller_radius_mm + outer_mm - bore_mm,
        contact_angle_rad: radians(45.0),
        roller_radius_mm,
        roller_offset_mm: 20.4,
    }
}
