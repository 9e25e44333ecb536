//! Claims about volume against speed, from the published summary numbers.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::TAU;

use pump_model::{Line, ModelError, Pump, SpeedLaw, SpeedLawFlow, Variant};

/// Returns the results at the speeds of the paper's tests, every 10 r/min.
///
/// Each is the volume of ten revolutions by the law and by the linear model with V_r 2.06, mL, and the
/// largest inlet pressure of the steady state, kPa.
fn volumes(rollers: u32, fastest_rpm: u32) -> Vec<(f64, f64, f64)> {
    let pump = Pump::preset(rollers, Variant::Measured).unwrap();
    let linear_ml = 10.0 * Pump::preset(rollers, Variant::Published).unwrap().revolution_ml();
    (1..=fastest_rpm / 10)
        .map(|n| {
            let speed = f64::from(10 * n) * TAU / 60.0;
            let law_ml = 10.0 * SpeedLaw::PUBLISHED.revolution_ml(&pump, speed).unwrap();
            (law_ml, linear_ml, pump.steady_state(speed).unwrap().inlet.max_kpa)
        })
        .collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<_> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

fn pearson(pairs: &[(f64, f64)]) -> f64 {
    let (mean_a, mean_b) = (mean(pairs.iter().map(|pair| pair.0)), mean(pairs.iter().map(|pair| pair.1)));
    let moment = |of: fn(f64, f64) -> f64| mean(pairs.iter().map(|(a, b)| of(a - mean_a, b - mean_b)));
    moment(|a, b| a * b) / (moment(|a, _| a * a) * moment(|_, b| b * b)).sqrt()
}

#[test]
fn the_published_means_deviations_and_correlations_come_out() {
    for (rollers, fastest_rpm, mean_ml, nrmse_percent, correlation) in
        [(3, 170, 211.37, 1.90, 0.87), (2, 300, 232.35, 2.01, 0.97)]
    {
        let runs = volumes(rollers, fastest_rpm);
        let found_ml = mean(runs.iter().map(|run| run.0));
        assert!((found_ml - mean_ml).abs() < 0.006, "{found_ml}");
        let rms_ml = mean(runs.iter().map(|(law, linear, _)| (law - linear).powi(2))).sqrt();
        assert!((100.0 * rms_ml / found_ml - nrmse_percent).abs() < 0.006, "{}", 100.0 * rms_ml / found_ml);
        let pairs: Vec<_> = runs.iter().map(|(law, _, peak_kpa)| (*law, *peak_kpa)).collect();
        assert!((pearson(&pairs) - correlation).abs() < 0.006, "{}", pearson(&pairs));
    }
}

#[test]
fn without_distensibility_the_volume_is_that_of_the_segments_at_every_speed() {
    let pump = Pump::three_roller();
    let stiff = SpeedLaw { distensibility_per_kpa: 0.0, ..SpeedLaw::PUBLISHED };
    let at = |rpm: f64| stiff.revolution_ml(&pump, rpm * TAU / 60.0).unwrap();
    // The expected volume is 0.953 x 27.63489 - 3/2 (2.105466 + 1.541325).
    assert!((at(10.0) - at(170.0)).abs() < 1e-12 && (at(10.0) - 20.865_864).abs() < 1e-5, "{}", at(10.0));
}

#[test]
fn laws_and_speeds_that_mean_nothing_are_refused() {
    let pump = Pump::three_roller();
    for law in [
        SpeedLaw { scale: 0.0, ..SpeedLaw::PUBLISHED },
        SpeedLaw { distensibility_per_kpa: -1e-3, ..SpeedLaw::PUBLISHED },
        SpeedLaw { closure_rad: f64::NAN, ..SpeedLaw::PUBLISHED },
        SpeedLaw { ambient_kpa: 0.0, ..SpeedLaw::PUBLISHED },
        SpeedLaw { scale: 0.1, ..SpeedLaw::PUBLISHED },
    ] {
        assert!(matches!(law.revolution_ml(&pump, 10.0), Err(ModelError::OutOfRange { .. })), "{law:?}");
    }
    for speed in [0.0, f64::INFINITY, f64::NAN] {
        assert!(SpeedLaw::PUBLISHED.revolution_ml(&pump, speed).is_err());
    }
}

#[test]
fn in_reverse_the_outlets_line_traps_what_the_inlets_does_forward() {
    let at = |inlet: Line, outlet: Line, speed: f64| {
        let base = Pump::three_roller();
        let pump = Pump::new(*base.geometry(), *base.roller_volume(), inlet, outlet).unwrap();
        SpeedLaw::PUBLISHED.revolution_ml(&pump, speed).unwrap()
    };
    let one = Line::PUBLISHED;
    let other = Line { resistance_kpa_s_ml: 0.2, reservoir_kpa: 95.0, ..one };
    for speed in [1.0, 5.3, 17.0] {
        assert!((at(one, other, speed) - at(other, one, -speed)).abs() < 1e-9, "{speed}");
        assert!((at(one, other, speed) - at(one, other, -speed)).abs() > 0.05, "{speed}");
    }
}

#[test]
fn a_flow_gives_its_speed_and_the_slower_of_two() {
    // An inlet with little damping bends the flow: it falls where the line is in resonance.
    let light = Line { resistance_kpa_s_ml: 0.012, ..Line::PUBLISHED };
    let base = Pump::three_roller();
    let bent = Pump::new(*base.geometry(), *base.roller_volume(), light, Line::PUBLISHED).unwrap();
    let steep = SpeedLaw { distensibility_per_kpa: 6e-3, ..SpeedLaw::PUBLISHED };
    let mut falls = 0;
    for (law, pump) in [(SpeedLaw::PUBLISHED, base), (steep, bent)] {
        let flow = SpeedLawFlow::new(&law, &pump, [1.0, 18.0], false).unwrap();
        let (largest_ml_s, _) = flow.largest().unwrap();
        let mut before_ml_s = 0.0;
        for n in 0..=200 {
            let speed = 1.0 + 0.085 * f64::from(n);
            let flow_ml_s = flow.at(speed).unwrap();
            assert!(flow_ml_s <= largest_ml_s * (1.0 + 1e-12));
            falls += i32::from(flow_ml_s < before_ml_s);
            before_ml_s = flow_ml_s;
            let found = flow.speed_rad_s(flow_ml_s).unwrap().unwrap();
            assert!(found <= speed * (1.0 + 1e-9), "{found} {speed}");
            assert!((flow.at(found).unwrap() / flow_ml_s - 1.0).abs() < 1e-10, "{found} {speed}");
        }
        assert!(flow.speed_rad_s(largest_ml_s).unwrap().is_some());
        for refused in [largest_ml_s * (1.0 + 1e-9), 0.5 * flow.at(1.0).unwrap(), -5.0, f64::NAN] {
            assert_eq!(flow.speed_rad_s(refused).unwrap(), None, "{refused}");
        }
    }
    assert!(falls > 5, "{falls}");
}

#[test]
fn speeds_that_bound_nothing_are_refused() {
    let (law, pump) = (SpeedLaw::PUBLISHED, Pump::three_roller());
    for speeds in [[0.0, 1.0], [2.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        assert!(SpeedLawFlow::new(&law, &pump, speeds, false).is_err(), "{speeds:?}");
    }
}
