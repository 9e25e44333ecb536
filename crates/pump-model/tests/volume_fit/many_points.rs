//! Claims about rising splines near more measured points than they have knots.

use core::f64::consts::PI;

use pump_model::roller_volume::PUBLISHED_COEFFICIENTS_DEG;
use pump_model::{Geometry, Line, ModelError, Pump, RollerVolume, Variant, VolumeFit, VolumePoint};

const PHI_DEG: f64 = 50.53;

/// A volume that rises smoothly over `PHI_DEG` to 2.1 mL, with slope 0 at both ends.
fn smooth_ml(deg: f64) -> f64 {
    1.05 * (1.0 - (PI * deg / PHI_DEG).cos())
}

fn point(angle_deg: f64, volume_ml: f64) -> VolumePoint {
    VolumePoint { angle_deg, volume_ml }
}

/// Angles from 0 to `PHI_DEG` with even distances.
fn even_deg(count: u32) -> impl Iterator<Item = f64> + Clone {
    (0..count)
        .map(move |n| if n + 1 == count { PHI_DEG } else { PHI_DEG * f64::from(n) / f64::from(count - 1) })
}

/// Normal deviates of standard deviation 1: sums of twelve numbers of a congruential generator (Knuth's MMIX).
fn deviates(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        (0..12).fold(-6.0, |sum, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum + (state >> 11) as f64 / (1_u64 << 53) as f64
        })
    }
}

/// Largest difference of a fit's curve from a volume over deg, mL.
fn off_ml(curve: &RollerVolume, volume_ml: impl Fn(f64) -> f64) -> f64 {
    (0..=2000)
        .map(|n| f64::from(n) / 2000.0 * PHI_DEG)
        .map(|deg| (curve.at(deg.to_radians()) - volume_ml(deg)).abs())
        .fold(0.0, f64::max)
}

/// Asserts that the curve rises from 0, but for rounding.
fn assert_rises(curve: &RollerVolume) {
    let at = |n: u32| curve.at(f64::from(n) / 5000.0 * curve.engagement_rad());
    let rounding = 1e-14 * curve.total_ml();
    assert_eq!(at(0), 0.0);
    for n in 0..5000 {
        assert!(at(n + 1) >= at(n) - rounding, "falls from {} to {} mL", at(n), at(n + 1));
    }
}

#[test]
fn five_hundred_points_of_a_smooth_curve_are_met_within_two_millionths() {
    let points: Vec<_> = even_deg(500).map(|deg| point(deg, smooth_ml(deg))).collect();
    let fit = VolumeFit::spline(&points).unwrap();
    let off = off_ml(fit.curve(), smooth_ml);
    assert!(off < 2e-6 * 2.1, "{off} mL");
    // The flow, mL/rad, of a cubic spline is off by the cube of a piece's length.
    let slope_ml_rad = |deg: f64| 1.05 * PI / PHI_DEG.to_radians() * (PI * deg / PHI_DEG).sin();
    for n in 0..=1000 {
        let deg = PHI_DEG * f64::from(n) / 1000.0;
        let off = fit.curve().slope_ml_rad(deg.to_radians()) - slope_ml_rad(deg);
        assert!(off.abs() < 1e-3, "{off} mL/rad at {deg}");
    }
    assert_rises(fit.curve());
    assert_eq!(fit.held_deg().count(), 0);
    assert!((fit.curve().engagement_deg() - PHI_DEG).abs() < 1e-12);
    // More than 25 angles have no list of falls.
    assert!(fit.falls().is_err());
    let most = fit.residuals_ml().fold(0.0, |most: f64, residual| most.max(residual.abs()));
    assert!(fit.residuals_ml().len() == 500 && most <= off && fit.rms_ml() <= most && fit.rms_ml() > 0.0);
}

#[test]
fn three_hundred_points_with_scatter_give_the_papers_roller_volume_and_flow() {
    const SCATTER_ML: f64 = 0.01;
    let paper = RollerVolume::measured().unwrap();
    let geometry = Geometry::published(3, Variant::Measured);
    let pump = |curve: &RollerVolume| Pump::new(geometry, *curve, Line::PUBLISHED, Line::PUBLISHED).unwrap();
    for seed in 1..=20 {
        let mut deviate = deviates(seed);
        let points: Vec<_> = even_deg(300)
            .map(|deg| point(deg, paper.at(deg.to_radians()) + SCATTER_ML * deviate()))
            .collect();
        let fit = VolumeFit::spline(&points).unwrap();
        // Each value of the spline is the mean of some 12 points around it, which scatters by 0.01/sqrt(12) = 0.003
        // mL; 4 of that, and 0.002 mL for the end, where the paper's flow jumps and the spline's does not.
        let allowed_ml = 4.0 * SCATTER_ML / 12_f64.sqrt() + 0.002;
        let off = off_ml(fit.curve(), |deg| paper.at(deg.to_radians()));
        assert!(off < allowed_ml, "{off} mL, seed {seed}");
        let total = fit.curve().total_ml() - paper.total_ml();
        assert!(total.abs() < allowed_ml, "{total} mL, seed {seed}");
        assert!((fit.rms_ml() / SCATTER_ML - 1.0).abs() < 0.2, "{} mL", fit.rms_ml());
        // The mean flow follows V_r, times three rollers.
        let flow = pump(fit.curve()).revolution_ml() - Pump::three_roller().revolution_ml();
        assert!(flow.abs() < 3.0 * allowed_ml, "{flow} mL per revolution");
        assert_rises(fit.curve());
    }
}

