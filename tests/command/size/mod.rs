//! `dose size`.

use crate::user::{User, number};

/// The duty of the documentation.
const DUTY: [&str; 15] = [
    "size",
    "--flow",
    "2L/h",
    "--fluid",
    "glycerol 50%",
    "--temperature",
    "20degC",
    "--inlet-hose",
    "6x10mm,1m",
    "--outlet-hose",
    "6x10mm,3m",
    "--suction-lift",
    "1.2m",
    "--discharge-lift",
    "0.5m",
];

#[test]
fn a_duty_gets_a_head_with_speed_pressures_margin_and_a_picture() {
    let user = User::new();
    let answer = user.types(&[&DUTY[..], &["--plot", "curve.svg"]].concat());
    assert_eq!(answer.code, 0, "{}", answer.err);
    for said in
        ["r/min", "laminar (Hagen-Poiseuille)", "NPSH available", "Raoult", "at the hose's end", "not known"]
    {
        assert!(answer.out.contains(said), "{said}: {}", answer.out);
    }
    let svg = std::fs::read_to_string(user.path("curve.svg")).unwrap();
    assert!(svg.contains("operating point") && svg.contains("outlet, kPa absolute"));

    let report = user.json(&DUTY);
    assert_eq!(report["schema"], "size/1");
    // 2000 mL in 3600 s; the mean inlet pressure by hydrostatics: 101.325 - 1.1263 x 9.80665 x 1.2 - 0.105 kPa.
    assert!((number(&report, "flow_ml_s") - 0.555_556).abs() < 1e-6);
    let turned = number(&report, "speed_rpm") * number(&report, "ml_per_rev") / 60.0;
    assert!((turned - 0.555_556).abs() < 1e-6);
    assert!((number(&report["steady"], "inlet_mean_kpa") - 87.966).abs() < 0.02, "{}", report["steady"]);
    assert_eq!(
        (&report["inlet"]["law"], report["suction"]["collapse_kpa"].is_null()),
        (&"laminar".into(), true)
    );
    assert!(report["curve"].as_array().unwrap().len() >= 48);
    assert!(number(&report, "speed_rpm") < number(&report, "most_rpm"));
}

#[test]
fn a_head_or_a_pump_that_is_named_is_sized() {
    let user = User::new();
    let hoses = ["--inlet-hose", "6x10mm,1m", "--outlet-hose", "6x10mm,1m"];
    let named = |more: &[&str]| user.json(&[&["size", "--flow", "2L/h"], &hoses[..], more].concat());
    let bought = named(&["--head", "masterflex-ls-16", "--rollers", "3"]);
    // 33.333 mL/min of 0.8 mL a revolution; no document states its largest speed.
    assert!((number(&bought, "speed_rpm") - 41.6667).abs() < 1e-3 && bought["most_rpm"].is_null());
    assert!(!bought["warnings"].as_array().unwrap().is_empty(), "the line swings with the pulses");
    let own = named(&["--pump", "three-roller", "--altitude", "500m"]);
    // ISO 2533: 95.461 kPa at 500 m.
    assert!((number(&own, "ambient_kpa") - 95.461).abs() < 1e-3 && own["source"].is_null());
    assert!((number(&own["suction"], "collapse_kpa") - (95.461 - 42.65)).abs() < 0.05);
}

#[test]
fn a_duty_that_nothing_serves_is_refused_with_the_figure_and_what_would_do() {
    let user = User::new();
    let refused = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        user.is_refused(&[&["size"], &words[..]].concat())
    };
    let hoses = "--inlet-hose 6x10mm,1m --outlet-hose 6x10mm,1m";
    let high = refused(&format!("--flow 2L/h {hoses} --suction-lift 11m"));
    assert!(high.contains("the suction margin is -") && !high.contains("10 m at most"), "{high}");
    // Nobody knows when the tube collapses: what would do is not warned of.
    let lift =
        high.split("a suction lift of ").nth(1).and_then(|rest| rest.split(" m at most").next()).unwrap();
    let served = |lift_m: f64| {
        let lift = format!("{lift_m}m");
        let words = ["size", "--flow", "2L/h", "--inlet-hose", "6x10mm,1m", "--outlet-hose", "6x10mm,1m"];
        user.types(&[&words[..], &["--suction-lift", &lift]].concat())
    };
    let lift_m: f64 = lift.parse().unwrap();
    let at_most = served(lift_m);
    assert!(at_most.code == 0 && !at_most.out.contains("the pump sucks with"), "{}", at_most.out);
    assert!(served(lift_m + 0.2).out.contains("the pump sucks with"), "{lift_m}");
    let thin = refused("--flow 2L/h --inlet-hose 0.5x3mm,2m --outlet-hose 6x10mm,1m");
    assert!(thin.contains("try a hose of 1.5 mm bore at least"), "{thin}");
    let fast = refused(&format!("--flow 20L/min {hoses}"));
    assert!(fast.contains("1627 mL/min (runze-yz1515x-3-18)") && fast.contains("`dose pumps list"), "{fast}");
    assert!(refused("--flow 2L/h").contains("give --inlet-hose 6x10mm,1m"));
    assert!(refused("--flow 2L/h --inlet-hose 6x10mm").contains("`6x10mm` is no hose"));
    assert!(refused("--flow 2L/h --inlet-hose 6mm,1m").contains("`6mm` is not a tube"));
    assert!(refused(&format!("--flow 2L/h {hoses} --altitude 60000m")).contains("-500 to 9000 m"));
    assert!(refused(&format!("--flow 2L/h {hoses} --head masterflex-ls-61")).contains("masterflex-ls-16"));
    assert!(refused(&format!("--flow 2L/h {hoses} --head masterflex-ls-16")).contains("add --rollers 3"));
    assert!(refused("--flow 5L/min --pump three-roller").contains("0 to 170 r/min"));
    let push = refused(&format!("--flow 2L/h {hoses} --discharge-lift 20m --max-outlet-pressure 150kPag"));
    // 20 m of water at 25 °C are 195.5 kPa.
    assert!(push.contains("a discharge lift of 15.") && push.contains("195.5"), "{push}");
}
