//! Lines and roller volumes from tables of measurements.

use std::fs;

use pump_model::volume_fit::PUBLISHED_POINTS;
use serde_json::Value;

use crate::pumps::DRAWING;
use crate::user::{User, number};

/// The examples, made with R 0.15, C 0.03 and L 0.0055 by the project's own simulation, with noise.
fn user_with_examples() -> User {
    let user = User::new();
    for (name, text) in [
        ("resistance.csv", include_str!("../../examples/identification/resistance.csv")),
        ("compliance.csv", include_str!("../../examples/identification/compliance.csv")),
        ("start.csv", include_str!("../../examples/identification/start.csv")),
    ] {
        fs::write(user.path(name), text).unwrap();
    }
    user
}

fn is_found(report: &Value, key: &str, truth: f64, part: f64) {
    let found = &report["parameters"][key];
    let (value, standard) = (number(found, "value"), number(found, "standard"));
    assert!((value - truth).abs() < 2.0 * standard, "{key}: {found} for {truth}");
    assert!(standard > 0.0 && standard < part * truth, "{key}: {found}");
}

#[test]
fn the_examples_give_the_line_that_they_were_made_with() {
    let user = user_with_examples();
    let resistance = user.json(&["identify", "resistance", "--data", "resistance.csv"]);
    assert_eq!(
        (&resistance["schema"], &resistance["kind"]),
        (&"identification/1".into(), &"resistance".into())
    );
    is_found(&resistance, "resistance_kpa_s_ml", 0.15, 0.01);
    let compliance =
        user.json(&["identify", "compliance", "--data", "compliance.csv", "--total-volume", "26mL"]);
    is_found(&compliance, "compliance_ml_kpa", 0.03, 0.01);
    is_found(&compliance, "bulk_modulus_kpa", 26.0 / 0.03, 0.01);
    let line = user.json(&["identify", "line", "--data", "start.csv", "--speed", "100rpm"]);
    is_found(&line, "resistance_kpa_s_ml", 0.15, 0.01);
    is_found(&line, "compliance_ml_kpa", 0.03, 0.01);
    is_found(&line, "inertance_kpa_s2_ml", 0.0055, 0.01);
    is_found(&line, "start_angle_deg", 17.0, 0.01);
    assert!((number(&line, "rmse_kpa") / 0.3 - 1.0).abs() < 0.15 && number(&line, "pearson") > 0.99);
    assert_eq!(line["parameters"]["reservoir_kpa"]["held"], true);
}

#[test]
fn a_long_recording_is_thinned_and_the_result_says_so() {
    let user = User::new();
    let made = user.types(&[
        "simulate",
        "--speed",
        "100rpm",
        "--duration",
        "10s",
        "--dt",
        "0.1ms",
        "--trace",
        "long.csv",
    ]);
    assert_eq!(made.code, 0, "{}", made.err);
    let identify = ["identify", "line", "--data", "out.csv", "--speed", "100rpm", "--begin", "step"];
    let long = fs::read_to_string(user.path("long.csv")).unwrap();
    let rows = long.lines().map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{}\n", cells[0], cells[6])
    });
    fs::write(user.path("out.csv"), rows.collect::<String>()).unwrap();
    // Some three times what a machine of its own takes.
    let found = user.json_within_cpu_s(10, &identify);
    assert_eq!((number(&found, "rows"), number(&found, "points")), (100_001.0, 14_286.0));
    assert!((number(&found["parameters"]["resistance_kpa_s_ml"], "value") - 0.1108).abs() < 1e-3, "{found}");
    let said = user.types(&identify).out;
    assert!(said.contains("1 in 7 of 100001 samples worth"), "{said}");
}

#[test]
fn what_is_printed_for_the_pump_file_is_read_by_it() {
    let user = user_with_examples();
    let line = user.json(&["identify", "line", "--data", "start.csv", "--speed", "100rpm"]);
    let table = line["pump_file"].as_str().unwrap();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let (start, end) = (three.find("[outlet]").unwrap(), three.find("[motor]").unwrap());
    fs::write(user.path("mine.toml"), format!("{}{table}\n{}", &three[..start], &three[end..])).unwrap();
    let check = user.types(&["pumps", "check", "mine.toml"]);
    assert!(check.out.contains("outlet    R 0.1498 kPa s/mL, C 0.0301 mL/kPa, L 0.00550"), "{}", check.out);
    // From there the fit stays where it is.
    let again =
        user.json(&["identify", "line", "--data", "start.csv", "--speed", "100rpm", "--pump", "mine.toml"]);
    let value = |report: &Value| number(&report["parameters"]["inertance_kpa_s2_ml"], "value");
    assert!((value(&again) / value(&line) - 1.0).abs() < 1e-6);
}

