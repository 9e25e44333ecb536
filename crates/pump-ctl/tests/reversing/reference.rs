//! The reference numbers of the head with 1.2 times the paper's roller volume.

use pump_ctl::plan::Phase;

use crate::heads::Head;
use crate::{planned, request};

/// Smallest flow per radian, mL/rad, and the angles between which the flow is negative, deg.
const LEAST_ML_RAD: f64 = -0.393_364;
const NEGATIVE_DEG: (f64, f64) = (22.3072, 34.2985);

/// Volume that the head takes back in a pitch, and volume of a revolution, mL.
const BACK_ML: f64 = 0.054_705_9;
const REVOLUTION_ML: f64 = 20.055_213;

/// Errors of a controller that turns V/V_rot revolutions, over all start angles: volume, mL, largest and RMS, %.
const ERRORS: [(f64, f64, f64); 4] =
    [(0.1, 112.0, 54.0), (1.0, 103.0, 51.0), (5.0, 29.5, 15.1), (25.0, 6.0, 3.1)];

#[test]
fn the_flow_reverses_where_it_is_known_to() {
    let pump = Head::reference().pump();
    let curve = pump.outlet_curve();
    assert!(curve.reverses());
    assert!((curve.flow_range_ml_rad().0 - LEAST_ML_RAD).abs() < 5e-7);
    let (from_rad, to_rad) = (NEGATIVE_DEG.0.to_radians(), NEGATIVE_DEG.1.to_radians());
    let hair_rad = 5e-5_f64.to_radians() + 1e-9;
    for (angle_rad, inward) in [(from_rad, 1.0), (to_rad, -1.0)] {
        assert!(curve.flow_ml_rad(angle_rad + inward * hair_rad) < 0.0, "{angle_rad}");
        assert!(curve.flow_ml_rad(angle_rad - inward * hair_rad) > 0.0, "{angle_rad}");
    }
    let (least_ml, most_ml) = curve.volume_range_ml(from_rad - 0.01, to_rad + 0.01);
    assert!((most_ml - least_ml - BACK_ML).abs() < 5e-8, "{}", most_ml - least_ml);
    assert!((pump.revolution_ml() - REVOLUTION_ML).abs() < 5e-7);
}

#[test]
fn a_controller_that_turns_by_the_mean_is_wrong_by_what_is_known() {
    const STARTS: u32 = 20_000;
    let pump = Head::reference().pump();
    let curve = pump.outlet_curve();
    for (volume_ml, largest, rms) in ERRORS {
        let turn_rad = volume_ml / pump.revolution_ml() * core::f64::consts::TAU;
        let off = |n: u32| {
            let start_rad = pump.pitch_rad() * f64::from(n) / f64::from(STARTS);
            100.0 * ((curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad)) / volume_ml - 1.0)
        };
        let worst = (0..STARTS).map(|n| off(n).abs()).fold(0.0, f64::max);
        let mean_square = (0..STARTS).map(|n| off(n).powi(2)).sum::<f64>() / f64::from(STARTS);
        let digit = if volume_ml < 2.0 { 0.5 } else { 0.05 };
        assert!((worst - largest).abs() <= digit, "{volume_ml}: {worst}");
        assert!((mean_square.sqrt() - rms).abs() <= digit, "{volume_ml}: {}", mean_square.sqrt());
    }
}

#[test]
fn a_dose_takes_the_reversal_into_account() {
    let pump = Head::reference().pump();
    // From the maximum the head takes back first, so a small dose waits until that is there again.
    let start_rad = NEGATIVE_DEG.0.to_radians();
    let plan = planned(&pump, Phase::known(start_rad), &request(0.1), 12_800.0).unwrap();
    assert!((plan.planned_ml() - 0.1).abs() < 1e-3);
    let reversal_rad = (NEGATIVE_DEG.1 - NEGATIVE_DEG.0).to_radians();
    assert!(plan.end_angle_rad() - start_rad > 1.5 * reversal_rad, "{plan:?}");
    let back_flow = plan.back_flow(&pump).unwrap();
    assert!(back_flow.reverse_flow_ml > 0.03, "{back_flow:?}");
}
