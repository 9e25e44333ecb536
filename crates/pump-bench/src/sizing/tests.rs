//! Sizings against calculations by hand. Their constants stand here, so that nothing of the code checks itself.

use std::f64::consts::{PI, TAU};

use super::*;
use crate::catalogue::built_in;
use crate::heads::bought_head;
use crate::units::{Pressure, hose_size};

/// 2 L/h in mL/s.
const FLOW_ML_S: f64 = 2000.0 / 3600.0;

fn duty(inlet: &str, outlet: &str) -> Duty {
    Duty::new(FLOW_ML_S).with_hoses(hose_size(inlet).ok(), hose_size(outlet).ok())
}

/// The duty of the documentation.
fn glycerol() -> Duty {
    duty("6x10mm,1m", "6x10mm,3m")
        .with_fluid(Some("glycerol 50%".to_owned()), Some(20.0))
        .with_lifts(Some(1200.0), Some(500.0))
}

fn near(found: f64, by_hand: f64, part: f64) {
    assert!((found / by_hand - 1.0).abs() < part, "{found} for {by_hand}");
}

#[test]
fn friction_lift_and_margin_are_those_by_hand() {
    let sizing = Sizing::of_catalogue(&glycerol()).unwrap();
    // 50 % glycerol at 20 °C: 1126.3 kg/m³ (CRC Handbook), 6.00 mPa s (Segur and Oberstar); the formula is within 5 %.
    let (density, viscosity_pa_s, flow_m3_s, bore_m) = (1126.3, 6.00e-3, FLOW_ML_S * 1e-6, 6e-3_f64);
    // Hagen-Poiseuille: 128 mu l Q/(pi d⁴).
    let friction_kpa =
        |length_m: f64| 1e-3 * 128.0 * viscosity_pa_s * length_m * flow_m3_s / (PI * bore_m.powi(4));
    near(sizing.inlet.friction_kpa, friction_kpa(1.0), 0.05);
    near(sizing.outlet.friction_kpa, friction_kpa(3.0), 0.05);
    // Re = 4 rho Q/(pi d mu).
    near(sizing.inlet.reynolds.unwrap(), 4.0 * density * flow_m3_s / (PI * bore_m * viscosity_pa_s), 0.05);
    assert_eq!(sizing.inlet.law, Some(FlowLaw::Laminar));
    // Hydrostatics at sea level: 101.325 kPa, 9.80665 m/s².
    near(sizing.inlet.lift_kpa, 1e-3 * density * 9.80665 * 1.2, 2e-3);
    near(sizing.outlet.lift_kpa, 1e-3 * density * 9.80665 * 0.5, 2e-3);
    let suction_kpa = 101.325 - 1e-3 * density * 9.80665 * 1.2 - friction_kpa(1.0);
    assert!((sizing.steady.inlet_mean_kpa - suction_kpa).abs() < 0.03, "{:?}", sizing.steady);
    // Raoult: x_w = (50/18.015)/(50/18.015 + 50/92.094) = 0.83639 of the water's 2.3393 kPa (IAPWS-95 at 20 °C).
    near(sizing.suction.vapour_kpa.unwrap(), 0.836_39 * 2.3393, 2e-3);
    let npsh_m = (suction_kpa - 0.836_39 * 2.3393) / (1e-3 * density * 9.80665);
    assert!((sizing.suction.npsh_mean_m.unwrap() - npsh_m).abs() < 0.01, "{:?}", sizing.suction);
    assert!(sizing.suction.npsh_m < sizing.suction.npsh_mean_m);
    // The head: its own speed gives the flow, half of its largest as nearly as any head's.
    let head = sizing.head.catalogued.as_ref().unwrap();
    near(sizing.speed_rpm * head.ml_per_rev / 60.0, FLOW_ML_S, 1e-9);
    assert!(sizing.speed_rpm > 160.0 && sizing.speed_rpm < 250.0 && head.most_rpm == Some(400.0));
}

#[test]
fn a_head_that_takes_an_hour_for_a_pitch_is_told_to_be_too_large() {
    let head = bought_head("masterflex-ls-16").unwrap();
    let warned = |flow_ml_s: f64| {
        let lines = duty("1.6x4.8mm,1m", "1.6x4.8mm,1m");
        let sizing = Sizing::of_head(head, 4, &Duty { flow_ml_s, ..lines }).unwrap();
        let said = sizing.warnings.iter().map(|warning| warning.text().to_owned());
        said.filter(|text| text.contains("far too large for this flow")).collect::<Vec<_>>()
    };
    // A pitch has 0.8 mL/4: in 1 h at 0.2 mL/h, in 10 h at 0.02 mL/h, where 0.8 mL take 40 h.
    let hour_ml_s = 0.2 / 3600.0;
    assert!(warned(1.01 * hour_ml_s).is_empty());
    let said = warned(0.1 * hour_ml_s);
    assert!(said[0].contains("at 0.00042 r/min, and a pitch takes 10 h"), "{said:?}");
    assert!(said[0].contains("lumps of 0.2 mL") && said.len() == 1, "{said:?}");
}

