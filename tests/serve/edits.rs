//! The schedule is edited over HTTP, in its file.

use std::fs;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, wait_for};

const FILE: &str = r#"# The night's doses; Anna changes them.
schema = "schedule/1"
zone = "UTC"

# Twice a day.
[[entry]]   # from the supplier's sheet
name = "twice"
pump = "acid"
dose = "2mL"            # 25mL on Mondays?
at = "03:00"
missed = "skip"

# By the window.
[[entry]]
name = "feed"
pump = "acid"
dose = "1mL"
every = "30min"
between = ["08:00", "20:00"]
options = { rate = "0.5mL/s", smooth = true }
busy = "wait"

# The end.
"#;

fn scheduled(text: &str) -> (Laboratory, Service) {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let service = laboratory.serve(&[]);
    (laboratory, service)
}

fn tag(service: &Service) -> String {
    format!("\"{}\"", service.get("/api/v1/schedule").1["etag"].as_str().unwrap())
}

fn text(laboratory: &Laboratory) -> String {
    fs::read_to_string(laboratory.path("schedule.toml")).unwrap()
}

fn entry<'a>(shown: &'a Value, name: &str) -> Option<&'a Value> {
    shown["schedule"]["entry"].as_array().unwrap().iter().find(|entry| entry["name"] == name)
}

#[test]
fn an_entry_that_is_added_is_in_the_file_and_in_force_with_its_next_runs() {
    let (laboratory, service) = scheduled(FILE);
    let night = json!({"name": "night", "pump": "acid", "dose": "25mL", "at": ["22:00"], "days": ["mon", "tue"],
        "zone": "Europe/Berlin", "batch": {"repeat": 3, "every": "30s"}, "options": {"rate": "5mL/s", "smooth": true},
        "missed": "once", "missed_within": "2h", "busy": "wait"});
    let (status, checked) = service.edit("POST", "?dry-run=true", &night, &tag(&service));
    assert_eq!((status, checked["next"].as_array().map(Vec::len)), (200, Some(3)), "{checked}");
    assert_eq!(text(&laboratory), FILE, "a check writes nothing");

    let before = tag(&service);
    let (status, made) = service.edit("POST", "", &night, &before);
    assert_eq!((status, &made["next"]), (201, &checked["next"]), "{made}");
    assert_ne!(format!("\"{}\"", made["etag"].as_str().unwrap()), before);
    let added = r#"
[[entry]]
name = "night"
pump = "acid"
dose = "25mL"
batch = { every = "30s", repeat = 3 }
options = { rate = "5mL/s", smooth = true }
at = ["22:00"]
days = ["mon", "tue"]
zone = "Europe/Berlin"
missed = "once"
missed_within = "2h"
busy = "wait"
"#;
    assert_eq!(text(&laboratory), FILE.replace("\n\n# The end.\n", &format!("\n{added}\n# The end.\n")));
    let (_, shown) = service.get("/api/v1/schedule");
    assert_eq!(entry(&shown, "night"), Some(&made["entry"]), "it is in force at once");
    assert_eq!(shown["next"][2]["at"], made["next"][0]["at"]);
    let notes = service.get("/api/v1/notes").1.to_string();
    assert!(notes.contains("entry night was added"), "{notes}");
}

#[test]
fn a_change_writes_its_keys_alone_and_keeps_every_comment() {
    let (laboratory, service) = scheduled(FILE);
    let (_, shown) = service.get("/api/v1/schedule");
    let mut twice = entry(&shown, "twice").unwrap().clone();
    twice["dose"] = "25mL".into();
    twice["name"] = "once".into();
    twice["missed"] = "all".into();
    twice["missed_within"] = "1h".into();
    let (status, made) = service.edit("PUT", "/twice", &twice, &tag(&service));
    assert_eq!(status, 200, "{made}");
    let changed = FILE
        .replace("dose = \"2mL\"  ", "dose = \"25mL\"  ")
        .replace("name = \"twice\"", "name = \"once\"")
        .replace("missed = \"skip\"\n", "missed = \"all\"\nmissed_within = \"1h\"\n");
    assert_eq!(text(&laboratory), changed);

    let mut feed = entry(&shown, "feed").unwrap().clone();
    feed["enabled"] = false.into();
    feed.as_object_mut().unwrap().remove("options");
    let (status, made) = service.edit("PUT", "/feed", &feed, &tag(&service));
    assert_eq!((status, &made["next"]), (200, &json!([])), "{made}");
    let changed = changed
        .replace("options = { rate = \"0.5mL/s\", smooth = true }\n", "")
        .replace("busy = \"wait\"\n", "busy = \"wait\"\nenabled = false\n");
    assert_eq!(text(&laboratory), changed);
    feed["enabled"] = true.into();
    let (status, made) = service.edit("PUT", "/feed", &feed, &tag(&service));
    assert_eq!((status, made["next"].as_array().map(Vec::len)), (200, Some(3)), "{made}");
    assert_eq!(
        text(&laboratory),
        changed.replace("enabled = false\n", ""),
        "what says nothing is not written"
    );
}

#[test]
fn an_entry_that_is_removed_leaves_the_others_as_they_were() {
    let (laboratory, service) = scheduled(FILE);
    let (status, made) = service.edit("DELETE", "/twice", &json!({}), &tag(&service));
    assert_eq!(status, 200, "{made}");
    let (head, rest) = FILE.split_once("\n# Twice a day.").unwrap();
    let (_, rest) = rest.split_once("missed = \"skip\"\n").unwrap();
    assert_eq!(text(&laboratory), format!("{head}{rest}"));
    let (status, missing) = service.edit("DELETE", "/twice", &json!({}), &tag(&service));
    assert_eq!((status, &missing["kind"]), (404, &json!("missing")), "{missing}");
}