#[test]
fn the_table_for_the_pump_file_keeps_the_nozzle_of_the_outlet() {
    let user = user_with_examples();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let nozzle = "end = \"immersed\"\nnozzle_bore_mm = 1.5\n";
    fs::write(user.path("mine.toml"), three.replace("[outlet]\n", &format!("[outlet]\n{nozzle}"))).unwrap();
    let words = ["identify", "line", "--data", "start.csv", "--speed", "100rpm", "--pump", "mine.toml"];
    let line = user.json(&words);
    let table = line["pump_file"].as_str().unwrap();
    assert!(table.starts_with("[outlet]\n") && table.ends_with(nozzle), "{table}");
    assert!(user.types(&words).out.ends_with(nozzle));
    // A nozzle that the pump file does not name is not named.
    let line = user.json(&["identify", "line", "--data", "start.csv", "--speed", "100rpm"]);
    let table = line["pump_file"].as_str().unwrap();
    assert!(!table.contains("nozzle_bore_mm") && !table.contains("end ="), "{table}");
}

#[test]
fn a_trace_of_the_model_gives_both_lines_back() {
    let user = User::new();
    let simulate = ["simulate", "--speed", "100rpm", "--duration", "1s", "--dt", "2ms", "--trace", "t.csv"];
    assert_eq!(user.types(&simulate).code, 0);
    let answer = user.types(&[
        "identify",
        "line",
        "--data",
        "t.csv",
        "--speed",
        "100rpm",
        "--begin",
        "step",
        "--start-angle",
        "0deg",
        "--also",
        "reservoir",
        "--format",
        "json",
    ]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let reports: Vec<Value> = answer.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(reports.iter().map(|report| &report["line"]).collect::<Vec<_>>(), ["inlet", "outlet"]);
    for report in &reports {
        for (key, truth) in [
            ("resistance_kpa_s_ml", 0.1108),
            ("compliance_ml_kpa", 0.0361),
            ("inertance_kpa_s2_ml", 0.0042),
            ("reservoir_kpa", 88.637),
        ] {
            let value = number(&report["parameters"][key], "value");
            assert!((value / truth - 1.0).abs() < 1e-7, "{key}: {value}");
        }
    }
}

#[test]
fn fits_are_drawn_and_said_in_words() {
    let user = user_with_examples();
    for (words, text) in [
        (&["resistance", "--data", "resistance.csv"][..], "pressure drop, kPa"),
        (&["compliance", "--data", "compliance.csv"], "injected, mL"),
        (&["line", "--data", "start.csv", "--speed", "100rpm"], "pressure, kPa absolute"),
    ] {
        let answer = user.types(&[&["identify"], words, &["--plot", "fit.svg"]].concat());
        assert_eq!(answer.code, 0, "{}", answer.err);
        for part in ["± is k = 2", "RMSE", "NRMSE", "Pearson", "for the pump file, in place of its [outlet]:"]
        {
            assert!(answer.out.contains(part), "{part}: {}", answer.out);
        }
        let svg = fs::read_to_string(user.path("fit.svg")).unwrap();
        for part in [text, "measured", "fitted", "measured less fitted, kPa"] {
            assert!(svg.contains(part), "{part}");
        }
    }
    let bent: String = (1..9).map(|n| format!("{},{}\n", 5 * n, 0.1 * f64::from(n * n))).collect();
    fs::write(user.path("bent.csv"), format!("flow_ml_s,drop_kpa\n{bent}")).unwrap();
    let answer = user.types(&["identify", "resistance", "--data", "bent.csv"]);
    assert!(answer.out.contains("warning      the resistance changes with the flow"), "{}", answer.out);
}

/// A record of the outlet's pressure every 2 ms.
fn record(user: &User, name: &str, kpa: impl Fn(u32) -> f64) {
    let rows: String = (0..300).map(|n| format!("{:.3},{:.3}\n", f64::from(n) * 2e-3, kpa(n))).collect();
    fs::write(user.path(name), format!("time_s,p_out_kpa\n{rows}")).unwrap();
}

/// Noise that is the same in every run: the fractional parts of multiples of the golden section, scrambled.
fn noise(n: u32) -> f64 {
    let scrambled = n.wrapping_mul(2_654_435_769) ^ (n.wrapping_mul(2_654_435_769) >> 15);
    f64::from(scrambled.wrapping_mul(2_246_822_519)) / f64::from(u32::MAX) - 0.5
}

#[test]
fn a_record_that_the_pump_does_not_explain_is_refused_whatever_is_sought() {
    let user = user_with_examples();
    record(&user, "flat.csv", |_| 150.0);
    record(&user, "noisy.csv", |n| 150.0 + noise(n));
    record(&user, "loud.csv", |n| 92.0 + 20.0 * noise(n));
    for file in ["flat.csv", "noisy.csv", "loud.csv"] {
        for more in [
            &[][..],
            &["--also", "reservoir"],
            &["--hold", "compliance,inertance", "--also", "reservoir"],
            &["--begin", "steady"],
        ] {
            let words = [&["identify", "line", "--data", file, "--speed", "100rpm"][..], more].concat();
            let message = user.is_refused(&words);
            assert!(
                message.contains("% of how the samples of pressure vary (a constant pressure explains 0)")
                    && message.contains("check speed"),
                "{words:?}: {message}"
            );
        }
    }
    // The mean alone tells R where the rest is known, however little of the pulses is seen.
    let words = ["identify", "line", "--data", "loud.csv", "--speed", "100rpm", "--begin", "steady"];
    let hold = ["--hold", "compliance,inertance", "--start-angle", "0deg"];
    let report = user.json(&[&words[..], &hold].concat());
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("explains less than half of what was measured"), "{warnings}");
}

