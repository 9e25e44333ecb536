//! Inputs of the guard that are told at topics of an MQTT broker.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;

use serde_json::{Value, json};

use crate::broker::Broker;
use crate::laboratory::{Laboratory, PATIENCE, Service, wait_for};

const GOOD: &str = r#"{"ok": true}"#;
const BAD: &str = r#"{"ok": false, "reason": "the tank is nearly empty"}"#;

/// A running broker, and a laboratory whose input `level` is told at `tank/level`; nothing without mosquitto.
fn place(silent: &str) -> Option<(Broker, Laboratory)> {
    let mut broker = Broker::new()?;
    broker.begin();
    let input = "[[service.input]]\nname = \"level\"\npumps = [\"acid\"]\ntopic = \"tank/level\"\n";
    let table = broker.table() + input + &format!("silent = \"{silent}\"\n");
    Some((broker, Laboratory::new(&["acid", "base"], &table)))
}

/// Waits for the input to be in this state, and returns it.
fn is(service: &Service, state: &str) -> Value {
    wait_for(state, || {
        let input = service.get("/api/v1/inputs").1[0].take();
        (input["state"] == state).then_some(input)
    })
}

/// Waits for the pump to stand on record, and returns the reason.
fn stands(laboratory: &Laboratory, pump: &str) -> String {
    let reason = || Some(laboratory.status(pump)["safety"]["stand"]["reason"].as_str()?.to_owned());
    wait_for("the pump to stand on record", reason)
}

#[test]
fn a_message_that_all_is_not_well_stops_the_pumps_of_its_input_alone() {
    let Some((broker, laboratory)) = place("10min") else { return };
    let service = laboratory.serve(&[]);
    let ear = broker.ear();
    ear.status("online");
    ear.send("tank/level", GOOD);
    let input = is(&service, "well");
    assert_eq!((&input["topic"], &input["alive"]), (&json!("tank/level"), &json!(true)), "{input}");
    let (status, refused) = service.post("/api/v1/inputs/level", &json!({"ok": true}));
    assert_eq!((status, &refused["kind"]), (422, &json!("usage")), "its topic alone speaks for it");
    let slow = json!({"rate": "0.5mL/s"});
    let (acid, base) = (service.dose("acid", "200mL", &slow), service.dose("base", "200mL", &slow));
    service.moves("acid");
    service.moves("base");
    ear.send("tank/level", BAD);
    assert_eq!(service.ended(&acid)["code"], 143);
    assert_eq!(stands(&laboratory, "acid"), "level: the tank is nearly empty");
    assert_eq!(service.get(&format!("/api/v1/orders/{base}")).1["state"], "running");
    ear.send("tank/level", GOOD);
    is(&service, "well");
    assert_eq!(service.post("/api/v1/pumps/acid/resume", &json!({})).0, 423, "only a person clears it");
    // A message that cannot be read is no good word.
    ear.send("tank/level", "OK");
    let bad = is(&service, "bad");
    assert!(bad["reason"].as_str().unwrap().starts_with("level: its message cannot be read: "), "{bad}");
}

#[test]
fn a_good_word_that_the_broker_kept_is_no_sign_of_life_and_a_bad_one_counts() {
    let Some((broker, laboratory)) = place("3s") else { return };
    let ear = broker.ear();
    ear.retain("tank/level", GOOD);
    ear.hears("tank/level", |_| true);
    let mut service = laboratory.serve(&[]);
    let input = is(&service, "silent");
    assert_eq!((&input["word"], &input["last"]), (&Value::Null, &Value::Null), "{input}");
    stands(&laboratory, "acid");
    // A word that is sent now counts, though its sender has the broker keep it.
    ear.status("online");
    ear.retain("tank/level", GOOD);
    is(&service, "well");
    ear.retain("tank/level", BAD);
    is(&service, "bad");
    assert_eq!(service.end(), Some(0));
    let service = laboratory.serve_again(&service);
    assert_eq!(is(&service, "bad")["reason"], "level: the tank is nearly empty");
}

#[test]
fn an_input_whose_broker_is_away_is_silent() {
    let Some((mut broker, laboratory)) = place("5s") else { return };
    let service = laboratory.serve(&[]);
    let ear = broker.ear();
    ear.status("online");
    ear.send("tank/level", GOOD);
    is(&service, "well");
    let id = service.dose("acid", "200mL", &json!({"rate": "0.5mL/s"}));
    broker.end();
    assert_eq!(service.ended(&id)["code"], 143);
    let reason = stands(&laboratory, "acid");
    let words = "level: silent, not once in 5s it said that all is well (the MQTT broker 127.0.0.1:";
    assert!(reason.starts_with(words) && reason.ends_with(" was away)"), "{reason}");
}

#[test]
fn a_watcher_is_told_the_inputs_first_and_each_that_speaks() {
    let input = "[[service.input]]\nname = \"level\"\nsilent = \"10min\"\n";
    let laboratory = Laboratory::new(&["acid"], input);
    let service = laboratory.serve(&[]);
    let mut stream = TcpStream::connect(service.url.trim_start_matches("http://")).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let host = service.url.trim_start_matches("http://");
    stream.write_all(format!("GET /events HTTP/1.1\r\nhost: {host}\r\n\r\n").as_bytes()).unwrap();
    let mut lines = BufReader::new(stream).lines().map(Result::unwrap);
    let mut data_of = |event: &str| -> Value {
        lines.find(|line| line == &format!("event: {event}")).unwrap();
        let data = lines.find(|line| line.starts_with("data: ")).unwrap();
        serde_json::from_str(data.trim_start_matches("data: ")).unwrap()
    };
    let hello = data_of("hello");
    let input = &hello["inputs"][0];
    assert_eq!((&input["name"], &input["pumps"]), (&json!("level"), &json!(["acid"])), "{hello}");
    assert_eq!((&input["word"], &input["alive"]), (&Value::Null, &json!(false)), "{hello}");
    assert_eq!(service.post("/api/v1/inputs/level", &json!({"ok": true})).0, 200);
    let told = data_of("input");
    assert_eq!((&told["word"], &told["alive"]), (&json!("well"), &json!(true)), "{told}");
    let (_, description) = service.get("/openapi.json");
    let fields = &description["components"]["schemas"]["InputView"]["properties"];
    for field in ["name", "pumps", "word", "age_s", "alive", "topic"] {
        assert!(fields[field].is_object(), "{field}: {fields}");
    }
}
