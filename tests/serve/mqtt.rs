//! The service at an MQTT broker.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use serde_json::{Value, json};

use crate::broker::{Broker, Message};
use crate::laboratory::{Laboratory, Service, wait_for};

/// Time in which a dose that must not be made would have been made.
const A_WHILE: Duration = Duration::from_millis(1500);

/// A running broker and a laboratory whose service uses it; nothing without mosquitto.
fn place(more: &str) -> Option<(Broker, Laboratory)> {
    let mut broker = Broker::new()?;
    broker.begin();
    let laboratory = Laboratory::new(&["acid", "base"], &(broker.table() + more));
    Some((broker, laboratory))
}

fn notes(service: &Service, words: &str) -> usize {
    let (_, notes) = service.get("/api/v1/notes");
    let texts = notes.as_array().unwrap().iter().map(|note| note["text"].as_str().unwrap());
    texts.filter(|text| text.contains(words)).count()
}

#[test]
fn a_dose_by_text_and_by_json_is_answered_and_told() {
    let Some((broker, laboratory)) = place("") else { return };
    let service = laboratory.serve(&["--pace", "fast"]);
    let ear = broker.ear();
    ear.status("online");
    let state = ear.state("acid", "idle");
    assert_eq!((&state["schema"], &state["delivered_ml"]), (&json!("mqtt-pump/1"), &Value::Null), "{state}");

    let order = ear.ask("acid", "dose", "2.5mL");
    assert_eq!((&order["schema"], &order["origin"]), (&json!("order/1"), &json!("mqtt")), "{order}");
    assert_eq!((&order["command"], &order["key"]), (&json!("dose"), &Value::Null));
    service.ended(order["id"].as_str().unwrap());
    let body = r#"{"volume": "3mL", "options": {"rate": "2mL/s", "smooth": true}, "key": "vial 3"}"#;
    let order = ear.ask("acid", "dose", body);
    assert_eq!((&order["options"]["smooth"], &order["key"]), (&json!(true), &json!("vial 3")), "{order}");
    service.ended(order["id"].as_str().unwrap());
    let told = ear.hears("pump-dose/acid/state", |state| {
        let state = state.json();
        state["asked_ml"] == 3.0 && state["state"] == "idle"
    });
    assert!((told.json()["delivered_ml"].as_f64().unwrap() - 3.0).abs() < 0.01, "{told:?}");
    assert!(told.json()["tube_ml"].as_f64().unwrap() > 5.4);
    assert_eq!(laboratory.log("acid").len(), 2);

    // A later client is told the last state by the broker.
    let late = broker.ear();
    let state = late.hears("pump-dose/acid/state", |_| true);
    assert!(state.is_retained && state.json()["asked_ml"] == 3.0, "{state:?}");
}