#[test]
fn exact_points_of_the_papers_polynomial_are_met_except_where_its_flow_jumps() {
    let at = |deg: f64| PUBLISHED_COEFFICIENTS_DEG.iter().fold(0.0, |sum, c| sum * deg + c);
    let points: Vec<_> = even_deg(300).map(|deg| point(deg, at(deg))).collect();
    let fit = VolumeFit::spline(&points).unwrap();
    let off = off_ml(fit.curve(), at);
    assert!(off < 0.002, "{off} mL");
}

#[test]
fn order_and_runs_do_not_matter() {
    let mut deviate = deviates(3);
    let sorted: Vec<_> = even_deg(200).map(|deg| point(deg, smooth_ml(deg) + 0.01 * deviate())).collect();
    // Every second point first, and the others backwards.
    let (one, other): (Vec<_>, Vec<_>) = sorted.iter().enumerate().partition(|(n, _)| n % 2 == 0);
    let mixed: Vec<_> = one.into_iter().chain(other.into_iter().rev()).map(|(_, point)| *point).collect();
    let (fit, same) = (VolumeFit::spline(&sorted).unwrap(), VolumeFit::spline(&mixed).unwrap());
    let off = off_ml(fit.curve(), |deg| same.curve().at(deg.to_radians()));
    assert!(off < 1e-12, "{off} mL");
    assert!((fit.rms_ml() - same.rms_ml()).abs() < 1e-15);
    // Two runs at equal angles, the one above and the other below the curve by as much, give the curve.
    let curve: Vec<_> = even_deg(100).map(|deg| point(deg, smooth_ml(deg))).collect();
    let runs: Vec<_> = [0.02, -0.02]
        .iter()
        .flat_map(|off| curve.iter().map(move |p| point(p.angle_deg, p.volume_ml + off)))
        .collect();
    let (fit, both) = (VolumeFit::spline(&curve).unwrap(), VolumeFit::spline(&runs).unwrap());
    let off = off_ml(fit.curve(), |deg| both.curve().at(deg.to_radians()));
    assert!(off < 1e-12, "{off} mL");
    assert!((both.rms_ml() - 0.02).abs() < 1e-6);
}

#[test]
fn clusters_draw_no_knots_and_gaps_have_none() {
    let mut deviate = deviates(5);
    // Forty points within 0.2 deg at each of eight places: knots among them would follow their scatter.
    let places = even_deg(8).flat_map(|deg| (0..40).map(move |n| (deg - 0.2 * f64::from(n) / 39.0).max(0.0)));
    let points: Vec<_> = places.map(|deg| point(deg, smooth_ml(deg) + 0.01 * deviate())).collect();
    let fit = VolumeFit::spline(&points).unwrap();
    assert_rises(fit.curve());
    let off = off_ml(fit.curve(), smooth_ml);
    assert!(off < 0.01, "{off} mL");
    // 26 angles of which all but the last lie within a degree leave one piece.
    let points: Vec<_> =
        (0..25).map(|n| f64::from(n) / 25.0).chain([PHI_DEG]).map(|deg| point(deg, smooth_ml(deg))).collect();
    let fit = VolumeFit::spline(&points).unwrap();
    assert!((fit.curve().total_ml() - 2.1).abs() < 1e-4);
    assert!(off_ml(fit.curve(), smooth_ml) < 0.03);
}

#[test]
fn a_plateau_with_scatter_stays_rising() {
    // The volume rests from a third to two thirds of the engagement.
    let plateau_ml = |deg: f64| {
        let part = 3.0 * deg / PHI_DEG;
        let rise = |part: f64| 0.5 - 0.5 * (PI * part.clamp(0.0, 1.0)).cos();
        1.05 * (rise(part) + rise(part - 2.0))
    };
    let mut deviate = deviates(7);
    let points: Vec<_> = even_deg(400).map(|deg| point(deg, plateau_ml(deg) + 0.005 * deviate())).collect();
    let fit = VolumeFit::spline(&points).unwrap();
    assert_rises(fit.curve());
    assert!(fit.held_deg().count() > 0, "nowhere held");
    let off = off_ml(fit.curve(), plateau_ml);
    assert!(off < 0.01, "{off} mL");
    // Volumes below 0 at the first contact do not lower the start.
    let points: Vec<_> = even_deg(60).map(|deg| point(deg, smooth_ml(deg) - 0.1)).collect();
    assert_rises(VolumeFit::spline(&points).unwrap().curve());
}

#[test]
fn any_cloud_of_points_gives_a_rising_curve_or_one_that_is_refused() {
    let mut deviate = deviates(11);
    let mut refused = 0;
    for n in 0..400 {
        // Spread evenly, crowded at the first contact, or in four narrow clusters; more or less scattered.
        let scatter_ml = 10_f64.powi(n % 5 - 3);
        let place = |even: f64| match n % 3 {
            0 => even,
            1 => even.powi(6),
            _ => (4.0 * even).floor() / 4.0 + 1e-9 * even,
        };
        let deg: Vec<_> = (0..=80).map(|k| PHI_DEG * place(f64::from(k) / 80.0)).collect();
        let points: Vec<_> =
            deg.into_iter().map(|deg| point(deg, smooth_ml(deg) + scatter_ml * deviate())).collect();
        match VolumeFit::spline(&points) {
            Ok(fit) => {
                assert_rises(fit.curve());
                assert!(fit.residuals_ml().all(f64::is_finite));
            }
            Err(ModelError::RollerVolumeFlat { .. }) => refused += 1,
            Err(error) => panic!("{error}"),
        }
    }
    assert!(refused < 40, "{refused} of 400");
}
