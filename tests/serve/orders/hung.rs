//! A process of an order that hangs: it is seen, and a stop of it has an outcome.

use std::fs;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, signal, wait_for};

/// Returns the process of the service's only order: its child.
fn worker(service: &Service) -> u32 {
    let is_its = |stat: &String| {
        let after = stat.rsplit_once(") ").unwrap().1;
        after.split(' ').nth(1) == Some(&service.process().to_string())
    };
    let mut found = fs::read_dir("/proc").unwrap().filter_map(|entry| {
        let stat = fs::read_to_string(entry.ok()?.path().join("stat")).ok()?;
        is_its(&stat).then(|| stat.split(' ').next().unwrap().parse().unwrap())
    });
    found.next().expect("the service has a process that moves the pump")
}

fn view(service: &Service) -> Value {
    service.get("/api/v1/pumps/acid").1
}

/// Begins a dose, and has its process hang while the motor turns.
fn hang(service: &Service) -> (String, u32) {
    let id = service.dose("acid", "200mL", &json!({"rate": "0.5mL/s"}));
    service.moves("acid");
    let process = worker(service);
    signal(process, "STOP");
    (id, process)
}

fn noted(service: &Service, words: &str) {
    wait_for(words, || service.get("/api/v1/notes").1.to_string().contains(words).then_some(()));
}

#[test]
fn a_process_without_a_word_is_told_of_until_it_speaks_again() {
    let laboratory = Laboratory::new(&["acid"], "");
    laboratory.tell_failures();
    let service = laboratory.serve(&[]);
    let (id, process) = hang(&service);
    wait_for("the silence", || view(&service)["silent_since"].as_str().map(drop));
    noted(&service, &format!("the process of order {id} (dose) has not reported for 5 s"));
    let (_, metrics) = service.get("/metrics");
    assert!(metrics.as_str().unwrap().contains("dose_pump_silent{pump=\"acid\"} 1"), "{metrics}");
    wait_for("on_fail", || (laboratory.told() == ["acid 1 silent"]).then_some(()));
    signal(process, "CONT");
    wait_for("a word", || view(&service)["silent_since"].is_null().then_some(()));
    noted(&service, &format!("the process of order {id} (dose) speaks again, after"));
    let (_, stopped) = service.post("/api/v1/stop", &json!({}));
    assert_eq!(stopped["asked"], json!([id]), "{stopped}");
    assert_eq!(service.ended(&id)["code"], 143);
}

#[test]
fn a_slow_pump_is_not_taken_for_a_silent_one() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    service.dose("acid", "0.05mL", &json!({"within": "1h"}));
    wait_for("the motion", || (view(&service)["progress"]["state"] == "moving").then_some(()));
    std::thread::sleep(Duration::from_secs(7));
    assert!(!service.get("/api/v1/notes").1.to_string().contains("no word"), "{}", view(&service));
}

#[test]
fn a_stop_of_a_process_that_hangs_ends_it_and_says_so() {
    let laboratory = Laboratory::new(&["acid"], "");
    laboratory.tell_failures();
    let service = laboratory.serve(&[]);
    let (id, _) = hang(&service);
    let asked = Instant::now();
    let (status, answer) = service.post("/api/v1/stop", &json!({}));
    assert_eq!((status, &answer), (200, &json!({"asked": [id], "stopped": []})));
    assert!(asked.elapsed() < Duration::from_secs(3));
    assert!(view(&service)["stop_asked"].is_string());
    noted(&service, &format!("order {id} (dose) has not stopped yet: its process has not answered for 2 s"));
    let order = service.ended(&id);
    assert!(asked.elapsed() < Duration::from_secs(12), "{:?}", asked.elapsed());
    assert_eq!((&order["state"], &order["error"]["kind"]), (&json!("failed"), &json!("killed")), "{order}");
    let message = order["error"]["message"].as_str().unwrap();
    assert!(message.starts_with("the service ended the process of the order"), "{message}");
    noted(&service, "; it has delivered ");
    wait_for("on_fail", || laboratory.told().iter().any(|told| told == "acid 1 killed").then_some(()));
    let (_, dose) = service.get(&format!("/api/v1/doses/{id}"));
    assert_eq!(dose["schema"], "dose-bounds/1", "{dose}");
    let open = &view(&service)["status"]["unfinished"];
    let bounds = |key: &str| open[key].as_f64().unwrap();
    assert!(bounds("delivered_least_ml") >= 0.0 && bounds("delivered_most_ml") < 200.0, "{open}");
    // The pump goes on as after any cut-off dose.
    let (status, accepted) = service.post("/api/v1/pumps/acid/accept", &json!({}));
    assert_eq!(status, 202, "{accepted}");
}

#[test]
fn a_leak_with_a_process_that_hangs_alarms_at_once_and_the_pump_stands() {
    let laboratory = Laboratory::new(&["acid"], "[[service.input]]\nname = \"leak\"\nsilent = \"10min\"\n");
    laboratory.tell_failures();
    let service = laboratory.serve(&[]);
    let (id, _) = hang(&service);
    let told = Instant::now();
    service.post("/api/v1/inputs/leak", &json!({"ok": false, "reason": "water under the rack"}));
    let (_, metrics) = service.get("/metrics");
    assert!(metrics.as_str().unwrap().contains("dose_stands{pump=\"acid\"} 1"), "{metrics}");
    wait_for("on_fail", || (!laboratory.told().is_empty()).then_some(()));
    assert!(told.elapsed() < Duration::from_secs(8), "{:?}", told.elapsed());
    assert_eq!(service.ended(&id)["error"]["kind"], "killed");
    wait_for("the stand", || {
        let stand = &laboratory.status("acid")["safety"]["stand"];
        (stand["reason"] == "leak: water under the rack").then_some(())
    });
    wait_for("on_fail of the stand", || {
        laboratory.told().iter().any(|told| told == "acid 5 safety").then_some(())
    });
    assert!(!service.get("/api/v1/notes").1.to_string().contains("another process has the pump"));
}
