//! Services that are killed while three pumps move.

use std::env;
use std::thread::sleep;
use std::time::Duration;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, wait_for};

/// Kills of a service; `make faults` does 200.
fn runs() -> u32 {
    env::var("SERVE_KILLS").map_or(5, |runs| runs.parse().unwrap())
}

/// Volume of the doses, mL.
const EACH_ML: f64 = 3.0;

#[test]
fn a_killed_service_loses_nothing_and_doubles_nothing() {
    let pumps = ["acid", "base", "dye"];
    let laboratory = Laboratory::new(&pumps, "");
    let mut service = laboratory.serve(&[]);
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    for run in 0..runs() {
        let key = format!("dose {run}");
        let body = json!({"volume": "3mL", "options": {"rate": "2mL/s", "unfinished": "resume"}});
        let post = |service: &crate::laboratory::Service, pump: &str| {
            let key = format!("{key} {pump}");
            service.post_with(&format!("/api/v1/pumps/{pump}/dose"), &body, &[("idempotency-key", &key)])
        };
        let ids: Vec<Value> = pumps.iter().map(|pump| post(&service, pump).1["id"].clone()).collect();
        // xorshift: a kill at any instant of the dose of some 2 s.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        sleep(Duration::from_millis(state % 1800));
        service.kill();
        // The processes of the motions hear the service's end, decelerate and record.
        for pump in pumps {
            wait_for("the pump to stand", || laboratory.status(pump)["in_use_by"].is_null().then_some(()));
        }
        service = laboratory.serve_again(&service);
        for (pump, id) in pumps.iter().zip(&ids) {
            let (status, again) = post(&service, pump);
            assert_eq!((status, &again["id"]), (202, id), "a key of before doses once: {again}");
            assert!(["done", "cut-off"].contains(&again["state"].as_str().unwrap()), "{again}");
            if !laboratory.status(pump)["unfinished"].is_null() {
                let (status, rest) = service.post(&format!("/api/v1/pumps/{pump}/resume"), &json!({}));
                assert_eq!(status, 202, "{rest}");
                let rest = service.ended(rest["id"].as_str().unwrap());
                assert_eq!(rest["state"], "done", "{rest}");
            }
        }
    }
    for pump in pumps {
        let (status, log) = (laboratory.status(pump), laboratory.log(pump));
        let logged_ml: f64 = log.iter().map(|dose| dose["delivered_ml"].as_f64().unwrap()).sum();
        let pumped_ml = status["wear"]["volume_ml"].as_f64().unwrap();
        let carry_ml = status["carry_ml"].as_f64().unwrap();
        assert!((logged_ml - pumped_ml).abs() < 1e-6, "{pump}: log {logged_ml}, tube {pumped_ml}");
        let asked_ml = EACH_ML * f64::from(runs());
        assert!(
            (pumped_ml + carry_ml - asked_ml).abs() < 1e-6,
            "{pump}: {pumped_ml} + {carry_ml} of {asked_ml}"
        );
    }
}

#[test]
fn the_log_says_that_a_killed_service_ended_the_dose() {
    let laboratory = Laboratory::new(&["acid"], "");
    let mut service = laboratory.serve(&[]);
    let id = service.dose("acid", "20mL", &json!({"rate": "1mL/s"}));
    service.moves("acid");
    service.kill();
    wait_for("the pump to stand", || laboratory.status("acid")["in_use_by"].is_null().then_some(()));
    let logged = laboratory.log("acid").remove(0);
    assert_eq!((&logged["cause"], &logged["order"]), (&json!("the end of the service"), &json!(id)));
    service = laboratory.serve_again(&service);
    let (status, known) = service.get(&format!("/api/v1/doses/{id}"));
    assert_eq!(
        (status, &known["schema"], &known["state"]),
        (200, &json!("dose-bounds/1"), &json!("cut-off"))
    );
    assert_eq!(
        (&known["numbers"], &known["completed"]),
        (&json!([logged["number"]]), &json!(false)),
        "{known}"
    );
    for bound in ["delivered_least_ml", "delivered_most_ml"] {
        assert_eq!(known[bound], logged["delivered_ml"], "{known}");
    }
}

#[test]
fn an_ended_service_leaves_every_motor_standing_with_its_record_written() {
    let laboratory = Laboratory::new(&["acid", "base"], "");
    let mut service = laboratory.serve(&[]);
    for pump in ["acid", "base"] {
        service.dose(pump, "20mL", &json!({"rate": "1mL/s"}));
        service.moves(pump);
    }
    assert_eq!(service.end(), Some(0));
    for pump in ["acid", "base"] {
        let (status, log) = (laboratory.status(pump), laboratory.log(pump));
        assert!(status["in_use_by"].is_null() && !status["unfinished"].is_null(), "{status}");
        assert_eq!(log[0]["cause"], "the end of the service");
    }
    assert!(!laboratory.path("records/serve.json").exists());
    let again = laboratory.serve_again(&service);
    let (_, orders) = again.get("/api/v1/orders");
    assert!(orders.as_array().unwrap().iter().all(|order| order["state"] == "failed"), "{orders}");
}

#[test]
fn two_services_do_not_share_records() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let second = laboratory.run(&["serve", "--listen", "127.0.0.1:0"]);
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stderr).contains("another service has the pumps of"));
    assert!(service.process() > 0);
}
