//! Doses that come by the clock of the service.

use std::fs;

use pump_service::schedule::{TimeZone, Timestamp};
use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, wait_for};

/// The time of day `in_s` seconds from now, UTC.
fn soon(in_s: i64) -> String {
    let at = Timestamp::from_second(Timestamp::now().as_second() + in_s).unwrap();
    TimeZone::UTC.to_datetime(at).strftime("%H:%M:%S").to_string()
}

#[test]
fn a_dose_comes_by_the_clock_once() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    let entry = |name: &str, at: &str, more: &str| {
        format!("[[entry]]\nname = \"{name}\"\npump = \"acid\"\ndose = \"2mL\"\nat = \"{at}\"\n{more}\n")
    };
    let text = "schema = \"schedule/1\"\nzone = \"UTC\"\n".to_owned();
    let text =
        text + &entry("now", &soon(4), "options = { rate = \"2mL/s\" }") + &entry("past", &soon(-600), "");
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let (_, shown) = service.get("/api/v1/schedule");
    assert_eq!(shown["next"].as_array().unwrap().len(), 2, "{shown}");
    wait_for("the dose of the schedule", || (!laboratory.log("acid").is_empty()).then_some(()));
    let (_, orders) = service.get("/api/v1/orders");
    assert_eq!(orders[0]["origin"], "schedule now", "{orders}");
    assert_eq!(orders[0]["options"]["rate"], "2mL/s");

    // A restart within the minute of the run does not repeat it, nor does it make up for the past.
    service.end();
    let service = laboratory.serve_again(&service);
    wait_for("some seconds of the schedule", || {
        let planned = service.get("/api/v1/schedule").1["next"][0]["at"].clone();
        planned.is_string().then_some(())
    });
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert_eq!(laboratory.log("acid").len(), 1);
    let (_, notes) = service.get("/api/v1/notes");
    assert!(notes.to_string().contains("now at "), "{notes}");
}

#[test]
fn an_entry_that_would_be_refused_at_night_is_told_at_once() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    // Entries of one pump at one time would be refused together.
    let entry = |hour: u32, what: &str| {
        let name = char::from_digit(10 + hour, 36).unwrap();
        format!("[[entry]]\nname = \"{name}\"\n{what}\nat = \"0{hour}:00\"\n")
    };
    let text = "schema = \"schedule/1\"\n".to_owned()
        + &entry(0, "pump = \"nope\"\ndose = \"2mL\"")
        + &entry(1, "pump = \"acid\"\ndose = \"5gal\"")
        + &entry(2, "rack = \"night\"")
        + &entry(3, "pump = \"acid\"\ndose = \"2mL\"")
        + &entry(4, "pump = \"acid\"\ndose = \"2mL\"\noptions = { rats = \"1mL/s\" }")
        + &entry(5, "pump = \"acid\"\ndose = \"2mL\"\noptions = { rate = \"900mL/s\" }")
        + &entry(6, "pump = \"acid\"\nprime = \"900000mL\"\nenabled = false");
    fs::write(laboratory.path("schedule.toml"), &text).unwrap();
    let service = laboratory.serve(&[]);
    let doubts = || {
        let next = service.get("/api/v1/schedule").1["next"].clone();
        let next = next.as_array().unwrap().iter();
        next.map(|next| next["doubt"].as_str().map(str::to_owned)).collect::<Vec<_>>()
    };
    let found = wait_for("the trials", || Some(doubts()).filter(|found| found.iter().any(Option::is_some)));
    let whys = [Some("nope"), Some("5gal"), Some("night"), None, Some("--rats"), Some("900"), None];
    let notes = service.get("/api/v1/notes").1.to_string();
    for (index, (found, why)) in found.iter().zip(whys).enumerate() {
        let name = char::from(b'a' + u8::try_from(index).unwrap());
        assert_eq!(found.is_some(), why.is_some(), "{name}: {found:?}");
        let words = format!("{name}: its runs will be refused: ");
        assert_eq!(notes.contains(&words), why.is_some(), "{name}: {notes}");
        if let (Some(found), Some(why)) = (found, why) {
            assert!(found.contains(why), "{name}: {found}");
            // A log of the service has the line too.
            wait_for("the line", || laboratory.said().contains(&format!("{words}{found}\n")).then_some(()));
        }
    }
    assert!(laboratory.log("acid").is_empty(), "nothing moved");
    let options = found[4].as_deref().unwrap();
    assert!(
        options.contains("allowed: rate, ") && !options.contains("repeat"),
        "those of an entry: {options}"
    );
    // An entry that is mended is in doubt no more.
    fs::write(laboratory.path("schedule.toml"), text.replace("rats", "rate")).unwrap();
    wait_for("the mended entry", || {
        let found = doubts();
        (found[4].is_none() && found[5].is_some()).then_some(())
    });
}

