//! Claims about volumes and flows per angle: balance, periodicity, inverse, refusal of pumps that cannot
//! work.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::TAU;

use proptest::prelude::*;
use pump_model::{FlowCurve, Geometry, Line, ModelError, Pump, RollerVolume, Variant};

fn pump(rollers: u32) -> Pump {
    Pump::preset(rollers, Variant::Measured).unwrap()
}

#[test]
fn a_revolution_delivers_the_nominal_volume_less_that_of_the_rollers() {
    for rollers in 2..=11 {
        let pump = pump(rollers);
        let expected = TAU * 4.398_229_715 - f64::from(rollers) * pump.roller_volume().total_ml();
        for curve in [pump.inlet_curve(), pump.outlet_curve()] {
            for start in [0.0, 0.3, 5.0, -77.7] {
                let volume = curve.volume_ml(start + TAU) - curve.volume_ml(start);
                assert!((volume - expected).abs() < 1e-8, "{rollers} rollers from {start}: {volume}");
            }
        }
        assert!((pump.revolution_ml() - expected).abs() < 1e-8);
    }
}

#[test]
fn published_figures_are_met() {
    let three = pump(3);
    assert!((three.geometry().nominal_ml_rad() - 4.398_229_7).abs() < 1e-7);
    assert!((three.revolution_ml() - 21.3185).abs() < 5e-5);
    assert!((pump(2).revolution_ml() - 23.4240).abs() < 5e-5);
    // The peak and the duration of the pulse are those at 60 r/min.
    let (low, high) = three.outlet_curve().flow_range_ml_rad();
    assert!(((high - low) * TAU - 25.089).abs() < 1e-3);
    assert!((three.roller_volume().engagement_rad() / TAU - 0.140_36).abs() < 5e-6);
    let psi = three.geometry().inlet_phase_rad(three.roller_volume()).unwrap();
    assert!((psi / TAU - 0.192_97).abs() < 5e-6);
    // The jump at full engagement is that at 100 r/min.
    let jump = three.outlet_curve().flow_ml_rad(-1e-9) - three.outlet_curve().flow_ml_rad(0.0);
    assert!((jump * TAU * 100.0 / 60.0 - 1.185).abs() < 1e-3);
    // The other variants follow.
    let published = Pump::preset(3, Variant::Published).unwrap();
    assert!((published.roller_volume().total_ml() - 2.06).abs() < 1e-12);
    let as_built = Pump::preset(3, Variant::AsBuilt).unwrap();
    assert!((as_built.geometry().nominal_ml_rad() - 4.379_38).abs() < 1e-5);
}

#[test]
fn ripple_at_constant_speed_is_that_of_the_published_pumps() {
    let three = pump(3).outlet_curve().ripple();
    assert!((three.peak_to_peak - 1.18).abs() < 5e-3 && (three.rms - 0.427).abs() < 5e-4, "{three:?}");
    let two = pump(2).outlet_curve().ripple();
    assert!((two.peak_to_peak - 1.071).abs() < 5e-4 && (two.rms - 0.342).abs() < 5e-4, "{two:?}");
}

#[test]
fn flow_is_the_slope_of_the_volume_everywhere_but_at_edges() {
    for rollers in [2, 3, 7, 8, 11] {
        let pump = pump(rollers);
        for curve in [pump.inlet_curve(), pump.outlet_curve()] {
            for n in 0..997 {
                let angle = f64::from(n) * TAU / 997.0 + 1e-3;
                let h = 1e-5;
                let slope = (curve.volume_ml(angle + h) - curve.volume_ml(angle - h)) / (2.0 * h);
                let flow = curve.flow_ml_rad(angle);
                // The bound allows for an edge within h of the point (the flow jumps by 0.113).
                assert!(
                    (slope - flow).abs() < 1e-6 || (slope - flow).abs() < 0.12 && near_edge(curve, angle, h)
                );
            }
        }
    }
}

fn near_edge(curve: &FlowCurve, angle: f64, h: f64) -> bool {
    (curve.flow_ml_rad(angle + h) - curve.flow_ml_rad(angle - h)).abs() > 0.1
}

#[test]
fn overlapping_pulses_add_up_to_the_limits_that_are_known() {
    let lowest = |rollers| pump(rollers).outlet_curve().flow_range_ml_rad().0;
    assert!((lowest(3) - 0.405).abs() < 5e-4);
    assert!((lowest(11) - 0.405).abs() < 5e-4);
    assert!((lowest(12) - 0.055).abs() < 5e-4);
    assert!(lowest(13) < 0.0);
    assert!((pump(13).revolution_ml() - (27.634_892 - 13.0 * 2.105_466)).abs() < 2e-5);
    // From 14 rollers on they take more than the tube holds.
    let refused = Pump::preset(14, Variant::Measured).unwrap_err();
    assert!(matches!(refused, ModelError::NotPumping { rollers: 14, .. }), "{refused}");
}

#[test]
fn pumps_that_cannot_work_are_refused_by_name() {
    let good = *pump(3).geometry();
    let build =
        |geometry| Pump::new(geometry, RollerVolume::measured().unwrap(), Line::PUBLISHED, Line::PUBLISHED);
    let refused = |geometry| build(geometry).unwrap_err();
    let degree = TAU / 360.0;

    assert!(matches!(refused(Geometry { rollers: 1, ..good }), ModelError::NotSealing { .. }));
    assert!(matches!(refused(Geometry { rollers: 0, ..good }), ModelError::OutOfRange { .. }));
    assert!(matches!(
        refused(Geometry { contact_angle_rad: 70.0 * degree, ..good }),
        ModelError::EngagementTooLong { .. }
    ));
    assert!(matches!(
        refused(Geometry { roller_offset_mm: 43.1, ..good }),
        ModelError::RollersHitBackplate { .. }
    ));
    assert!(matches!(refused(Geometry { roller_offset_mm: 38.9, ..good }), ModelError::NotOccluding { .. }));
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        for geometry in [
            Geometry { bore_radius_mm: bad, ..good },
            Geometry { tube_outer_radius_mm: bad, ..good },
            Geometry { backplate_radius_mm: bad, ..good },
            Geometry { roller_radius_mm: bad, ..good },
            Geometry { roller_offset_mm: bad, ..good },
        ] {
            assert!(matches!(refused(geometry), ModelError::OutOfRange { .. }), "{geometry:?}");
        }
    }
    assert!(build(Geometry { contact_angle_rad: 0.0, ..good }).is_ok(), "beta = 0 is allowed");
    // A bed of 124 deg is enough for three rollers 120 deg apart, one of 118 deg is not.
    assert!(build(Geometry { contact_angle_rad: -28.0 * degree, ..good }).is_ok());
    let short = refused(Geometry { contact_angle_rad: -31.0 * degree, ..good });
    assert!(short.to_string().ends_with("a contact angle larger by 1.0 deg"), "{short}");
    let line = Line { compliance_ml_kpa: 0.0, ..Line::PUBLISHED };
    let error = Pump::new(good, RollerVolume::measured().unwrap(), line, Line::PUBLISHED).unwrap_err();
    assert_eq!(error.to_string(), "line compliance in mL/kPa is 0; allowed: 1e-6 to 1e6");
}

proptest! {
    #[test]
    fn an_angle_is_recovered_from_its_volume(rollers in 2u32..=12, angle in -500.0..500.0_f64) {
        let pump = pump(rollers);
        for curve in [pump.inlet_curve(), pump.outlet_curve()] {
            let found = curve.angle_rad(curve.volume_ml(angle));
            prop_assert!((found - angle).abs() < 1e-11, "{} for {}", found, angle);
        }
    }
}
