//! Pumps whose volume of a revolution depends on the speed.

use std::fs;

use pump_model::units::rad_s;
use pump_model::{Pump, SpeedLaw};

use crate::user::{User, number};

const TABLE: &str = "[speed_law]\nkind = \"inlet-pressure\"\ns = 0.953\nd_per_kpa = 2.05e-3\nleast_rpm = 10\n\
                     most_rpm = 170\nresidual_percent = 2.4\n";

/// A pump file of the built-in pump with the published law.
fn with_law(user: &User) {
    let text = user.types(&["pumps", "show", "three-roller"]).out;
    let off = "[speed_law]\nkind = \"none\"\n";
    assert!(text.contains(off), "the file says so: {text}");
    fs::write(user.path("lawful.toml"), text.replace(off, TABLE)).unwrap();
}

#[test]
fn a_pump_files_speed_law_is_in_its_check_in_doses_and_in_the_steady_state() {
    let user = User::new();
    with_law(&user);
    let check = user.types(&["pumps", "check", "lawful.toml"]).out;
    assert!(check.contains("speed law inlet-pressure, s 0.953, D 2.05e-3 /kPa"), "{check}");

    let law = |rpm: f64| SpeedLaw::PUBLISHED.factor(&Pump::three_roller(), rad_s(rpm)).unwrap();
    let dose = user.json(&["25mL", "--speed", "90rpm", "--pump", "lawful.toml", "--dry-run"]);
    assert!((number(&dose, "speed_law_factor") - law(90.0)).abs() < 1e-6, "{dose}");
    assert!((number(&dose, "planned_ml") - 25.0).abs() < 3e-3);
    let asked = user.json(&["25mL", "--rate", "31mL/s", "--pump", "lawful.toml", "--dry-run"]);
    assert!((number(&asked, "cruise_flow_ml_s") - 31.0).abs() < 1e-6);
    let plain = user.json(&["25mL", "--rate", "31mL/s", "--dry-run"]);
    assert!(plain["speed_law_factor"].is_null());
    assert!((number(&plain, "cruise_speed_rpm") - number(&asked, "cruise_speed_rpm")).abs() > 0.1);

    let steady = |more: &[&str]| {
        let report = user.json(&[&["simulate", "--speed", "90rpm", "--duration", "1s"], more].concat());
        number(&report["steady"], "mean_flow_ml_s")
    };
    let ratio = steady(&["--pump", "lawful.toml"]) / steady(&[]);
    assert!((ratio - law(90.0)).abs() < 1e-6, "{ratio}");

    let refused = user.is_refused(&["pumps", "show", "./lawful.toml", "--format", "rust"]);
    assert!(refused.contains("this file has a speed law"), "{refused}");
    let refused = user.is_refused(&["25mL", "--rate", "400mL/s", "--pump", "lawful.toml"]);
    assert!(refused.contains("r/min at most, so 400 mL/s is beyond"), "{refused}");
    let refused =
        user.is_refused(&["simulate", "--speed", "180rpm", "--duration", "1s", "--pump", "lawful.toml"]);
    assert!(refused.contains("from 10 to 170 r/min"), "{refused}");
}

#[test]
fn runs_at_several_speeds_fit_a_speed_law_that_doses_use() {
    let user = User::new();
    let truth = SpeedLaw { scale: 0.97, distensibility_per_kpa: 1.5e-3, ..SpeedLaw::PUBLISHED };
    let pump = Pump::three_roller();
    let mut text = "speed_rpm,revolutions,volume_ml\n".to_owned();
    for rpm in [20.0, 60.0, 110.0, 160.0] {
        for wobble in [-1e-3, 0.0, 1e-3] {
            let volume_ml = 3.0 * truth.revolution_ml(&pump, rad_s(rpm)).unwrap() * (1.0 + wobble);
            text.push_str(&format!("{rpm},3,{volume_ml}\n"));
        }
    }
    fs::write(user.path("runs.csv"), text).unwrap();
    let said = user.types(&["calibrate", "run", "--from", "runs.csv", "--fit", "speed-law"]);
    assert!(said.code == 0 && said.out.contains("speed law  s 0.97"), "{}{}", said.out, said.err);
    assert!(said.out.contains("D 1.500e-3 ±") && said.out.contains("from the speed law by"), "{}", said.out);
    let stored = user.json(&["calibrate", "list"]);
    let law = &stored["calibrations"][0]["displacement"]["speed_law"];
    assert!((number(law, "scale") - 0.97).abs() < 1e-5, "{law}");
    assert!(user.types(&["calibrate", "list"]).out.contains("s 0.9700, D 1.50e-3 /kPa"));

    let dose = user.json(&["25mL", "--speed", "127rpm"]);
    let expected = truth.factor(&pump, rad_s(127.0)).unwrap();
    assert!((number(&dose["calibration"], "displacement_factor") - expected).abs() < 1e-5, "{dose}");
    assert_eq!(
        (dose["volume_basis"].as_str(), &dose["speed_law_factor"]),
        (Some("calibrated"), &serde_json::Value::Null)
    );
    let refused = user.is_refused(&["25mL", "--rate", "300mL/s"]);
    assert!(refused.contains("calibration 1 holds from 20.0000 to 160.0000 r/min"), "{refused}");
    let refused = user.is_refused(&["calibrate", "run", "--from", "runs.csv", "--fit", "parabola"]);
    assert!(refused.contains("line, factor, speed-law"), "{refused}");
}

#[test]
fn the_example_of_a_fitted_speed_law_prints_what_its_page_shows() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/");
    let text = fs::read_to_string(format!("{root}docs/calibration.md")).unwrap();
    let block = text.split("```text\n$ dose ").find(|block| block.contains("--fit speed-law\n")).unwrap();
    let (typed, shown) = block.split("```").next().unwrap().split_once('\n').unwrap();
    let typed = typed.replace("examples/", &format!("{root}examples/"));
    let said = User::new().types(&typed.split(' ').collect::<Vec<_>>());
    assert_eq!((said.code, said.out.as_str()), (0, shown), "{}", said.err);
}