#[test]
fn a_doubt_comes_and_goes_with_the_files_that_its_trial_reads() {
    let more = "[racks]\nnight = \"night.toml\"\n[service]\nschedule = \"schedule.toml\"\n";
    let laboratory = Laboratory::new(&["acid", "base"], more);
    let text = "schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"acid\"\ndose = \"25mL\"\nat = \"03:00\"\n\
        options = { rate = \"50mL/s\" }\n[[entry]]\nname = \"b\"\nrack = \"night\"\nat = \"04:00\"\n\
        [[entry]]\nname = \"c\"\npump = \"base\"\ndose = \"5mL\"\nat = \"05:00\"\n";
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let service = laboratory.serve(&["--pace", "fast"]);
    let doubts = || {
        let next = service.get("/api/v1/schedule").1["next"].clone();
        next.as_array().unwrap().iter().map(|next| next["doubt"].is_string()).collect::<Vec<_>>()
    };
    let becomes = |what: &str, are: [bool; 3]| wait_for(what, || (doubts() == are).then_some(()));
    let notes = |name: &str| {
        let words = format!("{name}: its runs will be refused: ");
        service.get("/api/v1/notes").1.to_string().matches(&words).count()
    };
    becomes("the rack that is missing", [false, true, false]);
    let rack = "schema = \"rack/1\"\n[pumps]\nbase = \"base\"\n[[step]]\npump = \"base\"\nvolume = \"2mL\"\n";
    fs::write(laboratory.path("night.toml"), rack).unwrap();
    becomes("the rack", [false; 3]);
    let pump = fs::read_to_string(laboratory.path("acid.toml")).unwrap();
    let limited = |limit: &str| {
        let text = format!("{pump}\n[safety]\nmax_ml_per_day = {limit}\n");
        fs::write(laboratory.path("acid.toml"), text).unwrap();
    };
    limited("10.0");
    becomes("the limit that was lowered", [true, false, false]);
    // The trial leaves the record out, so it cannot say what was pumped.
    let doubt = service.get("/api/v1/schedule").1["next"][0]["doubt"].to_string();
    assert!(doubt.contains("mL were planned, and the limit of 24 h is 10 mL"), "{doubt}");
    limited("100.0");
    becomes("the limit that was raised", [false; 3]);
    let config = fs::read_to_string(laboratory.path("config.toml")).unwrap();
    fs::write(laboratory.path("config.toml"), format!("{config}[defaults]\nrate = \"900mL/s\"\n")).unwrap();
    becomes("the rate of the configuration", [false, false, true]);
    fs::write(laboratory.path("config.toml"), config).unwrap();
    becomes("the configuration as it was", [false; 3]);
    // A pump that delivers less has a lower largest rate.
    service.ended(&service.dose("acid", "20mL", &json!({"rate": "5mL/s"})));
    let weighed = json!({"reading": "15g", "options": {"anyway": true}});
    let (status, made) = service.post("/api/v1/pumps/acid/calibrate", &weighed);
    assert_eq!(status, 202, "{made}");
    let used = laboratory.run(&["calibrate", "use", "1", "--pump", "acid"]);
    assert_eq!(used.status.code(), Some(0), "{used:?}");
    becomes("the calibration", [true, false, false]);
    // An edit of another entry tells no doubt again.
    let edited = text.replace("\"5mL\"", "\"900000L\"");
    fs::write(laboratory.path("schedule.toml"), edited).unwrap();
    becomes("the edit", [true, false, true]);
    assert_eq!(["a", "b", "c"].map(notes), [2, 1, 2]);
}

