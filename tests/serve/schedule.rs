//! Doses that come by the clock of the service.

use std::fs;

use pump_service::schedule::{TimeZone, Timestamp};

use crate::laboratory::{Laboratory, wait_for};

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
    let entry = |name: &str, what: &str| format!("[[entry]]\nname = \"{name}\"\n{what}\nat = \"03:00\"\n");
    let text = "schema = \"schedule/1\"\n".to_owned()
        + &entry("a", "pump = \"nope\"\ndose = \"2mL\"")
        + &entry("b", "pump = \"acid\"\ndose = \"5gal\"")
        + &entry("c", "rack = \"night\"")
        + &entry("d", "pump = \"acid\"\ndose = \"2mL\"").replace("03:00", "05:00");
    fs::write(laboratory.path("schedule.toml"), text).unwrap();
    let service = laboratory.serve(&[]);
    let (_, notes) = service.get("/api/v1/notes");
    let told: Vec<&str> = notes.as_array().unwrap().iter().filter_map(|note| note["text"].as_str()).collect();
    for (entry, why) in [("a", "nope"), ("b", "5gal"), ("c", "no rack `night`")] {
        let words = format!("{entry}: its runs will be refused: ");
        assert!(told.iter().any(|text| text.starts_with(&words) && text.contains(why)), "{entry}: {told:?}");
    }
    assert!(!told.iter().any(|text| text.starts_with("d: ")), "{told:?}");
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
    let at = |service: &crate::laboratory::Service| {
        service.get("/api/v1/schedule").1["schedule"]["entry"][0]["at"].to_string()
    };
    assert!(at(&service).contains("03:00"));
    fs::write(&file, text.replace("03:00", "04:00")).unwrap();
    told("read anew");
    assert!(at(&service).contains("04:00"), "{}", at(&service));

    fs::write(&file, text.replace("03:00", "25:00")).unwrap();
    let refused = laboratory.run(&["serve", "--listen", "127.0.0.1:0", "--state-dir", "elsewhere"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("at is `25:00`; allowed"));
}
