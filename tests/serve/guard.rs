//! Inputs that must be alive: one that is not well stops its pumps and puts them to stand until a person clears them.

mod input_topics;

use std::fs;
use std::process::Stdio;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, wait_for};

/// Keys of an input.
fn input(keys: &str) -> String {
    format!("[[service.input]]\n{keys}\n")
}

/// Waits until the pump stands on record, and returns the stand.
fn stands(laboratory: &Laboratory, pump: &str) -> Value {
    wait_for("the pump to stand on record", || {
        let stand = laboratory.status(pump)["safety"]["stand"].clone();
        (!stand.is_null()).then_some(stand)
    })
}

fn tell(service: &Service, input: &str, ok: bool, reason: Option<&str>) -> Value {
    let body = json!({"ok": ok, "reason": reason});
    let (status, told) = service.post(&format!("/api/v1/inputs/{input}"), &body);
    assert_eq!(status, 200, "{told}");
    told
}

fn clear(service: &Service, pump: &str) {
    let (status, cleared) =
        service.post(&format!("/api/v1/pumps/{pump}/clear"), &json!({"reason": "looked at it", "by": "Ada"}));
    assert_eq!((status, &cleared["state"]), (202, &json!("done")), "{cleared}");
}

/// Waits until the notes of the guard say this.
fn noted(service: &Service, words: &str) {
    wait_for(words, || {
        let notes = service.get("/api/v1/notes").1;
        let of_guard = notes.as_array().unwrap().iter().filter(|note| note["kind"] == "guard");
        of_guard.into_iter().any(|note| note["text"].as_str().unwrap().contains(words)).then_some(())
    });
}

/// Words that clear the pump `acid`.
const CLEAR: [&str; 7] = ["safety", "clear", "acid", "--reason", "looked at it", "--by", "Ada"];

/// Clears the pump `acid` in vain while there is still water: by the service and by the command that asks it, which
/// refuse, and by the record alone, which does not help.
fn clear_in_vain(laboratory: &Laboratory, service: &Service) {
    let (status, refused) =
        service.post("/api/v1/pumps/acid/clear", &json!({"reason": "looked", "by": "Ada"}));
    let why = "input leak is not well: water under the rack; pump acid stands until it is";
    assert_eq!((status, &refused["code"], &refused["message"]), (423, &json!(5), &json!(why)), "{refused}");
    let typed = laboratory.run(&CLEAR);
    assert_eq!(typed.status.code(), Some(5));
    assert_eq!(String::from_utf8_lossy(&typed.stderr), format!("error: {why}\n"));
    assert_ne!(laboratory.status("acid")["safety"]["stand"], Value::Null);
    let alone = laboratory.run(&[&CLEAR[..], &["--no-service"]].concat());
    assert_eq!(alone.status.code(), Some(0), "{}", String::from_utf8_lossy(&alone.stderr));
    noted(service, "acid was cleared while its input was not well, so it stands again: leak: water under");
}