#[test]
fn a_scheduled_dose_that_fails_after_its_begin_is_noted() {
    let laboratory = Laboratory::new(&["acid", "base"], "[service]\nschedule = \"schedule.toml\"\n");
    let at = soon(4);
    let entry = |pump: &str| {
        format!(
            "[[entry]]\nname = \"{pump}-night\"\npump = \"{pump}\"\ndose = \"40mL\"\nat = \"{at}\"\n\
             options = {{ rate = \"1mL/s\" }}\n"
        )
    };
    let text = "schema = \"schedule/1\"\nzone = \"UTC\"\n".to_owned() + &entry("acid") + &entry("base");
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let mut service = laboratory.serve(&[]);
    ["acid", "base"].into_iter().for_each(|pump| service.moves(pump));
    let failed = |service: &Service, pump: &str, why: &str| {
        let notes = service.get("/api/v1/notes").1;
        let is_it = |note: &&Value| {
            let text = note["text"].as_str().unwrap();
            note["pump"] == pump && text.starts_with(&format!("{pump}-night at ")) && text.contains(why)
        };
        notes.as_array().unwrap().iter().find(is_it).map(drop)
    };
    let (status, _) = service.post("/api/v1/pumps/acid/stop", &json!({"reason": "the hose is off"}));
    assert_eq!(status, 200);
    wait_for("the note of a stop", || failed(&service, "acid", ": failed: "));
    // The end of the service is told too, for the morning after.
    assert_eq!(service.end(), Some(0));
    assert!(laboratory.said().contains("schedule: base: base-night at "), "{}", laboratory.said());
    let service = laboratory.serve_again(&service);
    assert!(failed(&service, "base", ": failed: ").is_some(), "{}", service.get("/api/v1/notes").1);
}

#[test]
fn on_fail_hears_of_a_scheduled_dose_that_is_not_made_and_not_of_a_typing_error() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    laboratory.tell_failures();
    let text = format!(
        "schema = \"schedule/1\"\nzone = \"UTC\"\n[[entry]]\nname = \"a\"\npump = \"acid\"\n\
         dose = \"2mL\"\nat = \"{}\"\noptions = {{ rate = \"900mL/s\" }}\n",
        soon(5)
    );
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let service = laboratory.serve(&[]);
    let (status, refused) =
        service.post("/api/v1/pumps/acid/dose", &json!({"volume": "2mL", "options": {"rate": "800mL/s"}}));
    assert_eq!((status, &refused["code"]), (422, &json!(2)), "{refused}");
    assert!(laboratory.told().is_empty(), "{:?}", laboratory.told());
    wait_for("on_fail of the schedule", || (!laboratory.told().is_empty()).then_some(()));
    assert_eq!(laboratory.told(), [format!("acid 2 {}", refused["kind"].as_str().unwrap())]);
    let notes = service.get("/api/v1/notes").1.to_string();
    assert!(notes.contains(": not made: "), "{notes}");
}

