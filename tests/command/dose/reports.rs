//! Reports and records of a dose.

use std::fs;

use crate::user::{User, number};

#[test]
fn a_dose_says_first_that_no_motor_moved() {
    let answer = User::new().types(&["25mL"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert_eq!(answer.out.lines().next(), Some("SIMULATED: no motor moved"));
    assert!(answer.out.contains("25.0 mL ± 1.4 mL delivered, 25 mL requested"), "{}", answer.out);
    assert_eq!(answer.out.lines().count(), 3, "{}", answer.out);
}

#[test]
fn details_and_the_uncertainty_budget_are_told_when_they_are_asked_for() {
    let user = User::new();
    let brief = user.types(&["25mL", "--dry-run"]).out;
    for option in ["-v", "--verbose"] {
        let long = user.types(&["25mL", "--dry-run", option]).out;
        assert!(long.starts_with(&brief), "{long}");
        for part in [
            "not checked  discharge pressure, torque",
            "rollers      from 0.00° (home) to 435.38°",
            "uncertainty  k = 2, not calibrated; standard, % of volume: model 2.4",
        ] {
            assert!(long.contains(part) && !brief.contains(part), "{part}: {long}");
        }
    }
}

#[test]
fn an_amount_is_echoed_as_it_was_typed() {
    let user = User::new();
    for (typed, shown) in [
        (&["25 g", "--dry-run"][..], " 25 g requested by a balance in air: 25.096 mL"),
        (&["25g", "--dry-run"], " 25 g requested by a balance in air: 25.096 mL"),
        (&["0.025 L", "--dry-run"], " 0.025 L requested"),
        (&["-5mL", "--dry-run"], " -5 mL requested"),
        (&["5mL", "--reverse", "--dry-run"], " -5 mL requested"),
    ] {
        let out = user.types(typed).out;
        assert!(out.contains(shown), "{typed:?}: {out}");
    }
}

#[test]
fn a_warning_appears_once() {
    let user = User::new();
    let text = user.types(&["1.2uL", "--dry-run"]);
    assert_eq!(text.out.matches("a motor step is coarse").count(), 1, "{}", text.out);
    assert_eq!(text.err, "");
    let json = user.types(&["1.2uL", "--dry-run", "--format", "json"]);
    assert_eq!(json.err.matches("a motor step is coarse").count(), 1, "{}", json.err);
}

#[test]
fn the_report_has_every_field_of_the_contract() {
    let report = User::new().json(&["25mL"]);
    for key in [
        "schema",
        "pump",
        "driver",
        "simulated",
        "requested_ml",
        "carry_in_ml",
        "planned_ml",
        "volume_least_ml",
        "volume_most_ml",
        "delivered_ml",
        "volume_basis",
        "expanded_uncertainty_ml",
        "uncertainty_budget",
        "phase",
        "start_angle_deg",
        "end_angle_deg",
        "steps",
        "steps_per_rev",
        "carry_ml",
        "cruise_speed_rpm",
        "cruise_flow_ml_s",
        "mean_flow_ml_s",
        "motion_s",
        "settle_s",
        "backflow_ml",
        "reverse_flow_ml",
        "inlet_min_kpa",
        "inlet_max_kpa",
        "outlet_min_kpa",
        "outlet_max_kpa",
        "ambient_kpa",
        "limited_by",
        "limits_not_checked",
        "warnings",
        "completed",
    ] {
        assert!(!report[key].is_null(), "{key} in {report}");
    }
    assert_eq!(report["schema"], "dose/1");
    assert_eq!(report["phase"]["known"], true);
    assert_eq!(report["phase"]["source"], "home");
    assert_eq!(report["completed"], true);
    assert_eq!(report["measured_motion_s"], report["motion_s"], "a simulated motor keeps to its plan");
    assert!(User::new().json(&["25mL", "--dry-run"])["measured_motion_s"].is_null());
    assert_eq!(report["steps"], 15_480);
    assert!((number(&report, "delivered_ml") - number(&report, "planned_ml")).abs() < 1e-3);
    let turned = number(&report, "end_angle_deg") - number(&report, "start_angle_deg");
    assert!((turned - 15_480.0 * 360.0 / 12_800.0).abs() < 1e-9);
}

#[test]
fn angle_and_carry_pass_from_dose_to_dose_and_add_up() {
    let user = User::new();
    let (mut end_deg, mut carry_ml, mut planned_ml) = (0.0, 0.0, 0.0);
    for volume in ["1mL", "250uL", "-2mL", "7 mL", "0.1mL"] {
        let report = user.json(&[volume]);
        assert!((number(&report, "start_angle_deg") - end_deg).abs() < 1e-9, "{volume}");
        assert_eq!(number(&report, "carry_in_ml"), carry_ml, "{volume}");
        end_deg = number(&report, "end_angle_deg").rem_euclid(360.0);
        carry_ml = number(&report, "carry_ml");
        planned_ml += number(&report, "planned_ml");
    }
    assert!((planned_ml + carry_ml - 6.35).abs() < 1e-12);
    let status = user.json(&["status"]);
    assert!((number(&status, "angle_deg") - end_deg).abs() < 1e-9);
    assert_eq!(number(&status, "carry_ml"), carry_ml);
}

#[test]
fn a_prime_moves_the_rollers_and_leaves_the_carry() {
    let user = User::new();
    let owed = number(&user.json(&["1mL"]), "carry_ml");
    let prime = user.json(&["prime", "20mL"]);
    assert_eq!(number(&prime, "carry_in_ml"), 0.0);
    assert_eq!(number(&prime, "carry_ml"), owed, "what the next dose owes has not changed");
    let status = user.json(&["status"]);
    assert_eq!(number(&status, "carry_ml"), owed);
    assert!((number(&status, "angle_deg") - number(&prime, "end_angle_deg").rem_euclid(360.0)).abs() < 1e-9);
}

#[test]
fn a_dry_run_reads_the_record_and_writes_nothing() {
    let user = User::new();
    let report = user.json(&["25mL", "--dry-run"]);
    assert!(report["delivered_ml"].is_null());
    assert_eq!(report["completed"], false);
    assert!(!user.path("state").exists());
    user.json(&["1mL"]);
    let before = user.record();
    assert_eq!(user.json(&["1mL", "--dry-run"])["phase"]["source"], "recorded");
    assert_eq!(user.record(), before);
}

#[test]
fn reverse_is_the_same_as_a_negative_volume() {
    let reverse = |arguments: &[&str]| {
        let mut report = User::new().json(arguments);
        // The clock goes on between the two.
        report.as_object_mut().unwrap().remove("time");
        report
    };
    let (flag, minus) = (reverse(&["5mL", "--reverse"]), reverse(&["-5mL"]));
    assert_eq!(flag, minus);
    assert!(minus["steps"].as_i64().unwrap() < 0);
    assert!((number(&minus, "delivered_ml") + 5.0).abs() < 0.002);
    assert!(User::new().is_refused(&["--reverse", "-5mL"]).contains("both mean reverse"));
}

#[test]
fn every_way_to_say_how_fast_is_obeyed() {
    let user = User::new();
    let dry = |arguments: &[&str]| user.json(&[&["25mL", "--dry-run"], arguments].concat());
    assert!((number(&dry(&[]), "cruise_flow_ml_s") - 5.0).abs() < 1e-9);
    assert!((number(&dry(&["--rate", "600 mL/min"]), "cruise_flow_ml_s") - 10.0).abs() < 1e-9);
    assert!((number(&dry(&["--speed", "100rpm"]), "cruise_speed_rpm") - 100.0).abs() < 1e-9);
    let within = dry(&["--within", "4s"]);
    let total = number(&within, "motion_s") + number(&within, "settle_s");
    assert!(total <= 4.0 && total > 3.96, "{total}");
    let fastest = dry(&["--within", "4s", "--ramps", "fastest"]);
    // The default by its name, and by that of earlier versions.
    let steps = |ramps| dry(&["--within", "4s", "--ramps", ramps])["motion_s"].clone();
    assert_eq!(
        (steps("line"), steps("line-aware")),
        (dry(&["--within", "4s"])["motion_s"].clone(), steps("line"))
    );
    let total = number(&fastest, "motion_s") + number(&fastest, "settle_s");
    assert!(total <= 4.0 && total > 3.9, "{total}");
    assert!(
        user.is_refused(&["25mL", "--rate", "5mL/s", "--speed", "100rpm"]).contains("exclude each other")
    );
}

#[test]
fn a_mass_is_the_reading_of_a_balance_in_the_ambient_air() {
    let user = User::new();
    let report = user.json(&["25g", "--dry-run"]);
    // ISO 8655-6:2002, table of Z at 25 °C: 1.0038 mL/g at 80.0 and 85.0 kPa.
    assert!((number(&report, "requested_ml") / 25.0 - 1.0038).abs() < 0.6e-4, "{report}");
    let balance_g = number(&report, "balance_g");
    assert!((number(&report, "planned_ml") / balance_g - 1.0038).abs() < 0.6e-4, "{report}");
    // The air of the sea's level carries more: 1.0040 at 101.3 kPa.
    let own = user.types(&["pumps", "show", "three-roller"]).out;
    let low = own.replace("pressure_kpa = 85.7", "pressure_kpa = 101.3");
    assert_ne!(own, low);
    fs::write(user.path("low.toml"), low).unwrap();
    let low = user.json(&["25g", "--dry-run", "--pump", "low.toml"]);
    assert!((number(&low, "requested_ml") / 25.0 - 1.0040).abs() < 0.6e-4, "{low}");
    let volume = user.json(&["25mL", "--dry-run"]);
    assert_eq!(number(&volume, "requested_ml"), 25.0);
    assert!((number(&volume, "balance_g") - 25.0 / 1.0038).abs() < 3e-3, "{volume}");
    let long = user.types(&["25mL", "--dry-run", "-v"]).out;
    assert!(long.contains("balance      shows 24.9 g") && long.contains("in air of 85.7 kPa"), "{long}");
}

#[test]
fn predicted_pressures_say_how_unsure_they_are() {
    let user = User::new();
    let report = user.json(&["25mL", "--rate", "35mL/s", "--dry-run"]);
    for port in ["inlet", "outlet"] {
        let of = |key: &str| number(&report, &format!("{port}_{key}"));
        // Twice sqrt(2 (1 - 0.74)) of the RMS of a sine of that swing.
        let swing_kpa = of("max_kpa") - of("min_kpa");
        let expected_kpa = 2.0 * (2.0 * 0.26_f64).sqrt() * swing_kpa / 8.0_f64.sqrt();
        assert!((of("pressure_uncertainty_kpa") - expected_kpa).abs() < 1e-9, "{report}");
    }
    // 8 % of the room are left, and less than the prediction is sure of.
    let rest_kpa = 88.637;
    let limit_kpa = rest_kpa + (number(&report, "outlet_max_kpa") - rest_kpa) / 0.92;
    let limit = format!("{limit_kpa}kPaa");
    let near = user.json(&["25mL", "--rate", "35mL/s", "--dry-run", "--max-outlet-pressure", &limit]);
    assert!(near["warnings"].to_string().contains("the prediction is uncertain by"), "{near}");
    assert!(!report["warnings"].to_string().contains("the prediction is uncertain by"), "{report}");
}

#[test]
fn slow_doses_predict_small_pressures_and_keep_limits_close_to_rest() {
    let user = User::new();
    let slow = [
        "25mL",
        "--rate",
        "0.01mL/s",
        "--max-outlet-pressure",
        "88.8kPaa",
        "--min-inlet-pressure",
        "88.5kPaa",
    ];
    let report = user.json(&[&slow[..], &["--dry-run"]].concat());
    for (key, rest_kpa) in [("inlet_min_kpa", 88.637), ("inlet_max_kpa", 88.637), ("outlet_max_kpa", 88.637)]
    {
        assert!((number(&report, key) - rest_kpa).abs() < 0.02, "{key} in {report}");
    }
}

#[test]
fn the_simulated_vessel_receives_everything_at_any_rate() {
    for rate in ["0.02mL/s", "0.3mL/s", "60mL/s"] {
        let report = User::new().json(&["2mL", "--rate", rate]);
        let missing = number(&report, "planned_ml") - number(&report, "delivered_ml");
        assert!(missing.abs() < 2e-6, "{rate}: {missing} mL missing");
    }
}

#[test]
fn a_small_dose_says_what_a_step_makes_of_it() {
    let user = User::new();
    let report = user.json(&["1.2uL"]);
    assert!(report["warnings"].to_string().contains("a motor step is coarse for this dose"), "{report}");
    let message = user.is_refused(&["1.5uL"]);
    assert!(
        message.contains("1.500 µL with -") && message.contains("the smallest dose here is 1."),
        "{message}"
    );
}

#[test]
fn pressures_that_no_liquid_can_have_are_said_to_be_so() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let long = three.replace("resistance_kpa_s_ml = 0.1108", "resistance_kpa_s_ml = 10.0");
    fs::write(user.path("firm.toml"), &long).unwrap();
    let refused = user.is_refused(&["25mL", "--pump", "firm.toml", "--rate", "20mL/s"]);
    assert!(refused.contains("at which the tube would collapse"), "{refused}");
    // A pump of which the collapse of the tube and the vapour pressure are not known.
    let unknown =
        long.replace("modulus_mpa = 3.5\npoisson_ratio = 0.49\n", "").replace("\"water\"", "\"oil\"");
    fs::write(user.path("long.toml"), unknown).unwrap();
    let dose = user.json(&["25mL", "--pump", "long.toml", "--rate", "20mL/s", "--dry-run"]);
    assert!(dose["warnings"][0].as_str().unwrap().contains("no liquid can"), "{dose}");
    let run = ["simulate", "--pump", "long.toml", "--speed", "200rpm", "--duration", "1s"];
    let run = user.json(&run);
    assert!(run["warnings"][0].as_str().unwrap().contains("above the pump's limit of 170 r/min"), "{run}");
    assert!(run["warnings"][1].as_str().unwrap().contains("no liquid can"), "{run}");
}

#[test]
fn the_short_text_of_a_dose_has_the_time_that_the_log_has_and_that_of_a_dry_run_has_none() {
    let user = User::new();
    let text = user.types(&["2mL"]).out;
    let log = user.types(&["log", "--format", "json"]).out;
    let logged: serde_json::Value = serde_json::from_str(log.lines().next().unwrap()).unwrap();
    let began = format!("; began {}", logged["time"].as_str().unwrap());
    assert!(text.lines().nth(2).unwrap().ends_with(&began), "{text}{log}");
    assert!(!user.types(&["2mL", "--dry-run"]).out.contains("began"));
}