#[test]
fn a_motion_tells_its_progress_and_is_stopped() {
    let Some((broker, laboratory)) = place("") else { return };
    let service = laboratory.serve(&[]);
    let ear = broker.ear();
    ear.status("online");
    ear.ask("acid", "dose", r#"{"volume": "20mL", "options": {"rate": "1mL/s"}}"#);
    ear.state("acid", "moving");
    let moved = |message: &Message| message.json()["delivered_ml"].as_f64().is_some_and(|ml| ml > 1.5);
    ear.hears("pump-dose/acid/progress", moved);
    let told = ear.at("pump-dose/acid/progress");
    assert!(told.iter().all(|message| !message.is_retained));
    let delivered = |message: &Message| message.json()["delivered_ml"].as_f64().unwrap();
    // At 1 mL/s two lines that are half a second apart are 0.5 mL apart, but the last ones may be caught up.
    assert!(told.len() <= 8, "{} lines for {:?}", told.len(), told.last().map(delivered));

    let answer = ear.ask("acid", "stop", "PRESS");
    assert_eq!(answer["asked"].as_array().unwrap().len(), 1, "{answer}");
    let state = ear.state("acid", "unfinished");
    assert_eq!(state["order"], Value::Null);
    assert_eq!(laboratory.log("acid")[0]["cause"], "a stop by MQTT");
    let order = ear.ask("acid", "accept", "accept");
    assert_eq!((&order["schema"], &order["task"]), (&json!("order/1"), &json!("accept")), "{order}");
    ear.state("acid", "idle");

    for pump in ["acid", "base"] {
        ear.ask(pump, "dose", r#"{"volume": "20mL", "options": {"rate": "1mL/s"}}"#);
        service.moves(pump);
    }
    ear.send("pump-dose/stop/set", "");
    for pump in ["acid", "base"] {
        ear.state(pump, "unfinished");
    }
    let answer = ear.hears("pump-dose/stop/answer", |_| true).json();
    assert_eq!(answer["asked"].as_array().unwrap().len(), 2, "{answer}");
}

#[test]
fn a_pump_that_stands_says_why_and_the_last_note_is_kept() {
    let more = "[[service.input]]\nname = \"leak\"\npumps = [\"acid\"]\nsilent = \"10min\"\n";
    let Some((broker, laboratory)) = place(more) else { return };
    let service = laboratory.serve(&[]);
    let ear = broker.ear();
    assert!(ear.state("acid", "idle")["reason"].is_null());
    let bad = json!({"ok": false, "reason": "water under the rack"});
    assert_eq!(service.post("/api/v1/inputs/leak", &bad).0, 200);
    assert_eq!(ear.state("acid", "stands")["reason"], "leak: water under the rack");
    let words = "acid stands until a person clears it: leak: water under the rack";
    ear.hears("pump-dose/notes", |note| note.json()["text"] == words);
    // Whoever comes later hears it too.
    let later = broker.ear().hears("pump-dose/notes", |note| note.is_retained);
    assert_eq!(later.json()["text"], words);
}

#[test]
fn a_stop_right_after_a_dose_finds_it() {
    let Some((broker, laboratory)) = place("") else { return };
    let service = laboratory.serve(&[]);
    let ear = broker.ear();
    ear.status("online");
    ear.send("pump-dose/acid/dose/set", "20mL");
    ear.send("pump-dose/acid/stop/set", "now");
    let is_stop = |message: &Message| message.json()["command"] == "stop";
    let stopped = ear.hears("pump-dose/acid/answer", is_stop).json();
    let id = stopped["asked"][0].as_str().unwrap().to_owned();
    // The stop may come before the first step, so that nothing was moved, or soon after it.
    let order = service.ended(&id);
    assert!(["refused", "failed"].contains(&order["state"].as_str().unwrap()), "{order}");
    let delivered_ml =
        laboratory.log("acid").iter().filter_map(|dose| dose["delivered_ml"].as_f64()).sum::<f64>();
    assert!(delivered_ml < 10.0, "{delivered_ml} of 20 mL");
}

#[test]
fn a_killed_service_is_offline_and_an_ended_one_too() {
    let Some((broker, laboratory)) = place("") else { return };
    let mut service = laboratory.serve(&[]);
    let ear = broker.ear();
    ear.status("online");
    service.kill();
    ear.status("offline");

    let mut service = laboratory.serve_again(&service);
    ear.status("online");
    ear.ask("acid", "dose", r#"{"volume": "20mL", "options": {"rate": "1mL/s"}}"#);
    ear.state("acid", "moving");
    assert_eq!(service.end(), Some(0));
    // The goodbye comes after the last state.
    ear.status("offline");
    let heard = ear.all();
    let last = |topic: &str| heard.iter().rposition(|message| message.topic == topic).unwrap();
    assert_eq!(heard[last("pump-dose/acid/state")].json()["state"], "unfinished");
    assert!(last("pump-dose/acid/state") < last("pump-dose/status"));
    assert!(broker.ear().hears("pump-dose/status", |_| true).is_retained);
}

#[test]
fn a_retained_command_never_doses() {
    let Some((mut broker, laboratory)) = place("") else { return };
    laboratory.tell_failures();
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let ear = broker.ear();
    ear.status("online");
    ear.retain("pump-dose/acid/dose/set", "2mL");
    let answer = ear.hears("pump-dose/acid/answer", |_| true).json();
    assert_eq!((&answer["schema"], &answer["kind"]), (&json!("error/1"), &json!("retained")), "{answer}");
    let words = "a retained command would dose again after each restart";
    assert!(answer["message"].as_str().unwrap().contains(words), "{answer}");
    wait_for("on_fail", || (laboratory.told() == ["acid 2 retained"]).then_some(()));
    ear.retain("pump-dose/acid/dose/set", "2mL");

    // The broker has it again for the service that begins anew.
    assert_eq!(service.end(), Some(0));
    let service = laboratory.serve_again(&service);
    wait_for("the service to tell it", || (notes(&service, words) == 2).then_some(()));

    broker.end();
    wait_for("the loss to be told", || (notes(&service, "is away") > 0).then_some(()));
    broker.begin();
    let ear = broker.ear();
    assert!(ear.hears("pump-dose/acid/dose/set", |_| true).is_retained, "the broker kept it");
    ear.status("online");
    sleep(A_WHILE);
    assert_eq!(notes(&service, words), 2, "told once by each service");
    assert!(laboratory.log("acid").is_empty(), "nothing was dosed");
    assert_eq!(ear.ask("acid", "dose", "lots")["kind"], "usage");
    wait_for("on_fail of nonsense", || laboratory.told().contains(&"acid 2 usage".to_owned()).then_some(()));

    // Deleting it sends an empty one, which moves nothing either. Then a dose is a dose.
    ear.retain("pump-dose/acid/dose/set", "");
    let order = ear.ask("acid", "dose", "2mL");
    assert_eq!(order["schema"], "order/1", "{order}");
    service.ended(order["id"].as_str().unwrap());
    assert_eq!(laboratory.log("acid").len(), 1);
}

#[test]
fn a_repeated_key_doses_once_over_a_restart() {
    let Some((broker, laboratory)) = place("") else { return };
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let ear = broker.ear();
    ear.status("online");
    let body = r#"{"volume": "2mL", "key": "night 7"}"#;
    let first = ear.ask("acid", "dose", body);
    let again = ear.ask("acid", "dose", body);
    assert_eq!((&first["id"], &again["repeated"]), (&again["id"], &json!(true)), "{again}");
    service.ended(first["id"].as_str().unwrap());
    let other = ear.ask("acid", "dose", r#"{"volume": "3mL", "key": "night 7"}"#);
    assert_eq!((&other["kind"], &other["key"]), (&json!("key"), &json!("night 7")), "{other}");
    assert_eq!(service.end(), Some(0));
    ear.status("offline");
    let _service = laboratory.serve_again(&service);
    ear.status("online");
    assert_eq!(ear.ask("acid", "dose", body)["id"], first["id"]);
    assert_eq!(laboratory.log("acid").len(), 1, "one dose was made");
}

#[test]
fn what_cannot_be_done_is_answered_and_moves_nothing() {
    let Some((broker, laboratory)) = place("") else { return };
    let _service = laboratory.serve(&["--pace", "fast"]);
    let ear = broker.ear();
    ear.status("online");
    for (pump, word, text, message) in [
        ("acid", "dose", "5", "unit"),
        ("acid", "dose", "", "the payload is empty, so nothing is done"),
        ("acid", "dose", "--on-fail=reboot", "write a number with its unit"),
        ("acid", "dose", r#"{"volume": "5mL", "rate": "1mL/s"}"#, "unknown field `rate`"),
        ("acid", "dose", r#"{"volume": "5mL", "options": {"on-fail": "x"}}"#, "--on-fail is no option"),
        ("acid", "dose", "PRESS", "no volume is kept"),
        ("acid", "dose", r#"{"volume": "5mL", "key": ""}"#, "the key is 0 bytes long"),
        ("acid", "resume", "off", "allowed: resume"),
        ("acid", "volume", "all", "a number above 0, in mL"),
        ("acid", "dosage", "5mL", "there is no command `dosage`"),
        ("nobody", "dose", "5mL", "there is no pump `nobody`"),
    ] {
        let answer = ear.ask(pump, word, text);
        assert_eq!(
            (&answer["schema"], &answer["moved"]),
            (&json!("error/1"), &json!(false)),
            "{text}: {answer}"
        );
        assert!(answer["message"].as_str().unwrap().contains(message), "{text}: {answer}");
        assert_eq!(answer["command"], word);
    }
    assert!(laboratory.log("acid").is_empty());
}

#[test]
fn home_assistant_finds_the_pumps_and_a_changed_volume_alone_does_not_dose() {
    let Some((broker, laboratory)) = place("discovery = \"homeassistant\"\n") else { return };
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let ear = broker.ear();
    ear.status("online");
    let documents: Vec<Message> =
        ear.all().into_iter().filter(|message| message.topic.starts_with("homeassistant/")).collect();
    assert_eq!(documents.len(), 2 * 8, "{documents:?}");
    let told = |topic: &Value| !ear.at(topic.as_str().unwrap()).is_empty();
    let mut names = Vec::new();
    for message in &documents {
        let document = message.json();
        assert!(told(&document["availability_topic"]), "{document}");
        names.push(document["unique_id"].to_string());
        assert_eq!(message.topic.split('/').count(), 5, "{message:?}");
        if let Some(topic) = document.get("state_topic").filter(|_| !message.topic.contains("/number/")) {
            assert!(told(topic), "{document}");
        }
        for key in document
            .get("value_template")
            .iter()
            .flat_map(|words| words.as_str().unwrap().split("value_json.").skip(1))
        {
            let key: String = key.chars().take_while(|c| c.is_ascii_lowercase() || *c == '_').collect();
            let state = ear.at("pump-dose/acid/state")[0].json();
            assert!(state.get(&key).is_some(), "{key} in {document}");
        }
    }
    names.sort();
    names.dedup();
    assert_eq!(names.len(), documents.len());
    let of = |object: &str| {
        let topic = |message: &&Message| message.topic.ends_with(&format!("/pump-dose_acid/{object}/config"));
        documents.iter().find(topic).unwrap().json()
    };

    // A person sets the number, and then presses the button.
    let number = of("volume");
    ear.send(number["command_topic"].as_str().unwrap(), "2.5");
    ear.hears(number["state_topic"].as_str().unwrap(), |message| message.text == "2.5");
    sleep(A_WHILE);
    assert!(laboratory.log("acid").is_empty(), "a changed number doses nothing");
    let press = |document: &Value| {
        let text = |key: &str| document[key].as_str().unwrap().to_owned();
        ear.send(&text("command_topic"), &text("payload_press"));
    };
    let dosed = |count| wait_for("the dose", || (laboratory.log("acid").len() == count).then_some(()));
    press(&of("dose"));
    dosed(1);
    assert_eq!(
        ear.hears("pump-dose/acid/state", |state| state.json()["asked_ml"] == 2.5).json()["schema"],
        "mqtt-pump/1"
    );
    press(&of("stop"));
    ear.hears("pump-dose/acid/answer", |message| message.json()["command"] == "stop");

    // The number is kept over a restart.
    ear.state("acid", "idle");
    assert_eq!(service.end(), Some(0));
    ear.status("offline");
    let _service = laboratory.serve_again(&service);
    ear.status("online");
    press(&of("dose"));
    dosed(2);
}

#[test]
fn a_broker_that_is_away_holds_up_no_pump() {
    let Some(mut broker) = Broker::new() else { return };
    let laboratory = Laboratory::new(&["acid"], &broker.table());
    let service = laboratory.serve(&["--pace", "fast"]);
    wait_for("the loss to be told", || (notes(&service, "is away") == 1).then_some(()));
    service.ended(&service.dose("acid", "2mL", &json!({})));
    broker.begin();
    let ear = broker.ear();
    ear.status("online");
    assert_eq!(notes(&service, "is back"), 1);
    // The dose from before is told now.
    ear.hears("pump-dose/acid/state", |state| state.json()["asked_ml"] == 2.0);

    broker.end();
    wait_for("the second loss to be told", || (notes(&service, "is away") == 2).then_some(()));
    service.ended(&service.dose("acid", "3mL", &json!({})));
    sleep(A_WHILE);
    assert_eq!(notes(&service, "is away"), 2, "a loss is told once");
    broker.begin();
    let ear = broker.ear();
    ear.hears("pump-dose/acid/state", |state| state.json()["asked_ml"] == 3.0);
    assert_eq!(ear.ask("acid", "dose", "1mL")["schema"], "order/1");
    wait_for("the note", || (notes(&service, "is back") == 2).then_some(()));
}

#[test]
fn a_user_has_the_password_of_a_file() {
    let Some(mut broker) = Broker::new() else { return };
    broker.password("pumps", "a b c");
    broker.begin();
    let more = "user = \"pumps\"\npassword_file = \"word\"\n";
    let laboratory = Laboratory::new(&["acid"], &(broker.table() + more));
    fs::write(laboratory.path("word"), "wrong\n").unwrap();
    let mut service = laboratory.serve(&[]);
    let refused = "it refuses the user or the password";
    wait_for("the refusal to be told", || (notes(&service, refused) == 1).then_some(()));
    assert_eq!(service.end(), Some(0));
    fs::write(laboratory.path("word"), "a b c\n").unwrap();
    let _service = laboratory.serve_again(&service);
    broker.ear_of(Some(("pumps", "a b c"))).status("online");

    // The file is missed before anything begins.
    fs::remove_file(laboratory.path("word")).unwrap();
    let missed = laboratory.run(&["serve", "--listen", "127.0.0.1:0", "--state-dir", "elsewhere"]);
    assert_eq!(missed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&missed.stderr).contains("word"));
}