#[test]
fn missed_runs_that_are_all_made_up_for_come_one_after_the_other() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    let times = [6, 7, 8].map(|in_s| format!("\"{}\"", soon(in_s))).join(", ");
    let text = format!(
        "schema = \"schedule/1\"\nzone = \"UTC\"\n[[entry]]\n\
         name = \"a\"\npump = \"acid\"\ndose = \"2mL\"\nat = [{times}]\n\
         missed = \"all\"\nmissed_within = \"1h\"\noptions = {{ rate = \"2mL/s\" }}\n"
    );
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let mut service = laboratory.serve(&[]);
    service.end();
    assert!(laboratory.log("acid").is_empty(), "the service ended before the first of them");
    std::thread::sleep(std::time::Duration::from_secs(9));
    let service = laboratory.serve_again(&service);
    wait_for("three doses that were missed", || (laboratory.log("acid").len() == 3).then_some(()));
    let (_, notes) = service.get("/api/v1/notes");
    assert!(!notes.to_string().contains("not made"), "{notes}");
}

#[test]
fn a_schedule_that_is_changed_is_read_anew_and_a_wrong_one_leaves_the_old_in_force() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    let file = laboratory.path("schedule.toml");
    let text =
        "schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"acid\"\ndose = \"2mL\"\nat = \"03:00\"\n";
    fs::write(&file, text).unwrap();
    let service = laboratory.serve(&[]);
    fs::write(&file, text.replace("03:00", "25:00")).unwrap();
    let told = |words: &str| {
        wait_for(words, || service.get("/api/v1/notes").1.to_string().contains(words).then_some(()));
    };
    told("at is `25:00`");
    let at = |service: &Service| service.get("/api/v1/schedule").1["schedule"]["entry"][0]["at"].to_string();
    assert!(at(&service).contains("03:00"));
    fs::write(&file, text.replace("03:00", "04:00")).unwrap();
    told("read anew");
    assert!(at(&service).contains("04:00"), "{}", at(&service));
}

#[test]
fn a_service_begins_with_a_refused_schedule_runs_nothing_of_it_says_so_and_takes_the_mended_file_up() {
    let laboratory = Laboratory::new(&["acid"], "[service]\nschedule = \"schedule.toml\"\n");
    let file = laboratory.path("schedule.toml");
    let entry = |name: &str, at: &str| {
        format!("[[entry]]\nname = \"{name}\"\npump = \"acid\"\ndose = \"2mL\"\nat = \"{at}\"\n")
    };
    let text = "schema = \"schedule/1\"\nzone = \"UTC\"\n".to_owned() + &entry("soon", &soon(3));
    fs::write(&file, text.clone() + &entry("wrong", "25:00")).unwrap();
    let service = laboratory.serve(&["--pace", "fast"]);
    let shown = service.get("/api/v1/schedule").1;
    let error = shown["error"].as_str().unwrap();
    assert!(error.contains("at is `25:00`") && error.contains("no entry runs until"), "{shown}");
    assert_eq!(shown["schedule"]["entry"], json!([]), "{shown}");
    assert!(service.get("/api/v1/notes").1.to_string().contains("at is `25:00`"));
    wait_for("the line", || laboratory.said().contains(error).then_some(()));
    let status = laboratory.run(&["status", "--pump", "acid"]);
    let said = String::from_utf8_lossy(&status.stderr).into_owned();
    assert!(status.status.success() && said == format!("warning: {error}\n"), "{said}");
    let add = json!({"name": "more", "pump": "acid", "dose": "1mL", "at": "03:00"});
    let (code, refused) = service.edit("POST", "", &add, &format!("{}", shown["etag"]));
    assert!(code == 409 && refused["message"].as_str().unwrap().contains("correct it first"), "{refused}");
    // The pumps are there for people.
    let id = service.dose("acid", "1mL", &json!({}));
    assert_eq!(service.ended(&id)["state"], "done");
    std::thread::sleep(std::time::Duration::from_secs(4));
    assert_eq!(laboratory.log("acid").len(), 1, "no entry has run");

    fs::write(&file, text + &entry("next", &soon(3))).unwrap();
    wait_for("the dose of the mended schedule", || (laboratory.log("acid").len() == 2).then_some(()));
    assert!(service.get("/api/v1/schedule").1["error"].is_null());
    assert!(laboratory.run(&["status", "--pump", "acid"]).stderr.is_empty());
}