#[test]
fn a_fit_to_the_wrong_speed_is_warned_of_and_one_to_the_right_speed_is_not() {
    let user = user_with_examples();
    let at = |speed| ["identify", "line", "--data", "start.csv", "--speed", speed];
    assert_eq!(user.json(&at("100rpm"))["warnings"], serde_json::json!([]));
    let near = user.json(&at("97rpm"));
    assert!(number(&near, "pearson") > 0.9, "so near that the correlation does not show it");
    let told = near["warnings"].to_string();
    assert!(told.contains("stays alike for") && told.contains("the model misses something"), "{told}");
    let far = user.json(&at("90rpm"))["warnings"].to_string();
    assert!(far.contains("stays alike for") && far.contains("Pearson 0.63"), "{far}");
    let text = user.types(&at("90rpm")).out;
    assert_eq!(text.matches("  warning      ").count(), 2, "{text}");
}

#[test]
fn points_that_a_line_does_not_explain_are_warned_of_or_refused() {
    let user = User::new();
    let write = |name: &str, header: &str, of: &dyn Fn(f64) -> f64, more: &str| {
        let rows: String =
            (1..9).map(|n| 5.0 * f64::from(n)).map(|x| format!("{x},{}{more}\n", of(x))).collect();
        fs::write(user.path(name), format!("{header}\n{rows}")).unwrap();
    };
    let ripple = |x: f64| 0.02 * noise(x as u32);
    let resistance = ["identify", "resistance", "--data", "r.csv"];
    for flat in [&(|_| 10.0) as &dyn Fn(f64) -> f64, &|x| 10.0 + ripple(x)] {
        write("r.csv", "flow_ml_s,drop_kpa", flat, "");
        let message = user.is_refused(&resistance);
        assert!(message.contains("the drop is as large at every flow"), "{message}");
    }
    write("r.csv", "flow_ml_s,drop_kpa", &|x| 0.15 * x + 1.0 + ripple(x), "");
    let beside = user.json(&resistance)["warnings"].to_string();
    assert!(beside.contains("do not lead through the origin") && beside.contains("--offset"), "{beside}");
    let offset = user.json(&[&resistance[..], &["--offset"]].concat());
    assert_eq!(offset["warnings"], serde_json::json!([]));
    write("r.csv", "flow_ml_s,drop_kpa,standard_kpa", &|x| 0.15 * x + 10.0 * ripple(x), ",0.01");
    let scattered = user.json(&resistance)["warnings"].to_string();
    assert!(scattered.contains("times as far from the line as their standard uncertainties"), "{scattered}");

    let compliance = ["identify", "compliance", "--data", "c.csv"];
    write("c.csv", "volume_ml,pressure_kpa", &|_| 150.0, "");
    assert!(user.is_refused(&compliance).contains("do not determine the compliance"));
    let rows: String = (0..60)
        .map(|n| format!("{},{}\n", f64::from(n) * 0.01, 90.0 + f64::from(n) * 0.02 + 1.5 * noise(n)))
        .collect();
    fs::write(user.path("c.csv"), format!("volume_ml,pressure_kpa\n{rows}")).unwrap();
    let weak = user.json(&compliance)["warnings"].to_string();
    assert!(weak.contains("explains less than half"), "{weak}");
}

