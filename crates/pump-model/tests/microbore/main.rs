//! Claims about heads with narrow bores, thick walls and many rollers, from their drawings.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::{PI, TAU};

use proptest::prelude::*;
use pump_model::{Drawing, Geometry, Line, ModelError, Pump, RollerVolume};

fn drawn(geometry: Geometry) -> Result<Pump, ModelError> {
    Pump::new(geometry, RollerVolume::from_drawing(&geometry)?, Line::PUBLISHED, Line::PUBLISHED)
}

/// A head with a tube of 1.6 x 4.8 mm and eight rollers on a bed of 140 degrees.
const MICRO: Geometry = Geometry {
    rollers: 8,
    bore_radius_mm: 0.8,
    tube_outer_radius_mm: 2.4,
    backplate_radius_mm: 26.8,
    contact_angle_rad: -20.0 * TAU / 360.0,
    roller_radius_mm: 6.0,
    roller_offset_mm: 18.0,
};

/// Heads of 0.5 to 3 mm bore with walls of 0.8 to 1.8 mm and 4 to 12 rollers, whose walls are pressed by up to 30 %.
/// The last number makes some of them too wide or too narrow.
fn any_head() -> impl Strategy<Value = Geometry> {
    let tube = (0.25..1.5_f64, 0.8..1.8_f64, 0.7..1.0_f64);
    let head = (4_u32..=12, 8.0..38.0_f64, 0.4..1.0_f64, -60.0..30.0_f64);
    (tube, head, prop_oneof![4 => Just(0.0), 1 => -4.0..4.0_f64]).prop_map(
        |((bore, wall, pressed), (rollers, offset, part, beta_deg), wrong_mm)| {
            let radius = (part * offset * (PI / f64::from(rollers)).sin()).max(1.5);
            Geometry {
                rollers,
                bore_radius_mm: bore,
                tube_outer_radius_mm: bore + wall,
                backplate_radius_mm: offset + radius + 2.0 * wall * pressed + wrong_mm,
                contact_angle_rad: beta_deg.to_radians(),
                roller_radius_mm: radius,
                roller_offset_mm: offset,
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_drawing_works_or_is_refused_with_the_dimension_that_is_wrong(geometry in any_head(), angle in 0.0..TAU) {
        let reach_mm = geometry.roller_offset_mm + geometry.roller_radius_mm;
        let gap_mm = geometry.backplate_radius_mm - reach_mm;
        let wall_mm = geometry.tube_outer_radius_mm - geometry.bore_radius_mm;
        match drawn(geometry) {
            Ok(pump) => {
                prop_assert!(gap_mm >= 0.0 && gap_mm <= 2.0 * wall_mm);
                // The flow is that of the tube less the pulses of the rollers that leave, by the drawing itself.
                let drawing = Drawing::new(&geometry).unwrap();
                let phi = drawing.engagement_rad();
                let mut flow_ml_rad = geometry.nominal_ml_rad();
                let mut x = (phi - angle).rem_euclid(geometry.pitch_rad());
                let mut near_closure = false;
                while x < phi {
                    flow_ml_rad -= drawing.slope_ml_rad(x);
                    near_closure |= (x - drawing.closure_rad()).abs() < 0.5_f64.to_radians();
                    x += geometry.pitch_rad();
                }
                let off = (pump.outlet_curve().flow_ml_rad(angle) - flow_ml_rad).abs();
                let most = if near_closure { 0.1 } else { 0.02 };
                prop_assert!(off < most * geometry.nominal_ml_rad(), "{} {}", off, flow_ml_rad);
                prop_assert!(pump.revolution_ml() > 0.0);
            }
            Err(ModelError::RollersHitBackplate { reach_mm, backplate_radius_mm }) => {
                prop_assert!((reach_mm - backplate_radius_mm + gap_mm).abs() < 1e-12 && gap_mm < 0.0);
            }
            Err(ModelError::NotOccluding { gap_mm, closed_mm }) => {
                prop_assert!(gap_mm > closed_mm && (closed_mm - 2.0 * wall_mm).abs() < 1e-12);
            }
            Err(ModelError::NotSealing { pitch_deg, span_deg, .. }) => prop_assert!(pitch_deg > span_deg),
            Err(ModelError::RollerTooSmall { radius_mm, least_mm }) => {
                prop_assert!(radius_mm == geometry.roller_radius_mm && least_mm >= radius_mm);
            }
            Err(other) => prop_assert!(false, "{} {:?}", other, geometry),
        }
    }
}

#[test]
fn a_dimension_that_is_wrong_is_named_with_the_amount() {
    assert!(drawn(MICRO).unwrap().outlet_curve().reverses());
    for (geometry, expected) in [
        (
            Geometry { backplate_radius_mm: 23.0, ..MICRO },
            "the rollers press 1.000 mm deeper than the tube's walls",
        ),
        (Geometry { backplate_radius_mm: 27.7, ..MICRO }, "stays open by 0.500 mm"),
        (Geometry { backplate_radius_mm: 2.0, ..MICRO }, "not more than the tube's outer diameter of"),
        (Geometry { roller_radius_mm: 1.0, roller_offset_mm: 23.0, ..MICRO }, "mm too small"),
        (
            Geometry { contact_angle_rad: -60.0 * TAU / 360.0, ..MICRO },
            "or a contact angle larger by 5.5 deg",
        ),
    ] {
        let error = drawn(geometry).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn rollers_that_overlap_in_space_are_told() {
    // The axes of eight rollers on a circle of 36 mm stand 36 sin(22.5 deg) = 13.777 mm apart.
    assert_eq!(MICRO.rollers_overlap_mm(), None);
    let wide = Geometry { roller_radius_mm: 7.0, roller_offset_mm: 18.0, backplate_radius_mm: 27.8, ..MICRO };
    let depth_mm = Drawing::new(&wide).unwrap().rollers_overlap_mm().unwrap();
    assert!((depth_mm - (14.0 - 13.777)).abs() < 5e-4, "{depth_mm}");
    // Six rollers of the paper's touch.
    let six = Geometry::published(6, pump_model::Variant::Measured);
    assert_eq!(six.rollers_overlap_mm(), None);
}
