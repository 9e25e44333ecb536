//! `dose simulate`.

use crate::user::{User, number, rows};

#[test]
fn simulate_reports_the_steady_state_and_samples_both_ends() {
    let user = User::new();
    let report = user.json(&["simulate", "--speed", "100rpm", "--duration", "10s", "--trace", "run.csv"]);
    assert_eq!(report["schema"], "simulation/1");
    assert!((number(&report["steady"], "outlet_max_kpa") - 104.5105).abs() < 2e-3);
    assert!((number(&report["steady"], "inlet_mean_kpa") - 84.7002).abs() < 2e-3);
    assert!((number(&report["steady"], "mean_flow_ml_s") - 35.5308).abs() < 1e-3);
    let (_, trace) = rows(&user.path("run.csv"));
    assert_eq!(trace.len(), 10_001);
    assert_eq!(trace.last().unwrap()[0], 10.0);
    let lowest = trace.iter().map(|row| row[5]).fold(f64::INFINITY, f64::min);
    assert!((lowest - 71.725).abs() < 0.02, "start-up reaches {lowest}");
}

#[test]
fn all_methods_of_simulate_agree() {
    let user = User::new();
    let run = |method: &str, file: &str| {
        let arguments =
            ["simulate", "--speed", "100rpm", "--duration", "2s", "--method", method, "--trace", file];
        assert_eq!(user.json(&arguments)["method"], method);
        rows(&user.path(file)).1
    };
    let exact = run("exact", "a.csv");
    assert_eq!(exact.len(), 2001);
    for method in ["rodas5p", "radau"] {
        for (a, b) in exact.iter().zip(run(method, "b.csv")) {
            for (column, bound) in [(0, 0.0), (1, 0.0), (3, 0.0), (4, 0.0), (5, 1e-4), (6, 1e-4), (7, 1e-5)] {
                assert!((a[column] - b[column]).abs() <= bound, "{method}, column {column}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn the_roller_centric_model_is_said_to_be_experimental_and_settles_to_its_steady_state() {
    let user = User::new();
    let arguments = ["simulate", "--speed", "100rpm", "--duration", "5s", "--model", "roller-centric"];
    let report = user.json(
        &[&arguments[..], &["--method", "rodas5p", "--trace", "run.csv", "--plot", "run.svg"]].concat(),
    );
    assert_eq!((&report["model"], &report["method"]), (&"roller-centric".into(), &"rodas5p".into()));
    assert_eq!(report["roller_centric"]["experimental"], true);
    assert_eq!(number(&report["roller_centric"], "ambient_kpa"), 85.7);
    assert!((number(&report["roller_centric"], "closure_deg") - 30.6926).abs() < 1e-4);
    let steady = &report["steady"];
    // 3.2 % more per revolution than the speed law's 21.0444 mL.
    assert!((number(steady, "mean_flow_ml_s") - 36.205).abs() < 1e-3);

    let (_, trace) = rows(&user.path("run.csv"));
    let last_turn = &trace[4400..];
    assert_eq!(last_turn.len(), 601);
    let range = |column: usize| {
        last_turn
            .iter()
            .map(|row| row[column])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    for (column, port) in [(5, "inlet"), (6, "outlet")] {
        let (low, high) = range(column);
        assert!((low - number(steady, &format!("{port}_min_kpa"))).abs() < 0.05, "{port}: {low}");
        assert!((high - number(steady, &format!("{port}_max_kpa"))).abs() < 0.05, "{port}: {high}");
    }
    let mean_ml_s = (last_turn[600][7] - last_turn[0][7]) / 0.6;
    assert!((mean_ml_s / number(steady, "mean_flow_ml_s") - 1.0).abs() < 1e-5, "{mean_ml_s}");
    let svg = std::fs::read_to_string(user.path("run.svg")).unwrap();
    assert!(svg.contains("three-roller at 100 r/min from rest, the last 6 pitches"), "{svg}");
    assert!(
        svg.contains("delivered, mL") && !svg.contains("speed, r/min"),
        "a constant speed needs no panel"
    );

    let text = user.types(&arguments).out;
    assert!(text.contains("roller-centric model, periodic steady state"), "{text}");
    assert!(text.contains("model   experimental: segments 0.953 of the round tube's volume"), "{text}");
    let exact = user.types(&[&arguments[..], &["--method", "exact"]].concat());
    assert_eq!(exact.code, 2);
    assert!(
        exact.err.contains("the roller-centric model is not linear and has no exact solution"),
        "{}",
        exact.err
    );
    let radau = user.types(&[&arguments[..], &["--method", "radau"]].concat());
    assert_eq!(radau.code, 2);
    let refusal =
        "the roller-centric model is not linear, as method radau needs it; allowed: method auto or rodas5p";
    assert!(radau.err.contains(refusal), "{}", radau.err);
}

#[test]
fn a_hose_resists_more_at_more_flow_and_has_no_exact_solution() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    // The paper's line as a hose, R 0.1108 at 210 mL/s.
    let hose = "[inlet.hose]\nbore_radius_mm = 5.0\nouter_radius_mm = 7.0\nlength_mm = 331.0\nmodulus_mpa = 3.5\n\
                poisson_ratio = 0.5\nminor_loss = 5.75\nresistance_at_ml_s = 210.0\n";
    let resistance =
        "resistance_kpa_s_ml = 0.1108\ncompliance_ml_kpa = 0.0361\ninertance_kpa_s2_ml = 0.0042\n";
    let by_hose = three.replacen(resistance, "", 1).replace("[outlet]", &format!("{hose}\n[outlet]"));
    std::fs::write(user.path("my.toml"), by_hose).unwrap();
    for model in ["flow-centric", "roller-centric"] {
        let run = |rpm: &str| {
            let arguments =
                ["simulate", "--pump", "my.toml", "--speed", rpm, "--duration", "1s", "--model", model];
            let report = user.json(&arguments);
            assert_eq!(report["friction"], serde_json::json!(["inlet"]));
            assert_eq!(report["method"], "rodas5p");
            let (line, steady) = (88.637, &report["steady"]);
            let flow_ml_s = number(steady, "mean_flow_ml_s");
            [
                (line - number(steady, "inlet_mean_kpa")) / flow_ml_s,
                (number(steady, "outlet_mean_kpa") - line) / flow_ml_s,
            ]
        };
        let ([slow, outlet], [fast, outlet_too]) = (run("20rpm"), run("160rpm"));
        assert!(
            (outlet - 0.1108).abs() < 1e-5 && (outlet_too - 0.1108).abs() < 1e-5,
            "{outlet} {outlet_too}"
        );
        assert!(slow < 0.02 && fast > 2.5 * slow && fast < 0.06, "{model}: {slow}, {fast} kPa s/mL");
    }
    let arguments = ["simulate", "--pump", "my.toml", "--speed", "60rpm", "--duration", "1s"];
    let text = user.types(&arguments).out;
    assert!(text.contains("friction of the hose at every flow (inlet), integrated"), "{text}");
    let exact = user.types(&[&arguments[..], &["--method", "exact"]].concat());
    assert_eq!(exact.code, 2);
    assert!(exact.err.contains("the friction of a hose grows with the flow"), "{}", exact.err);
    let radau = user.types(&[&arguments[..], &["--method", "radau"]].concat());
    assert_eq!(radau.code, 2);
    assert!(radau.err.contains("method radau needs lines with a constant R"), "{}", radau.err);
}

#[test]
fn a_pressure_below_that_at_which_the_tube_collapses_is_warned_of() {
    let user = User::new();
    let warnings =
        |speed| user.json(&["simulate", "--speed", speed, "--duration", "1s"])["warnings"].to_string();
    // The thin ring of 3.5 MPa, 0.49, 2 mm on 6 mm collapses at 42.65 kPa below 85.7 kPa.
    let fast = warnings("250rpm");
    assert!(
        fast.contains("the inlet pressure falls to 30.56")
            && fast.contains("below the limit of 43.05 kPa, at which"),
        "{fast}"
    );
    assert!(!fast.contains("the outlet pressure falls"), "{fast}");
    assert_eq!(warnings("100rpm"), "[]");
}

#[test]
fn a_start_up_below_the_pressure_at_which_the_tube_collapses_is_warned_of() {
    let user = User::new();
    let report = user.json(&["simulate", "--speed", "165rpm", "--duration", "2s"]);
    // The periodic state keeps above the limit, which it breaks from 222 r/min on. The start-up reaches further.
    assert!(number(&report["steady"], "inlet_min_kpa") > 43.05, "{report}");
    let report = user.json(&["simulate", "--speed", "219rpm", "--duration", "2s"]);
    let (least, limit) = (number(&report, "run_inlet_min_kpa"), number(&report, "inlet_limit_kpa"));
    assert!(number(&report["steady"], "inlet_min_kpa") > limit && least < limit, "{report}");
    assert!((limit - 43.05).abs() < 0.01 && report["inlet_limit"] == "tube_collapse", "{report}");
    assert!(report["warnings"].to_string().contains("at start-up, below the limit of 43.05 kPa"), "{report}");
    // At 100 r/min from rest the inlet falls to 71.725 kPa, computed independently.
    let report = user.json(&["simulate", "--speed", "100rpm", "--duration", "2s"]);
    assert!((number(&report, "run_inlet_min_kpa") - 71.725).abs() < 1e-3, "{report}");
}

#[test]
fn the_fastest_run_holds_every_limit_and_says_what_binds() {
    let user = User::new();
    let report = user.json(&["simulate", "--rate", "max", "--duration", "2s"]);
    // The paper's flow tests of three rollers end at 170 r/min.
    assert_eq!(report["limited_by"], "speed");
    assert!((number(&report, "speed_rpm") - 170.0).abs() < 1e-9);
    assert_eq!(report["warnings"].as_array().unwrap().len(), 0, "{}", report["warnings"]);
    let two =
        user.json(&["simulate", "--rate", "max", "--duration", "2s", "--pump", "two-roller", "--reverse"]);
    assert_eq!(
        (&two["limited_by"], two["warnings"].as_array().unwrap().len()),
        (&"outlet_suction".into(), 0)
    );
    // In reverse the outlet sucks: start-up just reaches the collapse at 43.05 kPa.
    assert!((number(&two, "run_outlet_min_kpa") - 43.05).abs() < 0.01, "{two}");
    let hot = user.is_refused(&["simulate", "--rate", "max", "--duration", "2s", "--temperature", "97degC"]);
    assert!(hot.contains("no speed holds every limit") && hot.contains("inlet_suction"), "{hot}");
    let roller = ["simulate", "--rate", "max", "--duration", "2s", "--model", "roller-centric"];
    assert!(user.is_refused(&roller).contains("give --speed"));
}

#[test]
fn a_fluid_that_a_fixed_resistance_does_not_follow_is_warned_of() {
    let user = User::new();
    let thick = ["--fluid", "glycerol 50%", "--temperature", "20degC"];
    let run = ["simulate", "--rate", "5mL/s", "--duration", "1s"];
    let report = user.json(&[&run[..], &thick].concat());
    assert_eq!((&report["fluid"], number(&report, "fluid_temperature_degc")), (&"glycerol 50%".into(), 20.0));
    for words in [&run[..], &["5mL", "--dry-run"], &["prime", "5mL", "--dry-run"]] {
        let warned = user.json(&[words, &thick].concat())["warnings"].to_string();
        assert!(
            warned.contains("stay those of water at 25 °C") && warned.contains("[outlet.hose]"),
            "{warned}"
        );
        let plain = user.json(words)["warnings"].to_string();
        assert!(!plain.contains("stay those of"), "{plain}");
    }
    // A drawing's lines are hoses, whose resistance follows: 6.00 for 1.0016 mPa s (Segur and Oberstar; IAPWS).
    let new = user.types(&[&crate::pumps::DRAWING[..], &["own.toml"]].concat());
    assert_eq!(new.code, 0, "{}", new.err);
    let text = std::fs::read_to_string(user.path("own.toml")).unwrap();
    std::fs::write(user.path("own.toml"), text.replace("minor_loss = 5.75", "minor_loss = 0.0")).unwrap();
    let drop_kpa = |fluid: &str| {
        let words = [
            "simulate",
            "--rate",
            "1mL/s",
            "--duration",
            "1s",
            "--pump",
            "own.toml",
            "--temperature",
            "20degC",
        ];
        let report = user.json(&[&words[..], &["--fluid", fluid]].concat());
        assert!(!report["warnings"].to_string().contains("stay those of"), "{report}");
        number(&report["steady"], "outlet_mean_kpa") - 101.325
    };
    let ratio = drop_kpa("glycerol 50%") / drop_kpa("water");
    assert!((ratio / (6.00 / 1.0016) - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_simulation_says_its_fluid_and_that_it_leaves_a_calibration_out() {
    let user = User::new();
    let run = ["simulate", "--rate", "5mL/s", "--duration", "2s"];
    let before = user.types(&run);
    assert!(before.out.contains("fluid   water at 25 °C"), "{}", before.out);
    assert!(!before.out.contains("calibration"), "{}", before.out);
    user.json(&["213mL"]);
    user.json(&["calibrate", "last", "217.26g"]);
    let after = user.types(&run);
    assert!(after.out.contains("doses take calibration 1 (sim)"), "{}", after.out);
    assert_eq!(before.out.lines().next(), after.out.lines().next());
}

#[test]
fn a_fluid_that_the_air_does_not_lift_so_high_is_refused_by_the_lift() {
    let user = User::new();
    let own = include_str!("../../examples/pumps/my-pump.toml");
    std::fs::write(user.path("deep.toml"), own.replacen("lift_mm = 0.0", "lift_mm = 9800.0", 1)).unwrap();
    let run = ["simulate", "--pump", "deep.toml", "--rate", "1mL/s", "--duration", "2s"];
    let refused = user.is_refused(&[&run[..], &["--fluid", "glycerol 50%"]].concat());
    assert!(refused.contains("[inlet] lift_mm is 9800; allowed: more than"), "{refused}");
}