#[test]
fn tables_and_options_that_mean_nothing_are_refused() {
    let user = user_with_examples();
    let line = ["identify", "line", "--data", "start.csv"];
    fs::write(user.path("bad.csv"), "time_s,p_out_kpa\n0,88\n0.1,oops\n").unwrap();
    fs::write(user.path("header.csv"), "time_s,p_out_kpa\n").unwrap();
    for (words, expected) in [
        (&line[..], "how fast did it turn? Add --speed 100rpm"),
        (
            &["identify", "line", "--data", "bad.csv", "--speed", "1rpm"],
            "bad.csv: line 3: p_out_kpa is `oops`",
        ),
        (
            &["identify", "line", "--data", "header.csv", "--speed", "1rpm"],
            "there are no rows under the header",
        ),
        (&["identify", "line", "--data", "none.csv", "--speed", "1rpm"], "cannot read none.csv"),
        (&["identify", "line", "--data", "start.csv", "--speed", "37rpm"], "start.csv: "),
        (&["identify", "resistance", "--data", "start.csv"], "line 3: unknown column `time_s`"),
        (
            &["identify", "resistance", "--data", "resistance.csv", "--speed", "1rpm"],
            "`dose identify resistance` takes no --speed",
        ),
        (&["identify", "compliance", "--data", "compliance.csv", "--total-volume", "26"], "no unit"),
        (&["identify", "compliance"], "--data"),
        (
            &["identify", "compliance", "--data", "compliance.csv", "--plot", "fit.png"],
            "fit.png: plots are SVG",
        ),
        (
            &[
                "identify",
                "line",
                "--data",
                "start.csv",
                "--speed",
                "1rpm",
                "--begin",
                "steady",
                "--start-time",
                "1s",
            ],
            "--start-time means nothing to a steady record",
        ),
        (&["pumps", "check", "start.csv", "--plot", "x.svg"], "`dose pumps check` takes no --plot"),
        (&[&DRAWING[..], &["--fit", "spline"]].concat(), "--roller-volume-points"),
        (&[&DRAWING[..], &["--roller-volume-points", "none.csv"]].concat(), "cannot read none.csv"),
        (
            &[&DRAWING[..], &["--roller-volume-points", "start.csv"]].concat(),
            "start.csv: line 3: unknown column",
        ),
    ] {
        let message = user.is_refused(words);
        assert!(message.contains(expected), "{words:?}: {message}");
    }
}

