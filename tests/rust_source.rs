//! A pump as Rust statics: `dose pumps show NAME --format rust`, compiled.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_bench::displacement::DisplacementError;
use pump_bench::export;
use pump_bench::notice::Remedy;
use pump_bench::{PumpFile, built_in};
use pump_ctl::generated::torque_points;
use pump_model::generated::{flow_curve, flow_pieces, pump as generated_pump, roller_volume, volume_pieces};
use pump_model::{FlowCurve, Pump, RollerVolume};

#[path = "../examples/firmware/src/pump.rs"]
#[allow(unreachable_pub, reason = "written by the command, for a module or a crate")]
mod pump;

/// The source of a pump, with the words of the command.
fn rust_source(file: &PumpFile) -> Result<String, DisplacementError> {
    export::rust_source(file, |remedy| match remedy {
        Remedy::PrintSource => "print it anew with `dose pumps show NAME --format rust`",
        other => panic!("{other:?}"),
    })
}

#[test]
fn the_firmwares_statics_are_the_pump_to_the_last_bit() {
    let file = built_in("three-roller").unwrap();
    assert_eq!(pump::PUMP, file.model().unwrap());
    assert_eq!(pump::LIMITS, file.limits());
}

#[test]
fn the_firmwares_statics_are_what_the_command_prints() {
    let printed = rust_source(&built_in("three-roller").unwrap()).unwrap();
    assert_eq!(printed, include_str!("../examples/firmware/src/pump.rs"));
}

#[test]
fn a_torque_that_the_pump_file_knows_is_printed_too() {
    let mut file = built_in("three-roller").unwrap();
    file.motor.torque_curve_rpm_n_m = Some(vec![(0.0, 1.2), (170.0, 0.9)]);
    (file.motor.occlusion_torque_n_m, file.motor.inertia_kg_m2) = (Some(0.4), Some(2e-4));
    let printed = rust_source(&file).unwrap();
    assert!(
        printed.contains("use pump_ctl::plan::{Limits, Lowest, Motor, PressureLimits, SetBy, Torque};"),
        "{printed}"
    );
    let points = torque_points(&file.limits().torque.unwrap().motor);
    assert!(printed.contains(&format!("torque_curve({points:?})")), "{printed}");
    assert!(printed.contains("with_occlusion_n_m(0.4)") && printed.contains("with_inertia_kg_m2(0.0002)"));
}

#[test]
fn a_pump_whose_volumes_depend_on_the_speed_has_no_constants() {
    let text = built_in("three-roller").unwrap().to_toml().replace(
        "[speed_law]\nkind = \"none\"\n",
        "[speed_law]\nkind = \"inlet-pressure\"\ns = 0.953\nd_per_kpa = 2.05e-3\nleast_rpm = 10\nmost_rpm = 170\n\
         residual_percent = 2.4\n",
    );
    let error = rust_source(&PumpFile::parse(&text, "a file").unwrap()).unwrap_err().to_string();
    assert!(error.contains("this file has a speed law; write kind = \"none\""), "{error}");
}

fn curve_anew(curve: &FlowCurve) -> Option<FlowCurve> {
    flow_curve(curve.pitch_rad(), curve.pitch_ml(), &flow_pieces(curve).collect::<Vec<_>>())
}

fn volume_anew(volume: &RollerVolume) -> Option<RollerVolume> {
    let pieces: Vec<_> = volume_pieces(volume).collect();
    roller_volume(volume.engagement_rad(), volume.inset_rad(), volume.total_ml(), &pieces)
}

#[test]
fn any_pump_is_made_anew_from_what_is_printed_of_it() {
    for rollers in ["three-roller", "two-roller"] {
        let whole = built_in(rollers).unwrap().model().unwrap();
        let shifted = (1..40).map(|n| whole.shifted(0.37 * f64::from(n)).unwrap());
        for pump in [whole, whole.scaled(1.02).unwrap()].into_iter().chain(shifted) {
            let lines = [*pump.inlet(), *pump.outlet()];
            let curves = [pump.inlet_curve(), pump.outlet_curve()].map(curve_anew);
            let anew: Option<Pump> =
                generated_pump(*pump.geometry(), volume_anew(pump.roller_volume()), lines, curves);
            assert_eq!(anew, Some(pump), "{rollers}");
        }
    }
}

#[test]
fn a_damaged_curve_makes_no_pump_and_no_panic() {
    let pump = built_in("three-roller").unwrap().model().unwrap();
    let curve = pump.outlet_curve();
    let pieces: Vec<_> = flow_pieces(curve).collect();
    let remade = |pieces: &[_]| flow_curve(curve.pitch_rad(), curve.pitch_ml(), pieces);
    let with = |change: fn(&mut (f64, f64, [f64; 6]))| {
        let mut damaged = pieces.clone();
        change(&mut damaged[1]);
        remade(&damaged)
    };
    assert_eq!(remade(&pieces), Some(*curve));
    assert_eq!(remade(&[]), None);
    assert_eq!(remade(&pieces[..1]), None, "a piece is missing");
    assert_eq!(remade(&pieces.repeat(40)), None, "too many pieces");
    assert_eq!(with(|piece| piece.0 += 1e-3), None, "a gap");
    assert_eq!(with(|piece| piece.1 = -1.0), None, "no length");
    assert_eq!(with(|piece| piece.2[3] = f64::NAN), None, "no number");
    for (pitch_rad, pitch_ml) in [(f64::NAN, 7.1), (0.0, 7.1), (7.0, 7.1), (curve.pitch_rad(), 0.0)] {
        assert_eq!(flow_curve(pitch_rad, pitch_ml, &pieces), None);
    }
    let volume = pump.roller_volume();
    let pieces: Vec<_> = volume_pieces(volume).collect();
    assert_eq!(roller_volume(f64::NAN, 0.0, 2.1, &pieces), None);
    assert_eq!(roller_volume(volume.engagement_rad(), 0.0, 2.1, &pieces.repeat(40)), None);
    assert_eq!(roller_volume(volume.engagement_rad(), 0.0, 2.1, &[(0.0, [f64::INFINITY; 6])]), None);
}
