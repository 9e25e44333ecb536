//! Small doses from a nozzle in air, and pumps that nobody has weighed.

use std::fs;

use serde_json::Value;

use crate::user::{User, number};

/// Writes the three-roller pump with these keys in `[outlet]` and a repeatability measured at 0.8 mL.
fn pump(user: &User, name: &str, outlet: &str) -> String {
    let text = user.types(&["pumps", "show", "three-roller"]).out;
    let text = text.replace("[outlet]\n", &format!("[outlet]\n{outlet}\n"));
    let text = text.replace(
        "repeatability_percent = 0.47\n",
        "repeatability_percent = 0.47\nrepeatability_at_ml = 0.8\n",
    );
    fs::write(user.path(name), text).unwrap();
    name.to_owned()
}

fn share_ml(report: &Value, source: &str) -> f64 {
    let shares = report["uncertainty_budget"].as_array().unwrap();
    number(shares.iter().find(|share| share["source"] == source).unwrap(), "standard_ml")
}

#[test]
fn a_dose_of_5_ul_states_the_drop_at_its_nozzle() {
    let user = User::new();
    let wide = pump(&user, "wide.toml", "end = \"air\"\nnozzle_bore_mm = 10.0");
    let small = ["5uL", "--start-angle", "30deg", "--dry-run", "--pump"];
    let report = user.json(&[&small[..], &[&wide]].concat());
    // Harkins and Brown's table gives a drop of 139.9 uL of water from 10 mm: over sqrt(6), and twice that.
    assert!((share_ml(&report, "drop") / 0.05712 - 1.0).abs() < 0.01, "{report}");
    assert!(number(&report, "expanded_uncertainty_ml") > 0.114, "{report}");
    let text = user.types(&[&small[..], &[&wide, "-v"]].concat()).out;
    assert!(text.contains(", drop 11") && text.contains("drop makes"), "{text}");
    assert!(text.contains("`nozzle_bore_mm` in [outlet]"), "{text}");

    let immersed = pump(&user, "immersed.toml", "end = \"immersed\"");
    let report = user.json(&[&small[..], &[&immersed]].concat());
    assert_eq!((share_ml(&report, "drop"), share_ml(&report, "backflow")), (0.0, 0.0));
    assert!(number(&report, "expanded_uncertainty_ml") < 0.01, "{report}");
    let check = user.types(&["pumps", "check", &wide]).out;
    assert!(check.contains("nozzle    in air; a drop from 10 mm has 140 µL"), "{check}");
    assert!(user.types(&["pumps", "check", &immersed]).out.contains("nozzle    immersed"));
}

#[test]
fn a_back_flow_beyond_the_uncertainty_names_a_rate_that_has_less() {
    let user = User::new();
    let immersed = pump(&user, "immersed.toml", "end = \"immersed\"");
    let dose =
        ["0.8mL", "--start-angle", "110deg+-0deg", "--ramps", "fastest", "--dry-run", "--pump", &immersed];
    let report = user.json(&dose);
    let (back, reverse) = (number(&report, "backflow_ml"), number(&report, "reverse_flow_ml"));
    let expanded = number(&report, "expanded_uncertainty_ml");
    assert!(back > expanded && back < 0.08, "{report}");
    assert!(reverse > back && reverse < 0.2, "{report}");
    let warning = report["warnings"].to_string();
    assert!(
        warning.contains("gives 71.3 µL too much") && warning.contains("does not contain that"),
        "{warning}"
    );
    assert!(warning.contains("; `--rate` sets the rate"), "{warning}");
    let (_, rate) = warning.split_once(", at ").unwrap();
    let (rate, _) = rate.split_once(" it is").unwrap();
    let slower = user.json(&[&dose[..], &["--rate", rate]].concat());
    assert!(number(&slower, "backflow_ml") <= expanded, "{slower}");
    assert!(!slower["warnings"].to_string().contains("too much"), "{slower}");
    // The default ramps leave the line nearly at rest. An immersed nozzle has nothing that hangs.
    assert!(warning.contains("with line-aware ramps it is ") && !warning.contains("--retract"), "{warning}");
    // A long dose has room for it.
    let long = user.types(&["25mL", "--dry-run", "-v", "--pump", &immersed]).out;
    assert!(!long.contains("too much") && long.contains("back flow    "), "{long}");
}

