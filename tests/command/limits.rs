//! Smooth flow and the fastest dose, as typed and reported.

use crate::user::{User, number};

#[test]
fn smooth_flow_changes_the_ripple_and_nothing_that_is_delivered() {
    let user = User::new();
    let even = user.json(&["25mL", "--dry-run", "--rate", "4mL/s"]);
    let smooth = user.json(&["25mL", "--dry-run", "--rate", "4mL/s", "--smooth"]);
    for key in ["steps", "planned_ml", "end_angle_deg", "carry_ml"] {
        assert_eq!(even[key], smooth[key], "{key}");
    }
    let rms = |report: &serde_json::Value, when: &str| report[when]["rms"].as_f64();
    assert_eq!(rms(&even, "ripple_after"), rms(&even, "ripple_before"));
    assert_eq!(rms(&smooth, "ripple_before"), rms(&even, "ripple_before"));
    assert!(rms(&smooth, "ripple_after") < Some(0.003), "{smooth}");
    assert!((number(&smooth, "cruise_flow_ml_s") - 4.0).abs() < 1e-9);
    assert!(number(&smooth, "cruise_speed_rpm") > 5.0 * number(&even, "cruise_speed_rpm"));

    let done = user.json(&["25mL", "--rate", "4mL/s", "--smooth"]);
    assert!((number(&done, "delivered_ml") - number(&done, "planned_ml")).abs() < 1e-6);
    assert!(user.command(&["home", "--unknown"]).status().unwrap().success());
    assert!(user.is_refused(&["25mL", "--smooth"]).contains("a smooth flow needs the rollers' angle"));
    assert!(user.is_refused(&["status", "--smooth"]).contains("--smooth means nothing to `dose status`"));
}

#[test]
fn the_fastest_rate_is_limited_by_what_binds_and_warns_that_it_is_close() {
    let user = User::new();
    let motor = user.json(&["60mL", "--dry-run", "--rate", "max"]);
    assert_eq!(motor["limited_by"], "speed");
    assert!((number(&motor, "cruise_speed_rpm") - 170.0).abs() < 1e-9);
    let inlet = user.json(&["60mL", "--dry-run", "--rate", "max", "--min-inlet-pressure", "75kPaa"]);
    assert_eq!(inlet["limited_by"], "inlet_pressure");
    assert!(number(&inlet, "inlet_min_kpa") >= 75.0 && number(&inlet, "inlet_min_kpa") < 75.01);
    assert!(inlet["warnings"][0].as_str().is_some_and(|text| text.contains("inlet pressure comes close")));

    let refused = user.is_refused(&["60mL", "--rate", "60mL/s", "--min-inlet-pressure", "75kPaa"]);
    let offered = refused.split("; ").last().and_then(|text| text.split(' ').next()).map(str::to_owned);
    let offered = format!("{}mL/s", offered.unwrap_or_default());
    let held = user.json(&["60mL", "--dry-run", "--rate", &offered, "--min-inlet-pressure", "75kPaa"]);
    assert_eq!(held["limited_by"], "none", "{refused}");
}
