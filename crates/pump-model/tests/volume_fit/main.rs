//! Claims about roller volumes from measured points: the paper's fit, the rising spline, their reports.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod many_points;

use pump_model::roller_volume::PUBLISHED_COEFFICIENTS_DEG;
use pump_model::volume_fit::PUBLISHED_POINTS;
use pump_model::{Drawing, Geometry, Line, ModelError, Pump, RollerVolume, Variant, VolumeFit, VolumePoint};

fn point((angle_deg, volume_ml): (f64, f64)) -> VolumePoint {
    VolumePoint { angle_deg, volume_ml }
}

fn published() -> [VolumePoint; 15] {
    PUBLISHED_POINTS.map(point)
}

#[test]
fn the_papers_points_give_the_papers_polynomial() {
    let points = published();
    let fit = VolumeFit::quintic(&points).unwrap();
    let found = fit.polynomial_ml_deg().unwrap();
    // The points are printed to 1e-7 mL, so their fit may differ by as much.
    for (found, paper) in found.iter().zip(PUBLISHED_COEFFICIENTS_DEG) {
        assert!((found / paper - 1.0).abs() < 2e-5, "{found} for {paper}");
    }
    let at = |c: &[f64; 6], deg: f64| c.iter().fold(0.0, |sum, c| sum * deg + c);
    for n in 0..=1000 {
        let deg = f64::from(n) / 1000.0 * 50.53;
        assert!((at(&found, deg) - at(&PUBLISHED_COEFFICIENTS_DEG, deg)).abs() < 5e-8);
    }
    assert!((fit.rms_ml() - 0.0074).abs() < 5e-5);
    assert!((fit.curve().total_ml() - 2.105_466).abs() < 1e-6);
    assert!((fit.revolution_ml(&Geometry::published(3, Variant::Measured)) - 21.3185).abs() < 5e-5);
}

#[test]
fn a_quintic_is_recovered_from_points_on_it_in_any_order() {
    let points: Vec<_> = (0..40)
        .map(|n| f64::from(n * 17 % 40))
        .map(|deg| point((deg, 0.3 * deg - 0.02 * deg * deg + 1e-8 * deg.powi(5))))
        .collect();
    let fit = VolumeFit::quintic(&points).unwrap();
    assert!(fit.residuals_ml().all(|residual| residual.abs() < 1e-13));
    let [c5, .., c1, _] = fit.polynomial_ml_deg().unwrap();
    assert!((c5 - 1e-8).abs() < 1e-17 && (c1 - 0.3).abs() < 1e-13, "{c5} {c1}");
}

#[test]
fn where_a_quintic_falls_the_volume_is_held_and_said_so() {
    let points = published();
    let fit = VolumeFit::quintic(&points).unwrap();
    let held: Vec<_> = fit.held_deg().collect();
    assert_eq!(held.len(), 1);
    assert!(held[0].0 == 0.0 && (held[0].1 - 0.567).abs() < 1e-3, "{held:?}");
    assert_eq!(fit.falls().unwrap().count(), 0, "the points themselves rise");
}

/// Returns the flow per radian on either side of every edge of a curve, and at both ends.
fn slope_jumps(curve: &RollerVolume) -> Vec<f64> {
    let pieces: Vec<_> = pump_model::generated::volume_pieces(curve).collect();
    let slope = |c: &[f64; 6], x: f64| (1..6).map(|n| n as f64 * c[n] * x.powi(n as i32 - 1)).sum::<f64>();
    let mut before = 0.0;
    let mut jumps = Vec::new();
    for (n, (start, c)) in pieces.iter().enumerate() {
        jumps.push(slope(c, 0.0) - before);
        let end = pieces.get(n + 1).map_or(curve.engagement_rad(), |next| next.0);
        before = slope(c, end - start);
    }
    jumps.push(before);
    jumps
}

#[test]
fn a_spline_passes_rising_points_without_a_jump_in_the_flow() {
    let points = published();
    let fit = VolumeFit::spline(&points).unwrap();
    assert!(fit.residuals_ml().all(|residual| residual.abs() < 1e-12));
    assert!(fit.rms_ml() < 1e-12 && fit.polynomial_ml_deg().is_none());
    assert!((fit.curve().total_ml() - 2.106_428_6).abs() < 1e-12);
    assert!(slope_jumps(fit.curve()).iter().all(|jump| jump.abs() < 1e-12));
    assert_eq!((fit.falls().unwrap().count(), fit.held_deg().count()), (0, 0));
    let mut last = 0.0;
    for n in 0..=5000 {
        let volume = fit.curve().at(f64::from(n) / 5000.0 * fit.curve().engagement_rad());
        assert!(volume >= last);
        last = volume;
    }
    // The paper's own polynomial jumps where the roller has fully engaged.
    assert!(slope_jumps(VolumeFit::quintic(&points).unwrap().curve()).last().unwrap().abs() > 0.1);
}