#[test]
fn a_back_flow_within_the_uncertainty_is_warned_of_at_an_end_that_nobody_named() {
    let user = User::new();
    let unnamed = pump(&user, "unnamed.toml", "");
    let dose = |pump: &str| {
        user.json(&[
            "1mL",
            "--start-angle",
            "110deg+-0deg",
            "--ramps",
            "fastest",
            "--dry-run",
            "--pump",
            pump,
        ])
    };
    let report = dose(&unnamed);
    let (back, expanded) = (number(&report, "backflow_ml"), number(&report, "expanded_uncertainty_ml"));
    // Lost at once, it would widen the interval by a tenth or more: 2 b/sqrt(3) is more than sqrt(1.1² - 1) U.
    assert!(back < 0.8 * expanded && 2.0 * back / 3f64.sqrt() > 0.21f64.sqrt() * expanded, "{report}");
    let warned =
        |report: &Value| report["warnings"].to_string().contains("when the motor stops, the line gives");
    assert!(
        warned(&report) && report["warnings"].to_string().contains("unless the nozzle is in air"),
        "{report}"
    );
    let immersed = pump(&user, "immersed.toml", "end = \"immersed\"");
    assert!(!warned(&dose(&immersed)), "an immersed end draws the fluid itself back");
}

#[test]
fn a_nozzle_in_air_has_its_back_flow_in_the_budget() {
    let user = User::new();
    let air = pump(&user, "air.toml", "end = \"air\"\nnozzle_bore_mm = 1.0");
    let dose = ["0.8mL", "--start-angle", "110deg+-0deg", "--ramps", "fastest", "--dry-run", "--pump", &air];
    let report = user.json(&dose);
    let back = number(&report, "backflow_ml");
    assert!((share_ml(&report, "backflow") - back / 3_f64.sqrt()).abs() < 1e-12, "{report}");
    assert!(number(&report, "expanded_uncertainty_ml") > back, "{report}");
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("as much air in their place; the dose's ± contains that"), "{warnings}");
    assert!(warnings.contains("a retraction draws in what then still hangs at the nozzle"), "{warnings}");
    let sucked = user.json(&[&dose[..], &["--retract", "0.1mL"]].concat())["warnings"].to_string();
    assert!(sucked.contains("too much") && !sucked.contains("`--retract`"), "{sucked}");
    // Nobody knows the end: a drop, and no share of a back flow.
    let report = user.json(&["0.8mL", "--start-angle", "110deg", "--dry-run"]);
    assert!(share_ml(&report, "drop") > 0.02 && share_ml(&report, "backflow") == 0.0, "{report}");
}

#[test]
fn a_pump_that_nobody_weighed_says_so_once_until_it_is_calibrated() {
    let user = User::new();
    let own = include_str!("../../../examples/pumps/my-pump.toml");
    fs::write(user.path("own.toml"), own).unwrap();
    let dose = ["25mL", "--dry-run", "--start-angle", "0deg", "--pump", "own.toml"];
    let report = user.json(&dose);
    let said = "nobody has weighed what this pump delivers";
    assert_eq!(report["warnings"].to_string().matches(said).count(), 1, "{report}");
    assert!(report["warnings"].to_string().contains("`dose calibrate run`"), "{report}");
    let volume_ml = number(&report, "planned_ml");
    assert!((share_ml(&report, "model") / volume_ml - 0.13).abs() < 1e-9, "{report}");
    assert!((share_ml(&report, "speed") / volume_ml - 0.087).abs() < 1e-9, "{report}");
    // A copy that keeps the figures of the paper's makers.
    let copy = own.replace("model_percent = 13.0", "model_percent = 2.4").replace("speed_percent", "# speed");
    fs::write(user.path("copy.toml"), copy).unwrap();
    let warned = user.json(&["25mL", "--dry-run", "--pump", "copy.toml"])["warnings"].to_string();
    assert!(warned.contains("the makers of the built-in pump measured of theirs"), "{warned}");
    assert!(!user.json(&["25mL", "--dry-run"])["warnings"].to_string().contains("weighed"));

    let runs = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/calibration/runs.csv");
    let made = user.types(&["calibrate", "run", "--from", runs, "--pump", "own.toml"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let report = user.json(&dose);
    assert!(!report["warnings"].to_string().contains(said), "{report}");
    assert_eq!((share_ml(&report, "model"), share_ml(&report, "speed")), (0.0, 0.0));
}