#[test]
fn an_input_that_is_told_bad_stops_its_pump_and_only_a_person_lets_it_go_on() {
    let told = input("name = \"leak\"\npumps = [\"acid\"]\nsilent = \"10min\"");
    let laboratory = Laboratory::new(&["acid", "base"], &told);
    let service = laboratory.serve(&[]);
    let (status, listed) = service.get("/api/v1/inputs");
    assert_eq!(status, 200);
    let waiting = json!([{"schema": "input/1", "name": "leak", "pumps": ["acid"], "state": "waiting", "reason": null,
        "last": null, "word": null, "age_s": null, "alive": false, "topic": null, "told": true, "silent_s": 600.0}]);
    assert_eq!(listed, waiting);
    let slow = json!({"rate": "0.5mL/s"});
    let (acid, base) = (service.dose("acid", "200mL", &slow), service.dose("base", "200mL", &slow));
    service.moves("acid");
    service.moves("base");

    let bad = tell(&service, "leak", false, Some("water under the rack"));
    assert_eq!((&bad["state"], &bad["reason"]), (&json!("bad"), &json!("leak: water under the rack")));
    assert_eq!((&bad["word"], &bad["alive"]), (&json!("bad"), &json!(true)));
    assert!(bad["age_s"].as_f64().unwrap() < 60.0, "{bad}");
    // From that answer on nothing begins, whether the stand is on record or not.
    let (status, refused) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    assert_eq!((status, &refused["code"], &refused["kind"]), (423, &json!(5), &json!("safety")), "{refused}");
    let order = service.ended(&acid);
    assert_eq!((&order["state"], &order["code"]), (&json!("failed"), &json!(143)), "{order}");
    let stand = stands(&laboratory, "acid");
    assert_eq!(
        (&stand["limit"], &stand["reason"]),
        (&json!("ordered"), &json!("leak: water under the rack"))
    );
    let typed = laboratory.run(&["1mL", "--pump", "acid", "--no-service"]);
    assert_eq!(typed.status.code(), Some(5));
    assert!(String::from_utf8_lossy(&typed.stderr).contains("leak: water under the rack"));
    assert_eq!(laboratory.log("acid")[0]["cause"], "leak: water under the rack");
    noted(&service, "acid stands until a person clears it: leak: water under the rack");

    // The other pump goes on, and is stopped by its own stop.
    assert_eq!(service.get(&format!("/api/v1/orders/{base}")).1["state"], "running");
    assert_eq!(laboratory.status("base")["safety"]["stand"], Value::Null);

    // The good word alone does not help either.
    clear_in_vain(&laboratory, &service);
    let journal = fs::read_to_string(laboratory.path("records/acid/sim/journal.jsonl")).unwrap();
    assert!(journal.contains("looked at it (by Ada)"), "{journal}");
    stands(&laboratory, "acid");
    assert_eq!(tell(&service, "leak", true, None)["state"], "well");
    noted(&service, "input leak: all is well again");
    wait_for("the record to refuse by itself", || {
        let (status, refused) = service.post("/api/v1/pumps/acid/resume", &json!({}));
        assert_eq!((status, &refused["code"]), (423, &json!(5)), "{refused}");
        refused["message"].as_str().unwrap().contains("stands by order since").then_some(())
    });
    let typed = laboratory.run(&CLEAR);
    assert_eq!(typed.status.code(), Some(0), "{}", String::from_utf8_lossy(&typed.stderr));
    assert!(
        String::from_utf8_lossy(&typed.stdout).starts_with("acid may go on, and your reason is on record")
    );
    let orders = service.get("/api/v1/orders?pump=acid").1;
    assert!(orders[0]["words"].to_string().contains("\"safety\",\"clear\",\"acid\""), "{orders}");
    let notes = service.get("/api/v1/notes").1;
    assert!(notes.to_string().contains("acid was cleared by Ada: looked at it"), "{notes}");
    let (status, accepted) = service.post("/api/v1/pumps/acid/accept", &json!({}));
    assert_eq!(status, 202, "{accepted}");
    service.ended(accepted["id"].as_str().unwrap());
    let done = service.ended(&service.dose("acid", "0.2mL", &json!({})));
    assert_eq!(done["state"], "done", "{done}");
}

