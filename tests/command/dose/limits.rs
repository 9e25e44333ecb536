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
    assert!((number(&smooth, "cruise_speed_rpm") / number(&even, "cruise_speed_rpm") - 1.0).abs() < 1e-9);
    assert!(number(&smooth, "peak_speed_rpm") > 5.0 * number(&smooth, "cruise_speed_rpm"));

    let done = user.json(&["25mL", "--rate", "4mL/s", "--smooth"]);
    assert!((number(&done, "delivered_ml") - number(&done, "planned_ml")).abs() < 1e-6);
    assert!(user.command(&["home", "--unknown"]).status().unwrap().success());
    let unknown = user.is_refused(&["25mL", "--smooth"]);
    assert!(unknown.contains("a smooth flow needs the rollers' angle"), "{unknown}");
    assert!(unknown.contains("angle, which is unknown: at this rate a speed"), "{unknown}");
    assert!(unknown.contains("`dose home --set <ANGLE>` says it"), "{unknown}");
    assert!(user.is_refused(&["status", "--smooth"]).contains("`dose status` takes no --smooth"));
}

/// A pump file of the user's own: the example's with these lines in place of others.
fn own_pump(user: &User, changes: &[(&str, &str)]) -> String {
    let mut text = include_str!("../../../examples/pumps/my-pump.toml").to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = user.path("own.toml");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// Nobody knows what the tube is made of.
const NO_COLLAPSE: [(&str, &str); 2] = [
    ("\nmodulus_mpa = 3.5", "\n# modulus_mpa = 3.5"),
    ("\npoisson_ratio = 0.49", "\n# poisson_ratio = 0.49"),
];
const TORQUE: [(&str, &str); 3] = [
    ("# torque_curve_rpm_n_m", "torque_curve_rpm_n_m"),
    ("# occlusion_torque_n_m", "occlusion_torque_n_m"),
    ("# inertia_kg_m2", "inertia_kg_m2"),
];

#[test]
fn the_largest_of_collapse_vapour_and_what_is_given_binds_and_is_named() {
    let user = User::new();
    let limit = |arguments: &[&str]| {
        let report = user.json(&[&["25mL", "--dry-run"], arguments].concat());
        let name = report["inlet_limit"].as_str().unwrap().to_owned();
        (name, number(&report, "inlet_limit_kpa"), report["limits_not_checked"].to_string())
    };
    // PHYSICS: E/(4 (1 - nu²)) (t/r_m)³ below ambient with 3.5 MPa, 0.49, 2 mm and 6 mm is 42.647 kPa of 85.7.
    let (name, kpa, not_checked) = limit(&[]);
    assert_eq!(
        (name.as_str(), not_checked.as_str()),
        ("tube_collapse", r#"["discharge_pressure","torque"]"#)
    );
    assert!((kpa - (85.7 - 42.647)).abs() < 1e-3, "{kpa}");
    // IAPWS SR1-86: 3.1699 kPa at 25 °C.
    let own = own_pump(&user, &NO_COLLAPSE);
    let (name, kpa, not_checked) = limit(&["--pump", &own]);
    assert_eq!(name, "vapour_pressure");
    assert_eq!(not_checked, r#"["discharge_pressure","tube_collapse","torque"]"#);
    assert!((kpa - 3.1699).abs() < 3e-3, "{kpa}");
    let boiling = own_pump(&user, &[("# vapour_kpa = 3.17", "vapour_kpa = 75.0")]);
    assert_eq!(limit(&["--pump", &boiling]).0, "vapour_pressure");
    let refused = user.is_refused(&["60mL", "--speed", "170rpm", "--pump", &boiling]);
    assert!(refused.contains("below the limit of 75.00 kPa, the fluid's vapour pressure; "), "{refused}");
    assert_eq!(limit(&["--min-inlet-pressure", "60kPaa"]).0, "given");
    assert_eq!(limit(&["--min-inlet-pressure", "20kPaa"]).0, "tube_collapse", "a lower one does not lift it");
    // Nothing is known of this fluid and this tube, so nothing is claimed to be checked.
    let oil = own_pump(&user, &[NO_COLLAPSE[0], NO_COLLAPSE[1], ("\"water\"", "\"oil\"")]);
    let report = user.json(&["25mL", "--dry-run", "--pump", &oil]);
    assert!(report["inlet_limit"].is_null());
    assert_eq!(
        report["limits_not_checked"].to_string(),
        r#"["discharge_pressure","suction_pressure","torque"]"#
    );
}

#[test]
fn a_tube_that_would_collapse_refuses_the_dose_and_names_what_can_be_had() {
    let user = User::new();
    let refused = user.is_refused(&["25mL", "--speed", "300rpm", "--pump", "two-roller"]);
    assert!(
        refused.contains("43.05 kPa, at which the tube would collapse (thin-wall estimate)"),
        "{refused}"
    );
    let fastest = user.json(&["25mL", "--rate", "max", "--dry-run", "--pump", "two-roller"]);
    assert_eq!(fastest["limited_by"], "inlet_suction");
    assert!(number(&fastest, "inlet_min_kpa") >= number(&fastest, "inlet_limit_kpa"));
    for half in NO_COLLAPSE {
        let half = own_pump(&user, &[half]);
        assert!(
            user.is_refused(&["25mL", "--pump", &half]).contains("modulus and ratio go together"),
            "{half}"
        );
    }
}

#[test]
fn torque_is_checked_where_it_is_known_and_never_passed_where_it_is_not() {
    let user = User::new();
    let torque = |changes: &[(&str, &str)], rate: &str| {
        user.json(&["25mL", "--dry-run", "--rate", rate, "--pump", &own_pump(&user, changes)])
    };
    let is_checked =
        |report: &serde_json::Value| !report["limits_not_checked"].to_string().contains("torque");
    assert!(is_checked(&torque(&TORQUE, "5mL/s")));
    for left_out in [&[TORQUE[0], TORQUE[2]], &[TORQUE[1], TORQUE[2]]] {
        assert!(!is_checked(&torque(left_out, "5mL/s")), "{left_out:?}");
    }
    let no_inertia = own_pump(&user, &TORQUE[..2]);
    assert!(user.is_refused(&["25mL", "--pump", &no_inertia]).contains("[motor] inertia_kg_m2 is missing"));

    // At its very end the curve still gives what it says.
    let strong = [&TORQUE[..], &[("[170, 0.9]", "[170, 9.0]")]].concat();
    assert_eq!(torque(&strong, "max")["limited_by"], "speed");
    let weak = [&TORQUE[..], &[("[170, 0.9]", "[170, 0.5]")]].concat();
    assert_eq!(torque(&weak, "max")["limited_by"], "torque");
    let weak = own_pump(&user, &weak);
    assert!(
        user.is_refused(&["25mL", "--speed", "170rpm", "--pump", &weak]).contains("the motor would need")
    );
    for (points, why) in [
        ("[[0, 1.2]]", "one point"),
        ("[[0, 1], [5, 1], [5, 2]]", "not rising"),
        ("[[10, 1], [20, 1]]", "not from 0"),
    ] {
        let bad = own_pump(&user, &[TORQUE[0], ("[[0, 1.2], [170, 0.9]]", points)]);
        assert!(user.is_refused(&["25mL", "--pump", &bad]).contains("torque_curve_rpm_n_m is [["), "{why}");
    }
}

#[test]
fn the_fastest_rate_is_limited_by_what_binds_and_warns_that_it_is_close() {
    let user = User::new();
    let motor = user.json(&["60mL", "--dry-run", "--rate", "max"]);
    assert_eq!(motor["limited_by"], "speed");
    assert!((number(&motor, "cruise_speed_rpm") - 170.0).abs() < 1e-9);
    let inlet = user.json(&["60mL", "--dry-run", "--rate", "max", "--min-inlet-pressure", "75kPaa"]);
    assert_eq!(inlet["limited_by"], "inlet_suction");
    assert!(number(&inlet, "inlet_min_kpa") >= 75.0 && number(&inlet, "inlet_min_kpa") < 75.08, "{inlet}");
    assert!(inlet["warnings"][0].as_str().is_some_and(|text| text.contains("inlet pressure comes close")));

    let refused = user.is_refused(&["60mL", "--rate", "60mL/s", "--min-inlet-pressure", "75kPaa"]);
    let offered = refused.split("; ").last().and_then(|text| text.split(' ').next()).map(str::to_owned);
    let offered = format!("{}mL/s", offered.unwrap_or_default());
    let held = user.json(&["60mL", "--dry-run", "--rate", &offered, "--min-inlet-pressure", "75kPaa"]);
    assert_eq!(held["limited_by"], "none", "{refused}");
}

#[test]
fn a_smooth_flow_that_widens_the_swing_of_the_inlet_says_both_ports_ranges() {
    let user = User::new();
    let warnings =
        |more: &[&str]| user.json(&[&["25mL", "--dry-run"], more].concat())["warnings"].to_string();
    let told = warnings(&["--rate", "4mL/s", "--smooth"]);
    assert!(
        told.contains(
            "inlet 78.79 to 95.53 kPa, 86.74 to 88.85 kPa at constant speed; outlet 88.47 to 90.10 kPa, 88.32 to \
             90.45 kPa at constant speed"
        ),
        "{told}"
    );
    let even = user.json(&["25mL", "--dry-run", "--rate", "4mL/s"]);
    assert!((number(&even, "inlet_min_kpa") - 86.74).abs() < 0.005, "{even}");
    assert!((number(&even, "outlet_max_kpa") - 90.45).abs() < 0.005, "{even}");
    assert!(!warnings(&["--rate", "4mL/s"]).contains("smooth"));
    // The motor has no room to follow the rollers at this rate, so nothing widens.
    assert!(!warnings(&["--rate", "55mL/s", "--smooth"]).contains("widens"));
}

#[test]
fn a_limit_that_looks_like_a_gauge_pressure_is_said_to_be_absolute() {
    let user = User::new();
    for limit in [["--max-outlet-pressure", "20kPaa"], ["--min-inlet-pressure", "100kPaa"]] {
        let refused = user.is_refused(&[&["25mL"], &limit[..]].concat());
        assert!(refused.contains("at rest: limits are absolute, so add the ambient pressure"), "{refused}");
    }
    // The ambient pressure is 85.7 kPa.
    assert_eq!(user.json(&["25mL", "--dry-run", "--max-outlet-pressure", "20kPag"])["limited_by"], "none");
    let file = user.types(&["pumps", "show", "three-roller"]).out + "\n[limits]\nmax_outlet_kpa = -20\n";
    std::fs::write(user.path("gauge.toml"), file).unwrap();
    let refused = user.is_refused(&["25mL", "--pump", "gauge.toml"]);
    assert!(
        refused.contains(
            "[limits] max_outlet_kpa is -20; allowed: more than 0: it is absolute, so add the ambient"
        ) && refused.contains("85.7 kPa"),
        "{refused}"
    );
}

#[test]
fn a_limit_in_reverse_names_the_port_that_has_the_role_then() {
    let user = User::new();
    assert!(user.command(&["home", "--set", "0deg"]).status().unwrap().success());
    let refused = |volume: &str, limit: &[&str]| {
        user.is_refused(&[&[volume, "--dry-run", "--rate", "30mL/s"], limit].concat())
    };
    let (pushes, sucks) = (["--max-outlet-pressure", "90kPaa"], ["--min-inlet-pressure", "84kPaa"]);
    assert!(refused("20mL", &pushes).contains("the outlet pressure would reach"));
    assert!(refused("20mL", &sucks).contains("the inlet pressure would fall to"));
    assert!(refused("-20mL", &pushes).contains("the inlet pressure would reach"));
    assert!(refused("-20mL", &sucks).contains("the outlet pressure would fall to"));
    let none = user.is_refused(&["-20mL", "--dry-run", "--rate", "max", "--max-outlet-pressure", "80kPaa"]);
    assert!(none.contains("the inlet pressure would"), "{none}");
    // The fastest dose names the port that limits it, and so does its warning.
    for (volume, port) in [("60mL", "inlet"), ("-60mL", "outlet")] {
        let text = user.types(&[volume, "--dry-run", "--rate", "max", "--min-inlet-pressure", "80kPaa"]).out;
        assert!(text.contains(&format!("(limited by {port} suction)")), "{text}");
        assert!(text.contains(&format!("{port} pressure comes close")), "{text}");
    }
}

#[test]
fn the_pressure_of_the_air_today_takes_the_place_of_the_pump_files() {
    let user = User::new();
    let own = own_pump(&user, &[("# max_outlet_kpa", "# max_kpa")]);
    let report = |more: &[&str]| user.json(&[&["25mL", "--dry-run", "--pump", &own], more].concat());
    assert!((number(&report(&[]), "ambient_kpa") - 101.325).abs() < 1e-9);
    let today = report(&["--ambient", "95kPaa"]);
    assert!((number(&today, "ambient_kpa") - 95.0).abs() < 1e-9, "{today}");
    // Lifts begin at it, and the tube collapses 42.647 kPa below it.
    assert!((number(&today, "inlet_limit_kpa") - (95.0 - 42.647)).abs() < 1e-3, "{today}");
    let gauge = user.is_refused(&["25mL", "--dry-run", "--pump", &own, "--ambient", "95kPag"]);
    assert!(gauge.contains("give it absolute"), "{gauge}");
    let thin = user.is_refused(&["25mL", "--dry-run", "--pump", &own, "--ambient", "1kPaa"]);
    assert!(thin.contains("vapour pressure"), "{thin}");
}

#[test]
fn a_ripple_that_a_smooth_flow_makes_larger_is_said_to_rise() {
    let user = User::new();
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    // The paper's head with 1.2 times its roller volume, whose flow reverses.
    let file = shown.replace("[roller_volume]\n", "[roller_volume]\ntotal_ml = 2.5266\n");
    std::fs::write(user.path("reversing.toml"), file).unwrap();
    let dose = [
        "20uL",
        "--rate",
        "40mL/s",
        "--pump",
        "reversing.toml",
        "--smooth",
        "--dry-run",
        "--start-angle",
        "0deg+-0.1deg",
    ];
    let warnings = user.json(&dose)["warnings"].to_string();
    let said = warnings.split("the ripple at the line's end ").nth(1).unwrap_or_else(|| panic!("{warnings}"));
    let words: Vec<_> = said.split(' ').collect();
    let [before, after] = [words[2], words[4]].map(|percent| percent.parse::<f64>().unwrap());
    assert!(words[0] == "rises" && after > before && said.contains("a constant speed is smoother"), "{said}");
}
