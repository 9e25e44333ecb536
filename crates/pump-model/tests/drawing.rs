//! Roller volumes from the drawing, as curves, against an independent quadrature and against the measurements
//! of McIntyre et al.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;
use pump_model::volume_fit::PUBLISHED_POINTS;
use pump_model::{Drawing, Geometry, Line, ModelError, Pump, RollerVolume, Variant};

fn drawing(variant: Variant) -> Drawing {
    Drawing::new(&Geometry::published(3, variant)).unwrap()
}

/// Returns V at theta straight from the gap between roller and backplate, mL.
///
/// The gap is integrated over y on the straight and over the polar angle p on the arc, by adaptive Simpson
/// quadrature that knows no corners.
fn independent_ml(g: &Geometry, theta_rad: f64) -> f64 {
    let tube_mm = 2.0 * g.tube_outer_radius_mm;
    let (r_b, r_roller, offset) = (g.backplate_radius_mm, g.roller_radius_mm, g.roller_offset_mm);
    let eta = ((r_b - tube_mm - r_roller) / offset).acos() - theta_rad;
    let area = |gap: f64| {
        let h = (tube_mm - gap).clamp(0.0, 2.0 * g.bore_radius_mm);
        PI * h * h / 4.0
    };
    // The gap has no end beyond the roller.
    let gap = |along: f64, across_mm: f64| {
        let square = r_roller * r_roller - across_mm * across_mm;
        if square < 0.0 { f64::INFINITY } else { r_b - along - square.sqrt() }
    };
    let straight = |y: f64| area(gap(offset * eta.cos(), y - offset * eta.sin()));
    let arc = |p: f64| {
        if (p - eta).cos() <= 0.0 {
            return 0.0;
        }
        area(gap(offset * (p - eta).cos(), offset * (p - eta).sin()))
    };
    let end_mm = offset + r_roller;
    let mean_mm = r_b - g.tube_outer_radius_mm;
    1e-3 * (in_parts(&straight, 0.0, end_mm) + mean_mm * in_parts(&arc, -PI, 0.0))
}

/// The quadrature starts with small parts: the roller is narrow, and the rule must not be lucky at a corner.
fn in_parts(f: &dyn Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let width = (high - low) / 2048.0;
    (0..2048).map(|n| low + f64::from(n) * width).map(|a| simpson(f, a, a + width, 1e-14, 40)).sum()
}

fn simpson(f: &dyn Fn(f64) -> f64, a: f64, b: f64, tolerance: f64, depth: u32) -> f64 {
    let rule = |a: f64, b: f64| (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b));
    let middle = 0.5 * (a + b);
    let (whole, halves) = (rule(a, b), rule(a, middle) + rule(middle, b));
    if depth == 0 || (halves - whole).abs() < 15.0 * tolerance {
        return halves + (halves - whole) / 15.0;
    }
    simpson(f, a, middle, 0.5 * tolerance, depth - 1) + simpson(f, middle, b, 0.5 * tolerance, depth - 1)
}

#[test]
fn angles_are_those_of_the_drawing() {
    for (variant, phi_deg, closure_deg) in [(Variant::Measured, 66.8, 30.69), (Variant::AsBuilt, 66.1, 32.91)]
    {
        let drawing = drawing(variant);
        assert!((drawing.engagement_rad().to_degrees() - phi_deg).abs() < 0.05);
        assert!((drawing.closure_rad().to_degrees() - closure_deg).abs() < 0.005);
    }
}

#[test]
fn volumes_are_as_near_to_those_measured_as_is_known() {
    let end_ml = PUBLISHED_POINTS[14].1;
    for (variant, end_percent, rms_ml, arc_ml) in
        [(Variant::AsBuilt, -2.3, 0.0595, 2.1147), (Variant::Measured, 2.6, 0.030, 2.2267)]
    {
        let drawing = drawing(variant);
        let volume = |deg: f64| drawing.volume_ml(deg.to_radians());
        assert!((100.0 * (volume(50.53) / end_ml - 1.0) - end_percent).abs() < 0.05, "{}", volume(50.53));
        let square: f64 = PUBLISHED_POINTS.iter().map(|(deg, ml)| (volume(*deg) - ml).powi(2)).sum();
        assert!(((square / 15.0).sqrt() - rms_ml).abs() < 5e-4, "{}", (square / 15.0).sqrt());
        assert!((drawing.volume_ml(drawing.engagement_rad()) - arc_ml).abs() < 5e-5);
    }
}

