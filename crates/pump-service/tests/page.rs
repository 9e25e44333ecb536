//! The page docs/schedule.md: its examples, its keys and its refusal.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;

use pump_service::schedule::{Action, IfMissed, Schedule, Setting, TimeZone};

const PAGE: &str = include_str!("../../../docs/schedule.md");

/// Text of each block of TOML.
fn examples() -> Vec<&'static str> {
    PAGE.split("```toml\n").skip(1).map(|rest| rest.split_once("```").unwrap().0).collect()
}

fn read(text: &str) -> Schedule {
    Schedule::read(text, &TimeZone::UTC).unwrap()
}

/// Names in the first column of the table below a heading.
fn first_column(heading: &str) -> BTreeSet<&'static str> {
    let part = PAGE.split_once(heading).unwrap().1.split("\n## ").next().unwrap();
    part.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`')).map(|(name, _)| name).collect()
}

#[test]
fn the_examples_are_read_as_the_page_says() {
    let [one, two] = examples().try_into().unwrap();
    let workdays = read(one);
    let entry = workdays.entry("ph-down").unwrap();
    assert_eq!((entry.missed(), entry.missed_within().unwrap().seconds()), (IfMissed::Once, 7200));
    let feed = workdays.entry("feed").unwrap();
    assert_eq!(feed.options()["rate"], Setting::Text("0.5mL/s".to_owned()));
    assert_eq!(feed.options()["smooth"], Setting::On);
    let runs = |schedule: &Schedule, begin: &str, end: &str| {
        let runs = schedule.due(begin.parse().unwrap(), end.parse().unwrap());
        runs.map(|due| due.entry.name().to_owned()).collect::<Vec<_>>()
    };
    // A Friday and a Saturday: 25 runs of the window each, and two doses on the Friday alone.
    assert_eq!(runs(&workdays, "2026-03-06T00:00:00+01:00", "2026-03-07T00:00:00+01:00").len(), 27);
    assert_eq!(runs(&workdays, "2026-03-07T00:00:00+01:00", "2026-03-08T00:00:00+01:00").len(), 25);

    let sampler = read(two);
    let Action::Dose { batch: Some(batch), .. } = sampler.entry("sampler").unwrap().action() else {
        panic!()
    };
    assert_eq!((batch.repeat, batch.every.as_ref().unwrap().seconds()), (20, 30));
    let day = runs(&sampler, "2026-03-02T00:00:00Z", "2026-03-03T00:00:00Z");
    assert_eq!(day, ["sampler", "mix", "sampler", "sampler"]);
    assert_eq!(runs(&sampler, "2026-05-31T21:59:59Z", "2027-01-01T00:00:00Z"), ["sampler"]);
}

#[test]
fn the_page_lists_every_key_of_an_entry() {
    let text = format!("{}speed = 1\n", examples()[0]);
    let refused = Schedule::read(&text, &TimeZone::UTC).unwrap_err();
    let keys: BTreeSet<&str> = refused.allowed().unwrap().split(", ").collect();
    assert_eq!(first_column("## Keys of an entry"), keys);
}

#[test]
fn the_refusal_on_the_page_is_the_refusal() {
    let text = examples()[0].replace("\"06:00\"", "\"25:00\"");
    let refused = Schedule::read(&text, &TimeZone::UTC).unwrap_err().to_string();
    let shown = PAGE.split_once("```text\n").unwrap().1.split_once("\n```").unwrap().0;
    assert_eq!(shown, refused);
}

#[test]
fn an_example_that_is_written_is_read_as_it_was() {
    for example in examples() {
        let schedule = read(example);
        assert_eq!(read(&toml::to_string(&schedule).unwrap()), schedule);
    }
    let written = serde_json::to_value(read(examples()[1])).unwrap();
    assert_eq!(written["schema"], "schedule/1");
    assert_eq!(written["entry"][0]["anchor"], "2026-03-01 06:00");
    assert_eq!(written["entry"][0]["batch"]["repeat"], 20);
    assert_eq!(written["entry"][2]["enabled"], false);
}

#[test]
fn the_machines_zone_is_that_of_entries_that_name_none() {
    let text = examples()[0].replace("zone = \"Europe/Berlin\"\n", "");
    let there = examples()[0].replace("Europe/Berlin", "Asia/Kathmandu");
    let machine = read(&there).entry("feed").unwrap().zone().clone();
    assert_eq!(Schedule::read(&text, &machine).unwrap().entry("feed").unwrap().zone(), &machine);
}

#[test]
fn dates_and_times_of_toml_itself_are_read_as_their_texts() {
    let entry = "schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"p\"\ndose = \"1mL\"\n";
    let quoted = read(&format!("{entry}at = \"06:30:15\"\ndates = [\"2026-03-01\"]\n"));
    assert_eq!(read(&format!("{entry}at = 06:30:15\ndates = [2026-03-01]\n")), quoted);
    let quoted = read(&format!("{entry}every = \"8h\"\nanchor = \"2026-03-01 06:30\"\n"));
    assert_eq!(read(&format!("{entry}every = \"8h\"\nanchor = 2026-03-01T06:30:00\n")), quoted);
}