#[test]
fn a_command_that_fails_puts_every_pump_to_stand_and_on_fail_tells_of_each() {
    let command = "if test -e water; then echo water under the rack; exit 1; fi";
    let laboratory = Laboratory::new(&["acid", "base"], "");
    let config = laboratory.path("config.toml");
    let text = fs::read_to_string(&config).unwrap();
    let on_fail =
        "on_fail = \"cat >> told; echo $DOSE_FAIL_PUMP $DOSE_FAIL_CODE $DOSE_FAIL_KIND >> told\"\n[pumps]";
    let text = text.replace("[pumps]", on_fail);
    let text = text + &input(&format!("name = \"leak\"\ncommand = \"{command}\"\nevery = \"200ms\""));
    fs::write(&config, text).unwrap();
    let mut service = laboratory.serve(&[]);
    wait_for("the command to say that all is well", || {
        (service.get("/api/v1/inputs").1[0]["state"] == "well").then_some(())
    });
    let (status, refused) = service.post("/api/v1/inputs/leak", &json!({"ok": true}));
    assert_eq!((status, &refused["kind"]), (422, &json!("usage")), "its command alone speaks for it");
    let id = service.dose("acid", "200mL", &json!({"rate": "0.5mL/s"}));
    service.moves("acid");
    fs::write(laboratory.path("water"), "").unwrap();
    assert_eq!(service.ended(&id)["code"], 143);
    for pump in ["acid", "base"] {
        assert_eq!(stands(&laboratory, pump)["reason"], "leak: water under the rack");
        wait_for("on_fail", || {
            let told = fs::read_to_string(laboratory.path("told")).unwrap_or_default();
            told.contains(&format!("{pump} 5 safety\n")).then_some(())
        });
    }
    // A restart of the service lets no pump go on, even where all is well by then.
    fs::remove_file(laboratory.path("water")).unwrap();
    assert_eq!(service.end(), Some(0));
    let service = laboratory.serve_again(&service);
    let (status, refused) = service.post("/api/v1/pumps/base/dose", &json!({"volume": "1mL"}));
    assert_eq!((status, &refused["code"]), (423, &json!(5)), "{refused}");
}

#[test]
fn an_input_that_is_silent_for_too_long_stops_its_pump() {
    let laboratory = Laboratory::new(&["acid"], &input("name = \"level\"\nsilent = \"6s\""));
    let service = laboratory.serve(&[]);
    tell(&service, "level", true, None);
    let id = service.dose("acid", "200mL", &json!({"rate": "0.5mL/s"}));
    service.moves("acid");
    tell(&service, "level", true, None);
    assert_eq!(service.ended(&id)["code"], 143);
    let reason = stands(&laboratory, "acid")["reason"].as_str().unwrap().to_owned();
    assert_eq!(reason, "level: silent, not once in 6s it said that all is well");
    assert_eq!(service.get("/api/v1/inputs").1[0]["state"], "silent");
}

#[test]
fn on_fail_tells_one_volume_of_a_dose_that_the_guard_stops() {
    let laboratory = Laboratory::new(&["acid"], &input("name = \"leak\"\nsilent = \"10min\""));
    let config = laboratory.path("config.toml");
    let on_fail =
        "on_fail = \"echo $DOSE_FAIL_KIND $DOSE_FAIL_LEAST_ML $DOSE_FAIL_MOST_ML $(cat) >> told\"\n[pumps]";
    let text = fs::read_to_string(&config).unwrap().replacen("[pumps]", on_fail, 1);
    fs::write(&config, text).unwrap();
    let service = laboratory.serve(&[]);
    let id = service.dose("acid", "50mL", &json!({"rate": "1mL/s"}));
    service.moves("acid");
    tell(&service, "leak", false, None);
    service.ended(&id);
    let told = wait_for("on_fail of both", || Some(laboratory.told()).filter(|told| told.len() == 2));
    let of = |kind: &str| {
        let line = told.iter().find(|line| line.starts_with(kind)).unwrap_or_else(|| panic!("{told:?}"));
        line.splitn(4, ' ').skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let (stopped, stands) = (of("stopped"), of("safety"));
    for (one, other) in stopped[..2].iter().zip(&stands[..2]) {
        let (one, other): (f64, f64) = (one.parse().unwrap(), other.parse().unwrap());
        assert!(one > 0.0 && (one - other).abs() < 1e-5, "one volume: {told:?}");
    }
    assert!(stands[2].contains("\"moved\":true"), "{told:?}");
}

#[test]
fn a_pump_that_another_process_holds_stands_as_soon_as_that_has_ended() {
    let laboratory = Laboratory::new(&["acid"], &input("name = \"leak\"\nsilent = \"10min\""));
    let service = laboratory.serve(&[]);
    let words = ["200mL", "--rate", "0.5mL/s", "--pace", "real", "--no-service"];
    let mut other = laboratory.dose(&words);
    let mut other = other.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for("the other process to have the pump", || {
        laboratory.status("acid")["in_use_by"].as_str().map(drop)
    });
    tell(&service, "leak", false, None);
    noted(&service, "acid does not stand on record yet");
    let (status, refused) =
        service.post("/api/v1/pumps/acid/clear", &json!({"reason": "too early", "by": "Ada"}));
    assert_eq!((status, &refused["code"]), (423, &json!(5)), "{refused}");
    crate::laboratory::signal(other.id(), "INT");
    other.wait().unwrap();
    assert_eq!(stands(&laboratory, "acid")["reason"], "leak: it says that not all is well");
}

#[test]
fn a_pump_is_put_to_stand_over_http() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    assert_eq!(service.get("/api/v1/inputs"), (200, json!([])));
    assert_eq!(service.post("/api/v1/inputs/leak", &json!({"ok": true})).0, 404);
    let path = "/api/v1/pumps/acid/stand";
    assert_eq!(service.post(path, &json!({"reason": ""})).0, 422);
    let (status, order) = service.post(path, &json!({"reason": "the hose is off"}));
    assert_eq!(status, 202, "{order}");
    assert_eq!(service.ended(order["id"].as_str().unwrap())["state"], "done");
    let (status, refused) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    assert_eq!(status, 423);
    assert!(refused["message"].as_str().unwrap().contains("the hose is off"), "{refused}");
    clear(&service, "acid");
    let (_, orders) = service.get("/api/v1/orders?pump=acid&limit=1");
    assert_eq!((&orders[0]["reason"], &orders[0]["by"]), (&json!("looked at it"), &json!("Ada")), "{orders}");
    service.ended(&service.dose("acid", "1mL", &json!({})));
}