#[test]
fn a_thick_fluid_chooses_a_head_whose_own_tube_lets_it_in() {
    let thick = duty("6x10mm,1m", "6x10mm,3m").with_fluid(Some("glycerol 99%".to_owned()), Some(25.0));
    let sizing = Sizing::of_catalogue(&thick).unwrap();
    let (own_kpa, margin_kpa) = (sizing.suction.own_kpa.unwrap(), sizing.suction.margin_kpa.unwrap());
    assert!(own_kpa < margin_kpa, "{own_kpa} of {margin_kpa}");
    let head = sizing.head.catalogued.as_ref().unwrap();
    let bore_m = 1e-3 * head.bore_mm.unwrap();
    // Half of the volume of a revolution fills this length of the bore.
    let length_m = 0.5e-6 * sizing.head.ml_per_rev / (0.25 * PI * bore_m * bore_m);
    let viscosity_pa_s = 1e-3 * sizing.viscosity_mpa_s.unwrap();
    let by_hand = 1e-3 * 128.0 * viscosity_pa_s * length_m * FLOW_ML_S * 1e-6 / (PI * bore_m.powi(4));
    near(own_kpa, by_hand, 1e-9);
    assert!(
        sizing.warnings.iter().any(|warning| warning.text().contains("the pump's own tube takes at least"))
    );
    // Nobody knows the viscosity of a fluid by its density alone, and thin ones lose nothing.
    assert!(Sizing::of_catalogue(&glycerol()).unwrap().suction.own_kpa.unwrap() < 1.0);
}

#[test]
fn boiling_water_follows_the_points_of_iapws() {
    // IAPWS-95, saturation: 2.3393 kPa at 20 °C, 19.946 at 60 °C, 47.414 at 80 °C.
    for (degc, vapour_kpa) in [(20.0, 2.3393), (60.0, 19.946), (80.0, 47.414)] {
        let duty = duty("6x10mm,1m", "6x10mm,1m").with_fluid(None, Some(degc)).with_lifts(Some(1000.0), None);
        let sizing = Sizing::of_catalogue(&duty).unwrap();
        near(sizing.suction.vapour_kpa.unwrap(), vapour_kpa, 1e-3);
        let margin_kpa = sizing.steady.inlet_min_kpa - vapour_kpa;
        assert!((sizing.suction.margin_kpa.unwrap() - margin_kpa).abs() < 0.05);
    }
}

#[test]
fn pulsation_far_above_the_lines_own_frequency_falls_as_a_low_pass_tells() {
    // A line of 2nd order: the flow at its end is that at the rollers over |1 - (w/w0)² + i w R C|.
    let sizing = Sizing::of_catalogue(&glycerol()).unwrap();
    let line = sizing.outlet.line;
    let pulses_rad_s = sizing.speed_rpm / 60.0 * TAU * f64::from(sizing.head.rollers);
    let (lc, rc) = (
        line.inertance_kpa_s2_ml * line.compliance_ml_kpa,
        line.resistance_kpa_s_ml * line.compliance_ml_kpa,
    );
    // By hand: L = rho l/A, C = V 2 (1 + nu)/E b²/(b² - a²) for rubber that keeps its volume, R by Hagen-Poiseuille.
    let area_m2 = PI * 9e-6;
    near(line.inertance_kpa_s2_ml, 1126.3 * 3.0 / area_m2 * 1e-9, 2e-3);
    near(line.compliance_ml_kpa, area_m2 * 3.0 * 1e6 * 3.0 / 3500.0 * 25.0 / 16.0, 2e-3);
    near(line.resistance_kpa_s_ml, 128.0 * 6.00e-3 * 3.0 / (PI * 6e-3_f64.powi(4)) * 1e-9, 0.05);
    let low_pass = |harmonic: f64| {
        let w = harmonic * pulses_rad_s;
        1.0 / ((1.0 - w * w * lc).powi(2) + (w * rc).powi(2)).sqrt()
    };
    // The first harmonic of the rollers' flow, from its Fourier integral over a pitch.
    let head = sizing.head.catalogued.as_ref().unwrap();
    let mut file =
        crate::catalogue::CataloguedPump::new("by-hand", head, sizing.head.rollers).pump_file().unwrap();
    file.ambient = crate::pump_file::AmbientTable::default();
    let pump = file.model().unwrap();
    let (pitch, samples) = (pump.pitch_rad(), 20_000);
    let harmonic = |n: f64| {
        let [mut cosine, mut sine] = [0.0, 0.0];
        for k in 0..samples {
            let angle = (f64::from(k) + 0.5) / f64::from(samples) * pitch;
            let (_, flow, _) = pump.at_angle(angle);
            cosine += flow * (n * TAU * angle / pitch).cos();
            sine += flow * (n * TAU * angle / pitch).sin();
        }
        2.0 * (cosine * cosine + sine * sine).sqrt() / f64::from(samples)
    };
    let mean = pump.average_flow_ml_s(1.0);
    let variance: f64 = (1..=12)
        .map(|n| {
            let n = f64::from(n);
            let part = harmonic(n) / mean * low_pass(n);
            0.5 * part * part
        })
        .sum();
    near(sizing.pulsation.end.unwrap().rms, variance.sqrt(), 0.02);
}

