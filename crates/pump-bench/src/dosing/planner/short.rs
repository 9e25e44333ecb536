//! Tests of short doses of a pump whose displacement depends on the speed: the speed that they reach depends on
//! their steps and ramps, and these on the displacement.

use pump_ctl::plan::{PlanError, Ramps};
use pump_model::units::rpm;

use super::tests::stored;
use super::*;
use crate::dosing::{DoseRequest, Prepared};
use crate::record::PhaseSource;

/// Slowest and fastest speed of the calibration, in r/min.
const SPEEDS_RPM: [f64; 3] = [10.0, 60.0, 120.0];

/// Number of doses of each pump and slope.
const DOSES: u32 = 10;

/// Plans random doses of 5 uL to 5 mL as fast as possible, calibrated with a slope or not, and checks each.
fn check_fastest(name: &str, slope_per_rpm: Option<f64>) {
    let file = crate::catalogue::built_in(name).unwrap();
    let base = file.model().unwrap();
    let pump = SpeedDependentPump::constant(base);
    let stored = slope_per_rpm.map(|slope_per_rpm| stored(&file, slope_per_rpm, &SPEEDS_RPM));
    let planner = Planner { file: &file, pump: &pump, stored: stored.as_ref(), limits: &file.limits() };
    for n in 1..=DOSES {
        // Multiples of these numbers fill the square evenly (Roberts, "The unreasonable effectiveness of
        // quasirandom sequences", 2018).
        let part = |base: f64| (f64::from(n) * base).fract();
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        let volume_ml = sign * 5e-3 * 1000_f64.powf(part(0.754_877_666));
        let start_rad = part(0.569_840_291) * std::f64::consts::TAU;
        for ramps in Ramps::ALL {
            let request = Request::new(volume_ml, Cruise::Fastest).with_ramps(ramps);
            let dose = || format!("{name} {slope_per_rpm:?}: {volume_ml} mL, {ramps}");
            let found = planner
                .plan(Phase::known(start_rad), &request)
                .unwrap_or_else(|error| panic!("{}: {error}", dose()));
            let reached_rpm = rpm(found.plan.profile().cruise_rad_s());
            let factor = slope_per_rpm
                .map_or(1.0, |slope| 1.0 + slope * (reached_rpm.clamp(SPEEDS_RPM[0], SPEEDS_RPM[2]) - 50.0));
            // The volume is that of the speed reached, and the steps are those nearest to it.
            let curve = base.outlet_curve();
            let turned_ml = curve.volume_ml(found.plan.end_angle_rad()) - curve.volume_ml(start_rad);
            let step_ml = base.nominal_ml_rad() * found.plan.step_rad();
            let off_ml = (found.plan.planned_ml() - factor * turned_ml).abs();
            assert!(off_ml < 0.03 * step_ml, "{}: {off_ml}", dose());
            let missed_ml = (found.plan.planned_ml() - volume_ml).abs();
            assert!(missed_ml < 0.51 * factor.max(1.0) * step_ml, "{}: {missed_ml}", dose());
            let is_too_short = slope_per_rpm.is_some() && reached_rpm < SPEEDS_RPM[0];
            let says_so = found.warning.as_ref().is_some_and(|warning| warning.contains("too short"));
            assert_eq!(says_so, is_too_short, "{}: {:?}", dose(), found.warning);
        }
    }
}

#[test]
fn every_short_dose_has_a_fastest_speed_with_its_own_displacement() {
    for (name, _) in crate::catalogue::BUILT_IN {
        check_fastest(name, None);
        for slope_per_rpm in [-1e-3, -4e-4, 4e-4, 1e-3] {
            check_fastest(name, Some(slope_per_rpm));
        }
    }
}

#[test]
fn a_time_without_room_for_gentle_ramps_is_met_with_a_warning() {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let model = file.model().unwrap();
    let within = |time_s: f64| {
        let request = DoseRequest { cruise: Some(Cruise::Within { time_s }), ..DoseRequest::dose(3.0) };
        Prepared::new(&file, &model, request, Phase::known(0.4), PhaseSource::Given, 0.0)
    };
    let Err(DoseError::Plan(PlanError::TimeTooShort { fastest_s, .. })) = within(1e-3) else {
        panic!("no dose takes a millisecond")
    };
    let warnings = |time_s: f64| {
        let prepared = within(time_s).unwrap();
        let takes_s = prepared.plan.profile().duration_s() + prepared.prediction.settle_s;
        assert!(takes_s <= time_s, "{takes_s} of {time_s}");
        prepared
            .warnings
            .into_iter()
            .filter(|warning| warning.text().contains("leaves no room for ramps"))
            .count()
    };
    assert_eq!((warnings(1.01 * fastest_s), warnings(3.0 * fastest_s)), (1, 0));
}
