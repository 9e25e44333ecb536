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
fn both_methods_of_simulate_agree() {
    let user = User::new();
    let run = |method: &str, file: &str| {
        let arguments =
            ["simulate", "--speed", "100rpm", "--duration", "2s", "--method", method, "--trace", file];
        assert_eq!(user.json(&arguments)["method"], method);
        rows(&user.path(file)).1
    };
    let (exact, integrated) = (run("exact", "a.csv"), run("rodas5p", "b.csv"));
    assert_eq!(exact.len(), 2001);
    for (a, b) in exact.iter().zip(&integrated) {
        for (column, bound) in [(0, 0.0), (1, 0.0), (3, 0.0), (4, 0.0), (5, 1e-4), (6, 1e-4), (7, 1e-5)] {
            assert!((a[column] - b[column]).abs() <= bound, "column {column} at {} s: {a:?} {b:?}", a[0]);
        }
    }
}