#[test]
fn a_turbulent_hose_has_the_friction_of_the_moody_chart() {
    // Water at 20 °C: 998.2 kg/m³, 1.0016 mPa s. 25 mL/s in a bore of 4 mm: Re = 7932, smooth f = 0.0331 (Prandtl and
    // von Karman: 1/sqrt f = 2 log10(Re sqrt f) - 0.8), and 1.5 velocity heads at the ends.
    let file = built_in("three-roller").unwrap();
    let duty = Duty::new(25.0)
        .with_fluid(None, Some(20.0))
        .with_hoses(hose_size("4x8mm,500mm").ok(), hose_size("4x8mm,500mm").ok());
    let sizing = Sizing::of_pump(file, &duty);
    let velocity_m_s = 25e-6 / (PI * 4e-6);
    let friction_kpa = 1e-3 * (0.0331 * 0.5 / 4e-3 + 1.5) * 0.5 * 998.2 * velocity_m_s * velocity_m_s;
    let line = match sizing {
        Ok(sizing) => (sizing.inlet.friction_kpa, sizing.inlet.law),
        Err(SizingError::Suction(short)) => (short.friction_kpa, Some(FlowLaw::Turbulent)),
        Err(error) => panic!("{error}"),
    };
    near(line.0, friction_kpa, 0.03);
    assert_eq!(line.1, Some(FlowLaw::Turbulent));
}

#[test]
fn a_lift_too_high_is_refused_with_the_lift_that_would_do() {
    let high = duty("6x10mm,1m", "6x10mm,1m").with_fluid(None, Some(25.0)).with_lifts(Some(11_000.0), None);
    let Err(SizingError::Suction(short)) = Sizing::of_catalogue(&high) else { panic!("it is refused") };
    // Nobody knows when the tube collapses: 42.65 kPa, which another tube stands, are 4.36 m of water at 25 °C.
    assert_eq!((short.port, short.would_do.most_lift_mm), ("inlet", Some(4300.0)), "{short}");
    assert!(short.reached_kpa < short.limit_kpa && (short.limit_kpa - 3.1699).abs() < 0.01);
    let would_do = Duty { suction_lift_mm: short.would_do.most_lift_mm, ..high.clone() };
    let warned =
        |sizing: Sizing| sizing.warnings.iter().any(|notice| notice.text().contains("the pump sucks with"));
    assert!(!warned(Sizing::of_catalogue(&would_do).unwrap()));
    let more = Duty { suction_lift_mm: Some(4500.0), ..high.clone() };
    assert!(warned(Sizing::of_catalogue(&more).unwrap()));
    // (101.325 - 3.1699) kPa of water, 997 kg/m³, is a column of 10.04 m.
    let most = Duty { suction_lift_mm: Some(10_100.0), ..high };
    assert!(Sizing::of_catalogue(&most).is_err());
}

#[test]
fn a_hose_too_thin_is_refused_with_the_bore_that_would_do() {
    // A suction beyond 42.65 kPa is warned of, and 40 kPa with the pulses of the flow are more.
    for (inlet, outlet, port, bore_mm) in
        [("0.5x3mm,2m", "6x10mm,1m", "inlet", 1.5), ("6x10mm,1m", "0.5x3mm,2m", "outlet", 1.0)]
    {
        let thin = duty(inlet, outlet).with_max_outlet(Some(Pressure::Gauge(100.0)));
        let short = match Sizing::of_catalogue(&thin) {
            Err(SizingError::Suction(short) | SizingError::Discharge(short)) => short,
            other => panic!("{other:?}"),
        };
        // Hagen-Poiseuille at 25 °C: 0.5 mm makes 644 kPa over 2 m, 1 mm 40 kPa.
        assert_eq!((short.port, short.would_do.least_bore_mm), (port, Some(bore_mm)), "{short}");
        near(
            short.friction_kpa,
            1e-3 * 128.0 * 0.89e-3 * 2.0 * FLOW_ML_S * 1e-6 / (PI * 0.5e-3_f64.powi(4)),
            0.02,
        );
    }
}