#[test]
fn a_splined_pump_behaves_like_the_papers_within_the_fits_residual() {
    let points = published();
    let geometry = Geometry::published(3, Variant::Measured);
    let pump = |curve: &RollerVolume| Pump::new(geometry, *curve, Line::PUBLISHED, Line::PUBLISHED).unwrap();
    let spline = pump(VolumeFit::spline(&points).unwrap().curve());
    let paper = Pump::three_roller();
    for n in 0..200 {
        let angle = f64::from(n) * 0.01;
        let difference = spline.outlet_curve().volume_ml(angle) - paper.outlet_curve().volume_ml(angle);
        assert!(difference.abs() < 0.025, "{difference} at {angle}");
    }
    let fit = VolumeFit::spline(&points).unwrap();
    assert!((fit.revolution_ml(&geometry) - spline.revolution_ml()).abs() < 1e-12);
}

#[test]
fn points_of_a_drawn_pump_give_its_volume_back() {
    let drawing = Drawing::new(&Geometry::published(3, Variant::AsBuilt)).unwrap();
    let phi_deg = drawing.engagement_rad().to_degrees();
    let points: Vec<_> = (0..=24)
        .map(|n| phi_deg * f64::from(n) / 24.0)
        .map(|deg| point((deg, drawing.volume_ml(deg.to_radians()))))
        .collect();
    let fit = VolumeFit::spline(&points).unwrap();
    for n in 0..=1000 {
        let theta = f64::from(n) / 1000.0 * drawing.engagement_rad();
        let error = fit.curve().at(theta) - drawing.volume_ml(theta);
        assert!(error.abs() < 3e-3 * fit.curve().total_ml(), "{error} at {theta}");
    }
}

#[test]
fn runs_at_the_same_angles_are_averaged_and_falls_are_pooled_and_reported() {
    let runs = [(0.0, 0.0), (10.0, 0.3), (20.0, 0.9), (30.0, 0.8), (40.0, 1.0), (10.0, 0.5), (20.0, 1.1)];
    let points = runs.map(point);
    let fit = VolumeFit::spline(&points).unwrap();
    let at = |deg: f64| fit.curve().at(deg.to_radians());
    // The point at 20 degrees weighs two points: (1.0 + 1.0 + 0.8)/3.
    for (deg, ml) in [(10.0, 0.4), (20.0, 2.8 / 3.0), (25.0, 2.8 / 3.0), (30.0, 2.8 / 3.0), (40.0, 1.0)] {
        assert!((at(deg) - ml).abs() < 1e-12, "{} at {deg}", at(deg));
    }
    let falls: Vec<_> = fit.falls().unwrap().collect();
    assert_eq!(falls.len(), 1);
    let (from, to, fall) = falls[0];
    assert!((from - 20.0).abs() < 1e-12 && (to - 30.0).abs() < 1e-12 && (fall - 0.2).abs() < 1e-12);
    let held: Vec<_> = fit.held_deg().collect();
    assert!(held.len() == 1 && (held[0].0 - 20.0).abs() < 1e-12 && (held[0].1 - 30.0).abs() < 1e-12);
    let residuals: Vec<_> = fit.residuals_ml().collect();
    assert!((residuals[1] - 0.1).abs() < 1e-12 && (residuals[5] + 0.1).abs() < 1e-12);
}

#[test]
fn pooling_reaches_back_as_far_as_it_must() {
    let points = [(0.0, 0.0), (10.0, 2.0), (20.0, 3.0), (30.0, 4.0), (40.0, 0.0), (50.0, 5.0)].map(point);
    let fit = VolumeFit::spline(&points).unwrap();
    for deg in [10.0_f64, 20.0, 30.0, 40.0] {
        let expected = if deg == 10.0 { 2.0 } else { 7.0 / 3.0 };
        assert!((fit.curve().at(deg.to_radians()) - expected).abs() < 1e-12, "{deg}");
    }
}

#[test]
fn points_that_make_no_curve_are_refused_by_name() {
    let refused = |points: &[(f64, f64)]| {
        let points: Vec<_> = points.iter().copied().map(point).collect();
        VolumeFit::spline(&points).unwrap_err()
    };
    let ok = [(0.0, 0.0), (20.0, 1.0), (40.0, 2.0)];
    assert_eq!(refused(&ok[..2]), ModelError::TooFewPoints { angles: 2, needed: 3 });
    assert_eq!(refused(&[ok[0], ok[1], ok[1], ok[1]]), ModelError::TooFewPoints { angles: 2, needed: 3 });
    assert!(matches!(refused(&[(5.0, 0.0), ok[1], ok[2]]), ModelError::OutOfRange { value: 5.0, .. }));
    for bad in [(-1.0, 0.0), (360.0, 3.0), (f64::NAN, 1.0), (30.0, f64::NAN), (30.0, f64::INFINITY)] {
        assert!(matches!(refused(&[ok[0], ok[1], bad]), ModelError::OutOfRange { .. }), "{bad:?}");
    }
    assert!(matches!(refused(&[(0.0, 2.0), (20.0, 1.0), (40.0, 0.0)]), ModelError::RollerVolumeFlat { .. }));
    let falling: Vec<_> = (0..26).map(|n| (f64::from(n), -f64::from(n))).collect();
    assert!(matches!(refused(&falling), ModelError::RollerVolumeFlat { .. }));
    let five = [(0.0, 0.0), (9.0, 1.0), (19.0, 2.0), (29.0, 3.0), (39.0, 4.0)].map(point);
    assert_eq!(VolumeFit::quintic(&five).unwrap_err(), ModelError::TooFewPoints { angles: 5, needed: 6 });
}
