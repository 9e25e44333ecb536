//! Racks that the service runs.

use std::fs;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, wait_for};

/// A pump that begins at once, and another one that waits before its second step.
const RACK: &str = r#"schema = "rack/1"
[pumps]
acid = "acid"
base = "base"
[[step]]
ratio = { acid = 2, base = 1 }
volume = "6mL"
rate = "3mL/s"
[[step]]
at = "60s"
pump = "base"
volume = "4mL"
"#;

#[test]
fn a_rack_tells_its_plan_at_its_begin_and_each_pump_its_own() {
    let laboratory = Laboratory::new(&["acid", "base", "dye"], "[racks]\nmix = \"mix.toml\"\n");
    fs::write(laboratory.path("mix.toml"), RACK).unwrap();
    let service = laboratory.serve(&[]);
    let (status, order) = service.post("/api/v1/racks/mix/run", &json!({}));
    assert_eq!(status, 202, "{order}");
    let id = order["id"].as_str().unwrap();
    let plan = wait_for("the plan of the rack", || {
        let order = service.get(&format!("/api/v1/orders/{id}")).1;
        order["reports"].as_array().unwrap().first().cloned()
    });
    assert_eq!((&plan["schema"], &plan["end"]), (&json!("rack/1"), &json!("planned")), "{plan}");
    assert!(plan["planned_s"].as_f64().unwrap() > 60.0, "{plan}");
    let asked: Vec<&Value> =
        plan["pumps"].as_array().unwrap().iter().map(|row| &row["requested_ml"]).collect();
    assert_eq!(asked, [&json!(4.0), &json!(6.0)]);
    let view = |pump: &str| service.get(&format!("/api/v1/pumps/{pump}")).1;
    // Each pump's own plan comes after that of the rack.
    service.moves("acid");
    assert_eq!(view("acid")["order"], id);
    assert_eq!(view("dye")["order"], Value::Null, "the rack has not this pump");
    assert_eq!(view("acid")["plan"]["requested_ml"], 4.0);
    // After its first step the pump has the plan of its second one, and waits for it.
    let waiting = wait_for("the pump to wait", || {
        Some(view("base")).filter(|view| view["progress"]["state"] == "waiting")
    });
    assert_eq!(waiting["plan"]["requested_ml"], 4.0, "{waiting}");
    let progress = &waiting["progress"];
    assert_eq!((&progress["number"], &progress["count"]), (&json!(2), &json!(2)), "{progress}");
    assert!((50.0..60.0).contains(&progress["next_s"].as_f64().unwrap()), "{progress}");
    service.post("/api/v1/pumps/base/stop", &json!({}));
    let order = service.ended(id);
    let reports = order["reports"].as_array().unwrap();
    assert_eq!((reports.len(), &reports[0]["end"]), (1, &json!("stopped")), "{order}");
}