#[test]
fn ten_revolutions_of_a_drawn_pump_are_within_1_4_percent_of_those_measured() {
    let mut worst: f64 = 0.0;
    for (rollers, measured_ml) in [(3, 212.53), (2, 231.75)] {
        for variant in [Variant::Measured, Variant::AsBuilt] {
            let pump = drawn(Geometry::published(rollers, variant)).unwrap();
            worst = worst.max((10.0 * pump.revolution_ml() / measured_ml - 1.0).abs());
        }
    }
    assert!(worst < 0.01405 && worst > 0.0135, "{worst}");
}

#[test]
fn the_inlet_phase_counts_from_where_contact_ends() {
    let pump = drawn(Geometry::published(3, Variant::Measured)).unwrap();
    let volume = pump.roller_volume();
    let psi_deg = pump.geometry().inlet_phase_rad(volume).unwrap().to_degrees();
    // The expected value is 360 - (180 + 60 - 2 (66.806 - 43.531)) - 66.806.
    assert!((psi_deg - 99.7435).abs() < 1e-3, "{psi_deg}");
    // The flow is that between the rollers where the inlet's pulse starts and the outlet's ends.
    let nominal = pump.geometry().nominal_ml_rad();
    let phi = volume.engagement_rad();
    let inlet = |angle_deg: f64| pump.inlet_curve().flow_ml_rad(angle_deg.to_radians());
    assert!((inlet(psi_deg) - nominal).abs() < 1e-6 && inlet(psi_deg + 5.0) < nominal - 0.5);
    assert!((inlet(psi_deg - 5.0) - nominal).abs() < 1e-6);
    assert!((pump.outlet_curve().flow_ml_rad(phi) - nominal).abs() < 1e-6);
    assert!(pump.outlet_curve().flow_ml_rad(phi - 0.1) < nominal - 0.5);
}

#[test]
fn rollers_that_seal_nowhere_near_the_arcs_end_are_refused() {
    // An arc pi + 2 beta of 186 degrees is enough for two rollers, but full contact starts and ends 23.3
    // degrees inside it.
    let geometry =
        Geometry { contact_angle_rad: 3.0_f64.to_radians(), ..Geometry::published(2, Variant::Measured) };
    geometry.validate().unwrap();
    let error = drawn(geometry).unwrap_err();
    assert!(
        matches!(error, ModelError::NotSealing { span_deg, .. } if (span_deg - 139.4511).abs() < 1e-3),
        "{error}"
    );
}

#[test]
fn rollers_that_do_not_come_from_inside_the_tubes_bend_are_refused() {
    let base = Geometry::published(3, Variant::Measured);
    let drawn = |offset: f64, radius: f64| {
        Drawing::new(&Geometry { roller_offset_mm: offset, roller_radius_mm: radius, ..base })
    };
    assert!(matches!(drawn(30.0, 31.0), Err(ModelError::OutOfRange { .. })));
    let error = drawn(56.0, 5.0).unwrap_err();
    // The smallest radius is sqrt(56² - 49²) = 27.111 mm.
    assert!(error.to_string().contains("22.111 mm too small"), "{error}");
}

fn drawn(geometry: Geometry) -> Result<Pump, ModelError> {
    Pump::new(geometry, RollerVolume::from_drawing(&geometry)?, Line::PUBLISHED, Line::PUBLISHED)
}