#[test]
fn an_input_with_a_wrong_value_is_refused_with_its_key_and_value() {
    for (keys, told) in [
        ("name = \"Leak 1\"", "the name of a [[service.input]] is `Leak 1`; allowed: 1 to 64 of a-z"),
        ("name = \"a\"\npumps = [\"bse\"]", "pumps of the [[service.input]] `a` is `bse`; allowed: names of"),
        ("name = \"a\"\npumps = []", "pumps of the [[service.input]] `a` is `[]`; allowed: one pump or more"),
        ("name = \"a\"\ncommand = \" \"", "command of the [[service.input]] `a` is ``; allowed: a command"),
        ("name = \"a\"\nevery = \"5s\"", "every of the [[service.input]] `a` is `5s`; allowed: a `command`"),
        (
            "name = \"a\"\ncommand = \"true\"\nevery = \"40s\"",
            "silent of the [[service.input]] `a` is `30s`; allowed",
        ),
        ("name = \"a\"\nsilent = \"0.01s\"", "the time is `0.01s`; allowed: 0.1s to 24h"),
        ("name = \"a\"\nsilent = \"30\"", "silent = \"30\""),
        (
            "name = \"a\"\ntopic = \"x\"",
            "topic of the [[service.input]] `a` is `x`; allowed: a table [service.mqtt]",
        ),
        (
            "name = \"a\"\ntopic = \"x/+\"",
            "topic of the [[service.input]] `a` is `x/+`; allowed: words with `/`",
        ),
        (
            "name = \"a\"\ntopic = \"x\"\ncommand = \"true\"",
            "topic of the [[service.input]] `a` is `x`; allowed: no `command` beside it",
        ),
        (
            "name = \"a\"\ntopic = \"pump-dose/x\"\n[service.mqtt]\nbroker = \"localhost:1883\"",
            "is `pump-dose/x`; allowed: a topic that is not below `pump-dose`",
        ),
        ("name = \"a\"\n[[service.input]]\nname = \"a\"", "is `a`; allowed: a name that no other input has"),
    ] {
        let laboratory = Laboratory::new(&["acid"], &input(keys));
        let refused = laboratory.run(&["serve", "--listen", "127.0.0.1:0"]);
        let error = String::from_utf8_lossy(&refused.stderr).replace("\n  ", " ");
        assert_eq!(refused.status.code(), Some(2), "{keys}: {error}");
        assert!(error.contains(told), "{keys}: {error}");
    }
}
