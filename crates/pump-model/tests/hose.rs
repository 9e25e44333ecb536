//! Claims about lines from hoses: the published line, the other formulas for walls, friction in every regime.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::PI;

use proptest::prelude::*;
use pump_model::{Fluid, Hose, Line, ModelError};

/// Hose of the published line: 10x14 mm, 0.331 m, 3.5 MPa, K 5.75.
const PUBLISHED: Hose = Hose {
    bore_radius_mm: 5.0,
    outer_radius_mm: 7.0,
    length_mm: 331.0,
    modulus_mpa: 3.5,
    poisson_ratio: 0.5,
    minor_loss: 5.75,
};

fn water() -> Fluid {
    Fluid { density_kg_m3: 997.0, ..Fluid::water(25.0).unwrap() }
}

#[test]
fn the_published_line_follows_from_its_hose() {
    let compliance = PUBLISHED.compliance_ml_kpa(&water());
    assert!((compliance - 0.0455).abs() < 5e-5, "{compliance}");
    assert!((PUBLISHED.inertance_kpa_s2_ml(&water()) - Line::PUBLISHED.inertance_kpa_s2_ml).abs() < 5e-6);
    for (flow_ml_s, resistance) in [(3.5, 0.0028), (35.0, 0.020), (210.0, 0.1108)] {
        let line = PUBLISHED.line(&water(), 88.637, flow_ml_s).unwrap();
        let error = line.resistance_kpa_s_ml / resistance - 1.0;
        assert!(error.abs() < 0.0105, "{} at {flow_ml_s}", line.resistance_kpa_s_ml);
    }
    let at_210 = PUBLISHED.line(&water(), 88.637, 210.0).unwrap().resistance_kpa_s_ml;
    assert!((at_210 - Line::PUBLISHED.resistance_kpa_s_ml).abs() < 1e-4);
}

#[test]
fn slow_flow_meets_the_resistance_of_laminar_flow() {
    let hose = Hose { minor_loss: 0.0, ..PUBLISHED };
    // The expected resistance is 128 mu l/(pi d⁴) in SI, to kPa s/mL.
    let expected = 128.0 * water().viscosity_mpa_s * 1e-3 * 0.331 / (PI * 1e-8) * 1e-9;
    for flow in [0.0, 1e-300, 1e-6, 1.0, -1.0] {
        let found = hose.line(&water(), 88.637, flow).unwrap().resistance_kpa_s_ml;
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} at {flow}");
    }
}

#[test]
fn friction_factors_are_those_of_the_regimes() {
    let hose = Hose { minor_loss: 0.0, ..PUBLISHED };
    let friction = hose.friction(&water()).unwrap();
    let factor = |reynolds: f64| {
        let flow = reynolds / friction.reynolds(1.0);
        let speed_m_s = flow / (PI * 25.0);
        1e3 * friction.drop_kpa(flow) / (0.331 / 0.01 * 0.5 * 997.0 * speed_m_s * speed_m_s)
    };
    assert!((factor(1000.0) * 1000.0 / 64.0 - 1.0).abs() < 1e-6);
    // The factors are those of Prandtl's law of smooth pipes, 1/sqrt(f) = 2 log10(Re sqrt(f)) - 0.8: 0.03089,
    // 0.01799, 0.01165.
    for (reynolds, prandtl) in [(1e4, 0.030_89), (1e5, 0.017_99), (1e6, 0.011_65)] {
        assert!((factor(reynolds) / prandtl - 1.0).abs() < 0.03, "{} at {reynolds}", factor(reynolds));
    }
}

proptest! {
    #[test]
    fn the_wall_is_wylie_and_streeters(
        bore in 0.2..20.0_f64, wall in 0.01..30.0_f64, modulus in 0.5..1e5_f64, poisson in 0.0..=0.5_f64,
    ) {
        let hose = Hose {
            bore_radius_mm: bore,
            outer_radius_mm: bore + wall,
            modulus_mpa: modulus, poisson_ratio: poisson, ..PUBLISHED
        };
        let (d, t) = (2.0 * bore, wall);
        // Wylie and Streeter's factor is d/(E t) (2 t/d (1 + nu) + d (1 - nu²)/(d + t)), per MPa.
        let factor = d / (modulus * t) * (2.0 * t * (1.0 + poisson) / d + d * (1.0 - poisson * poisson) / (d + t));
        let expected = hose.volume_ml() * (1.0 / water().bulk_modulus_mpa + factor) * 1e-3;
        prop_assert!((hose.compliance_ml_kpa(&water()) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn drops_are_odd_rise_with_the_flow_and_have_the_slope_that_is_said(
        bore in 0.3..10.0_f64, viscosity in 0.2..100.0_f64, loss in 0.0..20.0_f64, exponent in -6.0..4.0_f64,
    ) {
        let hose = Hose { bore_radius_mm: bore, outer_radius_mm: bore + 2.0, minor_loss: loss, ..PUBLISHED };
        let friction = hose.friction(&Fluid { viscosity_mpa_s: viscosity, ..water() }).unwrap();
        let flow = 10.0_f64.powf(exponent);
        prop_assert_eq!(friction.drop_kpa(-flow), -friction.drop_kpa(flow));
        prop_assert_eq!(friction.slope_kpa_s_ml(-flow), friction.slope_kpa_s_ml(flow));
        let h = 1e-5 * flow;
        let difference = (friction.drop_kpa(flow + h) - friction.drop_kpa(flow - h)) / (2.0 * h);
        let slope = friction.slope_kpa_s_ml(flow);
        prop_assert!(slope > 0.0 && (difference / slope - 1.0).abs() < 1e-6, "{} {}", difference, slope);
    }
}

#[test]
fn hoses_that_cannot_be_are_refused_by_name() {
    let refused = |hose: Hose| {
        let error = hose.line(&water(), 88.637, 1.0).unwrap_err();
        assert!(matches!(error, ModelError::OutOfRange { .. }), "{error}");
        error.to_string()
    };
    assert!(refused(Hose { outer_radius_mm: 5.0, ..PUBLISHED }).contains("more than its bore radius"));
    assert!(refused(Hose { poisson_ratio: 0.51, ..PUBLISHED }).contains("Poisson ratio of the hose is 0.51"));
    assert!(refused(Hose { minor_loss: -1.0, ..PUBLISHED }).contains("minor-loss"));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(Hose { bore_radius_mm: bad, ..PUBLISHED });
        refused(Hose { length_mm: bad, ..PUBLISHED });
        refused(Hose { modulus_mpa: bad, ..PUBLISHED });
    }
    assert!(PUBLISHED.line(&water(), f64::NAN, 1.0).is_err());
    assert!(PUBLISHED.line(&water(), 88.637, f64::NAN).is_err());
    assert!(PUBLISHED.line(&Fluid { viscosity_mpa_s: 0.0, ..water() }, 88.637, 1.0).is_err());
}