#[test]
fn a_flow_that_no_head_gives_is_refused_with_what_there_is() {
    let both = |flow_ml_s| Duty { flow_ml_s, ..duty("6x10mm,1m", "6x10mm,1m") };
    let Err(SizingError::NoHead { most_ml_s, largest, .. }) = Sizing::of_catalogue(&both(1000.0)) else {
        panic!("it is refused")
    };
    // The largest flow of the catalogue: 1627.2 mL/min at 400 r/min.
    assert_eq!(largest, "runze-yz1515x-3-18");
    near(60.0 * most_ml_s, 1627.2, 1e-9);
    let slow = bought_head("runze-yz1515x-3-18").unwrap();
    let refused = Sizing::of_head(slow, 3, &both(0.1));
    // 6 mL/min of 4.068 mL per revolution are 1.475 r/min, and 5 are stated.
    assert!(matches!(refused, Err(SizingError::Speed { least_rpm: 5.0, .. })), "{refused:?}");
    let fast = Sizing::of_pump(built_in("three-roller").unwrap(), &Duty::new(83.3));
    assert!(matches!(fast, Err(SizingError::Speed { most_rpm: 170.0, .. })), "{fast:?}");
    let bare = Sizing::of_catalogue(&Duty::new(FLOW_ML_S));
    assert!(matches!(bare, Err(SizingError::NoLine { side: "inlet" })), "{bare:?}");
}

#[test]
fn a_pump_with_its_own_lines_is_sized_as_a_run_of_it() {
    let file = built_in("three-roller").unwrap();
    let flow_ml_s = 35.5308;
    let sizing = Sizing::of_pump(file, &Duty::new(flow_ml_s)).unwrap();
    // The paper's table: 100 r/min.
    assert!((sizing.speed_rpm - 100.0).abs() < 1e-3);
    assert!((sizing.steady.outlet_max_kpa - 104.5105).abs() < 1e-3);
    assert!((sizing.steady.inlet_min_kpa - 73.7963).abs() < 1e-3);
    // The tube collapses at 43.05 kPa, thin-wall estimate.
    assert!((sizing.suction.collapse_kpa.unwrap() - 43.05).abs() < 0.01);
    assert!((sizing.suction.margin_kpa.unwrap() - (73.7963 - 43.05)).abs() < 0.01);
    assert_eq!(sizing.pulsation.end_between, None);
}

#[test]
fn the_curve_leads_through_the_operating_point() {
    let sizing = Sizing::of_catalogue(&glycerol()).unwrap();
    assert!((sizing.curve.last().unwrap().speed_rpm - 400.0).abs() < 1e-9);
    for point in &sizing.curve {
        near(point.flow_ml_s / point.speed_rpm, FLOW_ML_S / sizing.speed_rpm, 1e-9);
    }
    let after = sizing.curve.iter().position(|point| point.speed_rpm > sizing.speed_rpm).unwrap();
    let (low, high) = (&sizing.curve[after - 1], &sizing.curve[after]);
    let part = (sizing.speed_rpm - low.speed_rpm) / (high.speed_rpm - low.speed_rpm);
    let between = low.outlet_mean_kpa + part * (high.outlet_mean_kpa - low.outlet_mean_kpa);
    assert!((between - sizing.steady.outlet_mean_kpa).abs() < 1e-4, "{between}");
}

#[test]
fn the_curve_follows_a_line_through_its_resonance() {
    let sizing = Sizing::of_catalogue(&duty("6x10mm,1m", "6x10mm,3m")).unwrap();
    for swing in [|point: &CurvePoint| point.inlet, |point: &CurvePoint| point.outlet] {
        let swing_kpa = |point: &CurvePoint| swing(point).max_kpa - swing(point).min_kpa;
        let largest_kpa = sizing.curve.iter().map(swing_kpa).fold(0.0, f64::max);
        let at = sizing.curve.iter().position(|point| swing_kpa(point) == largest_kpa).unwrap();
        // From point to point the swing changes by little, so that the peak is round and not a triangle.
        for near in sizing.curve[at - 3..=at + 3].windows(2) {
            let change_kpa = (swing_kpa(&near[1]) - swing_kpa(&near[0])).abs();
            assert!(
                change_kpa < 0.25 * largest_kpa,
                "{change_kpa} of {largest_kpa} kPa at {}",
                near[0].speed_rpm
            );
        }
    }
    assert!(sizing.curve.windows(2).all(|near| near[0].speed_rpm < near[1].speed_rpm));
}