#[test]
fn measured_roller_volumes_become_a_pump_file_with_what_is_to_be_said_of_them() {
    let user = User::new();
    let runs: String = PUBLISHED_POINTS
        .iter()
        .flat_map(|(deg, ml)| [("a", deg, ml + 0.01), ("b", deg, ml - 0.01)])
        // The volume at first contact is 0 by definition.
        .map(|(run, deg, ml)| format!("{run},{deg},{}\n", if *deg == 0.0 { 0.0 } else { ml }))
        .collect();
    fs::write(user.path("runs.csv"), format!("run,angle_deg,volume_ml\n{runs}")).unwrap();
    let points = ["--roller-volume-points", "runs.csv"];
    let new = |more: &[&str]| user.types(&[&DRAWING[..], &points, more].concat());
    let answer = new(&["--plot", "points.svg", "mine.toml"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    for part in [
        "30 points of 2 runs; the quintic is",
        "mL RMS off",
        "mL per revolution",
        "the fit does not rise from 0.00°",
    ] {
        assert!(answer.out.contains(part), "{part}: {}", answer.out);
    }
    assert!(fs::read_to_string(user.path("points.svg")).unwrap().contains("angle since first contact"));
    let check = user.types(&["pumps", "check", "mine.toml"]).out;
    assert!(check.contains("2.1055 mL over 50.53°, from 30 measured points"), "{check}");
    assert!(check.contains("21.3185 mL per revolution"), "{check}");
    assert_eq!(user.json(&["25mL", "--pump", "mine.toml", "--dry-run"])["volume_basis"], "model");

    // Without a file name the report stands in the file; a slip of the pen is found.
    let slip = runs.replace("b,46.53,2.07", "b,46.53,2.00");
    assert_ne!(slip, runs);
    fs::write(user.path("runs.csv"), format!("run,angle_deg,volume_ml\n{slip}")).unwrap();
    let text = new(&["--fit", "spline"]).out;
    assert!(
        text.contains("# 30 points of 2 runs; the spline is") && text.contains("fit = \"spline\""),
        "{text}"
    );
    assert!(text.contains("# run b falls by 0.0143 mL from 42.87° to 46.53°"), "{text}");
    fs::write(user.path("few.csv"), "angle_deg,volume_ml\n0,0\n10,1\n").unwrap();
    let refused = user.is_refused(&[&DRAWING[..], &["--roller-volume-points", "few.csv"]].concat());
    assert!(refused.contains("few.csv: there are measured points at 2 different angles"), "{refused}");
}

#[test]
fn hundreds_of_points_become_a_pump_file_with_a_spline() {
    let user = User::new();
    // Two runs, each 0.01 mL beside a curve from 0 to 2.1 mL.
    let row = |run: &str, n: u32, off_ml: f64| {
        let deg = f64::from(n) * 0.25;
        let ml = 1.05 * (1.0 - (std::f64::consts::PI * deg / 50.0).cos());
        format!("{run},{deg},{}\n", ml + off_ml)
    };
    let rows: String = (0..=200).flat_map(|n| [row("a", n, 0.01), row("b", n, -0.01)]).collect();
    fs::write(user.path("runs.csv"), format!("run,angle_deg,volume_ml\n{rows}")).unwrap();
    let points = ["--roller-volume-points", "runs.csv", "--fit", "spline", "many.toml"];
    let answer = user.types(&[&DRAWING[..], &points].concat());
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("402 points of 2 runs; the spline is 0.0100 mL RMS off"), "{}", answer.out);
    let check = user.types(&["pumps", "check", "many.toml"]).out;
    let expected = "2.1000 mL over 50.00°, from 402 measured points, 0.0100 mL RMS off";
    assert!(check.contains(expected), "{check}");
    assert_eq!(user.json(&["25mL", "--pump", "many.toml", "--dry-run"])["volume_basis"], "model");
}

#[test]
fn points_that_agree_exactly_tell_no_error() {
    let user = User::new();
    let resistance = |rows: &str, more: &[&str]| {
        fs::write(user.path("r.csv"), format!("flow_ml_s,drop_kpa\n{rows}")).unwrap();
        let words = [&["identify", "resistance", "--data", "r.csv"], more].concat();
        (user.json(&words)["parameters"]["resistance_kpa_s_ml"].clone(), user.types(&words).out)
    };
    let (exact, text) = resistance("10,1.1\n20,2.2\n", &[]);
    assert!(exact["standard"].is_null() && (number(&exact, "value") - 0.11).abs() < 1e-12, "{exact}");
    assert!(text.contains("0.11 kPa s/mL, no error from 2 points that agree exactly"), "{text}");
    assert!(text.contains("resistance_kpa_s_ml = 0.11  # found\n") && !text.contains("0.000000"), "{text}");
    let (exact, _) = resistance("10,1.3\n20,2.4\n30,3.5\n", &["--offset"]);
    assert!(exact["standard"].is_null(), "{exact}");
    // Two points that differ from their line by what they were measured with tell how far.
    let (measured, text) = resistance("10,1.1\n20,2.3\n", &[]);
    assert!(number(&measured, "standard") > 0.01 && text.contains("0.114 ± 0.028"), "{text}");
}
