//! The schedule is edited over HTTP, in its file.

use std::fs;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, wait_for};

/// Pumps that cannot move now: a dose is unfinished, the pump stands, and it is in use.
const WAITING: [&str; 3] = ["acid", "base", "dye"];

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

/// Has a dose of the first of [`WAITING`] be unfinished, and the second one stand.
fn have_wait(service: &Service) {
    let half = service.dose("acid", "40mL", &json!({"rate": "1mL/s"}));
    service.moves("acid");
    assert_eq!(service.post("/api/v1/pumps/acid/stop", &json!({"reason": "the hose is off"})).0, 200);
    assert_eq!(service.ended(&half)["state"], "failed");
    let (status, stands) = service.post("/api/v1/pumps/base/stand", &json!({"reason": "a leak"}));
    assert_eq!(status, 202, "{stands}");
    service.ended(stands["id"].as_str().unwrap());
}

#[test]
fn an_entry_is_tried_out_whatever_its_pump_waits_for() {
    let laboratory = Laboratory::new(&WAITING, "[service]\nschedule = \"schedule.toml\"\n");
    fs::write(laboratory.path("schedule.toml"), "schema = \"schedule/1\"\n").unwrap();
    let limited = fs::read_to_string(laboratory.path("dye.toml")).unwrap();
    fs::write(laboratory.path("dye.toml"), limited + "\n[safety]\nmax_ml_per_day = 900.0\n").unwrap();
    let service = laboratory.serve(&[]);
    have_wait(&service);
    service.dose("dye", "800mL", &json!({"rate": "0.5mL/s"}));
    service.moves("dye");
    let add = |pump: &str, hour: usize, keys: Value| {
        let mut entry =
            json!({"name": format!("{pump}-{hour}"), "pump": pump, "at": [format!("{hour:02}:00")]});
        entry.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
        service.edit("POST", "", &entry, &tag(&service))
    };
    let wrong = [
        (json!({"dose": "2mL", "options": {"rats": "1mL/s"}}), "options", "rats"),
        (json!({"dose": "2mL", "options": {"rate": "900mL/s"}}), "options", "60.4"),
        (json!({"dose": "900000L"}), "dose", "900000000"),
        (json!({"dose": "900000L", "options": {"smooth": true}}), "dose", "900000000"),
        (json!({"prime": "900000L"}), "prime", "900000000"),
    ];
    for pump in WAITING {
        for (keys, key, words) in &wrong {
            let (status, refused) = add(pump, 1, keys.clone());
            let message = refused["message"].as_str().unwrap_or_default();
            assert_eq!((status, &refused["key"]), (422, &json!(key)), "{pump} {keys}: {refused}");
            assert!(message.contains(words), "{pump} {keys}: {message}");
        }
        let (status, made) = add(pump, 2, json!({"dose": "25mL", "options": {"rate": "5mL/s"}}));
        assert_eq!(status, 201, "{pump}: {made}");
    }
    // A volume beyond the limit of a day is never made; one beyond what is left of today is, tomorrow.
    let batch = json!({"dose": "400mL", "batch": {"repeat": 3, "every": "1h"}});
    for (keys, key) in [(json!({"dose": "950mL"}), "dose"), (batch, "batch")] {
        let (status, refused) = add("dye", 3, keys);
        assert_eq!((status, &refused["key"]), (422, &json!(key)), "{refused}");
        assert!(refused["message"].as_str().unwrap().contains("900 mL"), "{refused}");
    }
    let (status, made) = add("dye", 4, json!({"dose": "850mL"}));
    assert_eq!(status, 201, "{made}");
    // 0.3 s is too short from 0 deg, and long enough from 40 deg.
    for (hour, within, taken) in [(5, "0.3s", 201), (6, "0.1s", 422)] {
        let (status, told) = add("dye", hour, json!({"dose": "3mL", "options": {"within": within}}));
        assert_eq!(status, taken, "{within}: {told}");
    }
    for pump in WAITING {
        let view = service.get(&format!("/api/v1/pumps/{pump}")).1;
        assert_eq!(view["order"].is_string(), pump == "dye", "nothing changed: {view}");
    }
}

#[test]
fn a_doubt_at_the_begin_of_a_service_is_there_whatever_its_pump_waits_for_and_stays() {
    let laboratory = Laboratory::new(&WAITING, "[service]\nschedule = \"schedule.toml\"\n");
    let file = laboratory.path("schedule.toml");
    fs::write(&file, "schema = \"schedule/1\"\n").unwrap();
    let mut service = laboratory.serve(&[]);
    have_wait(&service);
    assert_eq!(service.end(), Some(0));
    let slow = ["200mL", "--pump", "dye", "--rate", "0.5mL/s", "--no-service", "--pace", "real"];
    let mut moving = laboratory.dose(&slow).spawn().unwrap();
    wait_for("the pump to be in use", || (!laboratory.status("dye")["in_use_by"].is_null()).then_some(()));
    let mut text = "schema = \"schedule/1\"\n".to_owned();
    for (hour, pump) in WAITING.into_iter().enumerate() {
        for (name, minute, dose) in [
            ("right", 0, "dose = \"2mL\""),
            ("rats", 10, "dose = \"2mL\"\noptions = { rats = \"1\" }"),
            ("much", 20, "dose = \"900000L\""),
            ("fast", 30, "dose = \"2mL\"\noptions = { rate = \"900mL/s\" }"),
        ] {
            text += &format!(
                "[[entry]]\nname = \"{pump}-{name}\"\npump = \"{pump}\"\n{dose}\nat = \"0{hour}:{minute:02}\"\n"
            );
        }
    }
    fs::write(&file, &text).unwrap();
    let mut service = laboratory.serve_again(&service);
    let doubts = |service: &Service| {
        service.get("/api/v1/notes").1.to_string().matches("dye-fast: its runs will be refused").count()
    };
    wait_for("the first trials", || (doubts(&service) > 0).then_some(()));
    assert_eq!(service.end(), Some(0));
    let service = laboratory.serve_again(&service);
    let doubted = || -> Vec<String> {
        let next = service.get("/api/v1/schedule").1["next"].clone();
        let doubted = next.as_array().unwrap().iter().filter(|next| next["doubt"].is_string());
        doubted.map(|next| next["entry"].as_str().unwrap().to_owned()).collect()
    };
    let wrong = ["rats", "much", "fast"];
    let wrong: Vec<String> =
        WAITING.iter().flat_map(|pump| wrong.map(|name| format!("{pump}-{name}"))).collect();
    assert_eq!(wait_for("the trials", || Some(doubted()).filter(|found| !found.is_empty())), wrong);

    // A file that is read anew has its doubts until a trial takes them away.
    fs::write(&file, format!("{text}# A word more.\n")).unwrap();
    let notes = || service.get("/api/v1/notes").1.to_string();
    wait_for("the new file", || {
        assert_eq!(doubted(), wrong, "no doubt goes away meanwhile");
        notes().contains("was read anew").then_some(())
    });
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert_eq!(doubted(), wrong);
    assert_eq!(doubts(&service), 1, "a doubt is told once, over a restart too");
    fs::write(&file, text.replace("rats = ", "smooth = ").replace("\"1\"", "true")).unwrap();
    wait_for("the mended entries", || (doubted().len() == 6).then_some(()));
    moving.kill().unwrap();
    moving.wait().unwrap();
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