#[test]
fn an_edit_of_a_file_that_has_changed_since_is_refused() {
    let (laboratory, service) = scheduled(FILE);
    let old = tag(&service);
    let by_hand = FILE.replace("03:00", "04:00");
    fs::write(laboratory.path("schedule.toml"), &by_hand).unwrap();
    let (status, refused) = service.edit("DELETE", "/twice", &json!({}), &old);
    assert_eq!((status, &refused["schema"]), (409, &json!("error/1")), "{refused}");
    assert!(refused["message"].as_str().unwrap().contains("read it again"), "{refused}");
    assert_eq!(text(&laboratory), by_hand);
    wait_for("the new file", || (tag(&service) != old).then_some(()));

    // A file that is refused stays as it is until a person has corrected it.
    let wrong = FILE.replace("03:00", "25:00");
    fs::write(laboratory.path("schedule.toml"), &wrong).unwrap();
    let (status, refused) = service.edit("DELETE", "/feed", &json!({}), &tag(&service));
    assert_eq!(status, 409, "{refused}");
    assert!(refused["message"].as_str().unwrap().contains("at is `25:00`"), "{refused}");
    assert_eq!(text(&laboratory), wrong);
}

#[test]
fn nonsense_is_refused_with_the_words_of_the_file_and_its_key() {
    let (laboratory, service) = scheduled(FILE);
    let good = json!({"name": "new", "pump": "acid", "dose": "2mL", "at": ["05:00"]});
    let with = |key: &str, value: Value| {
        let mut keys = good.clone();
        keys[key] = value;
        keys
    };
    let wrong = [
        (
            with("at", json!(["25:00"])),
            "at",
            "entry `new` of the schedule, at is `25:00`; allowed: 00:00 to 23:59:59",
        ),
        (with("at", json!(["03:00"])), "at", "busy"),
        (with("name", json!("twice")), "name", "a name that no other entry has"),
        (with("name", json!("a b")), "name", "1 to 64 of a-z"),
        (with("pump", json!("nope")), "pump", "nope"),
        (with("dose", json!("5gal")), "dose", "5gal"),
        (with("zone", json!("Berlin")), "zone", "did you mean Europe/Berlin?"),
        (with("batch", json!({"repeat": 0})), "repeat of batch", "whole numbers"),
        (with("batch", json!({"repeat": 1.5})), "repeat of batch", "whole numbers"),
        (with("colour", json!("red")), "colour", "unknown key"),
        (with("missed", Value::Null), "missed", "leave out a key"),
        (with("dose", json!("2mL\"\n[[entry]]")), "dose", "one line"),
        (json!({"name": "new"}), "what it does", "one of dose, prime, rack"),
        (json!({"name": "new", "rack": "mix", "at": "05:00"}), "rack", "no rack `mix`"),
    ];
    for (keys, key, words) in wrong {
        for path in ["", "?dry-run=true"] {
            let (status, refused) = service.edit("POST", path, &keys, &tag(&service));
            let message = refused["message"].as_str().unwrap_or_default();
            assert_eq!((status, &refused["key"]), (422, &json!(key)), "{keys}: {refused}");
            assert!(message.contains(words), "{keys}: {message}");
        }
    }
    for body in [json!([1]), json!("text"), Value::Null] {
        assert_eq!(service.edit("POST", "", &body, &tag(&service)).0, 422, "{body}");
    }
    assert_eq!(service.edit("PUT", "/none", &good, &tag(&service)).0, 404);
    assert_eq!(service.edit("PUT", "/twice?dry=1", &good, &tag(&service)).0, 422);
    assert_eq!(service.post("/api/v1/schedule/entries", &good).0, 428, "an edit names what it was made from");
    assert_eq!(text(&laboratory), FILE);

    // An entry that is switched off may wait for its pump.
    let mut off = with("pump", json!("nope"));
    off["enabled"] = false.into();
    assert_eq!(service.edit("POST", "", &off, &tag(&service)).0, 201);
}

#[test]
fn a_schedule_without_entries_takes_its_first_and_one_in_another_form_is_left_alone() {
    let first =
        json!({"name": "a", "pump": "acid", "prime": "2mL", "every": "8h", "anchor": "2026-03-01 06:00"});
    let (laboratory, service) = scheduled("schema = \"schedule/1\"\n");
    assert_eq!(service.edit("POST", "", &first, &tag(&service)).0, 201);
    assert!(text(&laboratory).starts_with("schema = \"schedule/1\"\n\n[[entry]]\nname = \"a\"\n"));

    let entry = r#"{ name = "b", pump = "acid", dose = "1mL", at = "03:00" }"#;
    let listed = &format!("schema = \"schedule/1\"\nentry = [{entry}]\n");
    let (laboratory, service) = scheduled(listed);
    for (method, path) in [("POST", ""), ("PUT", "/b"), ("DELETE", "/b")] {
        let (status, refused) = service.edit(method, path, &first, &tag(&service));
        assert_eq!(status, 422, "{refused}");
        assert!(refused["message"].as_str().unwrap().contains("[[entry]]"), "{refused}");
    }
    assert_eq!(&text(&laboratory), listed);

    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let (status, refused) = service.edit("POST", "", &first, "\"\"");
    assert_eq!(status, 404, "{refused}");
    assert!(refused["message"].as_str().unwrap().contains("`schedule` in `[service]`"), "{refused}");
}