/// Pumps from a finger's width to a foot. The gap goes from just closing the tube to none.
fn any_geometry() -> impl Strategy<Value = Geometry> {
    let sizes = (0.4..8.0_f64, 1.15..2.2_f64, 4.0..30.0_f64, 10.0..80.0_f64, 0.0..=1.0_f64);
    sizes.prop_filter_map("rollers come from inside the bend", |(bore, ratio, radius, offset, squeeze)| {
        let outer = ratio * bore;
        let geometry = Geometry {
            rollers: 3,
            bore_radius_mm: bore,
            tube_outer_radius_mm: outer,
            backplate_radius_mm: offset + radius + squeeze * 2.0 * (outer - bore) * (1.0 - 1e-12),
            contact_angle_rad: 0.5,
            roller_radius_mm: radius,
            roller_offset_mm: offset,
        };
        Drawing::new(&geometry).ok().map(|_| geometry)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn volumes_agree_with_an_independent_quadrature(geometry in any_geometry(), part in 0.0..1.1_f64) {
        let drawing = Drawing::new(&geometry).unwrap();
        let full_ml = drawing.volume_ml(drawing.engagement_rad());
        let theta = part * drawing.engagement_rad();
        let difference_ml = drawing.volume_ml(theta) - independent_ml(&geometry, theta);
        prop_assert!(difference_ml.abs() < 1e-10 * full_ml.max(0.1), "{} of {}", difference_ml, full_ml);
    }

    #[test]
    fn slopes_are_those_of_the_volume(geometry in any_geometry(), part in 0.01..0.99_f64) {
        let drawing = Drawing::new(&geometry).unwrap();
        let (theta, h) = (part * drawing.engagement_rad(), 1e-6);
        let slope = (drawing.volume_ml(theta + h) - drawing.volume_ml(theta - h)) / (2.0 * h);
        // The slope falls as a root close to the closure, by 2e-3 of itself over h.
        let allowed = 1e-7 + 4e-3 * slope * f64::from((theta - drawing.closure_rad()).abs() < 1e-2);
        prop_assert!((slope - drawing.slope_ml_rad(theta)).abs() < allowed * geometry.nominal_ml_rad().max(1.0));
    }

    #[test]
    fn curves_are_within_their_stated_errors_rise_and_have_no_jump(geometry in any_geometry()) {
        let drawing = Drawing::new(&geometry).unwrap();
        let curve = RollerVolume::from_drawing(&geometry).unwrap();
        let phi = drawing.engagement_rad();
        prop_assert!((curve.engagement_rad() - phi).abs() < 1e-9);
        let nominal = geometry.nominal_ml_rad();
        let mut last_ml = 0.0;
        for n in 0..=3000 {
            let theta = f64::from(n) / 3000.0 * phi;
            let volume_ml = curve.at(theta);
            let error = (volume_ml - drawing.volume_ml(theta)).abs() / curve.total_ml();
            prop_assert!(error < 2.2e-6, "{} at {}", error, theta);
            prop_assert!(volume_ml >= last_ml, "falls at {}", theta);
            last_ml = volume_ml;
        }
        // Samples lie on either side of each piece's start, and inside.
        let pieces: Vec<_> = pump_model::generated::volume_pieces(&curve).collect();
        let slope = |(_, c): &(f64, [f64; 6]), x: f64| {
            c.iter().enumerate().skip(1).map(|(n, c)| n as f64 * c * x.powi(n as i32 - 1)).sum::<f64>()
        };
        for (n, piece) in pieces.iter().enumerate() {
            let end = pieces.get(n + 1).map_or(phi, |next| next.0);
            let after = pieces.get(n + 1).map_or(0.0, |next| slope(next, 0.0));
            let jump = slope(piece, end - piece.0) - after;
            prop_assert!(jump.abs() < 1e-9 * nominal, "jump of {} at {}", jump, end);
            for part in 1..20 {
                let x = f64::from(part) / 20.0 * (end - piece.0);
                let error = (slope(piece, x) - drawing.slope_ml_rad(piece.0 + x)).abs() / nominal;
                let since_closure = piece.0 + x - drawing.closure_rad();
                let allowed = if (-1e-9..0.25_f64.to_radians()).contains(&since_closure) { 0.02 } else { 0.005 };
                prop_assert!(error < allowed, "{} of the flow at {}", error, piece.0 + x);
            }
        }
    }
}

#[test]
fn a_drawn_pumps_volumes_balance() {
    for rollers in [2, 3, 4, 6] {
        let pump = drawn(Geometry::published(rollers, Variant::Measured)).unwrap();
        let expected =
            TAU * pump.geometry().nominal_ml_rad() - f64::from(rollers) * pump.roller_volume().total_ml();
        for curve in [pump.inlet_curve(), pump.outlet_curve()] {
            for start in [0.0, 0.3, FRAC_PI_2, -77.7] {
                let volume = curve.volume_ml(start + TAU) - curve.volume_ml(start);
                assert!((volume - expected).abs() < 1e-9, "{rollers} rollers from {start}: {volume}");
                let found = curve.angle_rad(curve.volume_ml(start));
                assert!((found - start).abs() < 1e-10, "{found} for {start}");
            }
        }
    }
}
