//! Random entries over random spans of time: a span that is cut has the same runs.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;

use proptest::prelude::*;
use pump_service::schedule::{Due, Schedule, TimeZone, Timestamp};

/// Zones with changes of an hour, half an hour, at midnight, of a whole day, and without.
const ZONES: [&str; 7] = [
    "Europe/Berlin",
    "America/New_York",
    "Australia/Lord_Howe",
    "Asia/Kathmandu",
    "Africa/Cairo",
    "America/Sao_Paulo",
    "Pacific/Apia",
];

/// A list of TOML.
fn list(texts: &BTreeSet<String>) -> String {
    format!("{:?}", texts.iter().collect::<Vec<_>>())
}

fn timing() -> impl Strategy<Value = String> {
    let time = (0..24, 0..60).prop_map(|(hour, minute)| format!("{hour:02}:{minute:02}"));
    let date =
        (2011..2027, 1..13, 1..29).prop_map(|(year, month, day)| format!("{year}-{month:02}-{day:02}"));
    let days = prop_oneof![
        Just(String::new()),
        Just("days = [\"mon\", \"sun\"]".to_owned()),
        prop::collection::btree_set(date.clone(), 1..9).prop_map(|dates| format!("dates = {}", list(&dates))),
        date.clone().prop_map(|from| format!("from = \"{from}\"")),
        date.clone().prop_map(|until| format!("until = \"{until}\"")),
    ];
    let every =
        prop_oneof![(1..600).prop_map(|n| format!("{n}min")), (60..9999).prop_map(|n| format!("{n}s"))];
    prop_oneof![
        (prop::collection::btree_set(time.clone(), 1..6), days.clone())
            .prop_map(|(times, days)| format!("at = {}\n{days}", list(&times))),
        (every.clone(), prop::collection::btree_set(time.clone(), 2), days).prop_map(
            |(every, window, days)| format!("every = \"{every}\"\nbetween = {}\n{days}", list(&window))
        ),
        (every, date, time)
            .prop_map(|(every, date, time)| format!("every = \"{every}\"\nanchor = \"{date} {time}\"")),
    ]
}

fn schedule() -> impl Strategy<Value = Schedule> {
    let entry = (timing(), prop::sample::select(&ZONES[..]));
    prop::collection::vec(entry, 1..6).prop_map(|entries| {
        let mut text = "schema = \"schedule/1\"\nzone = \"Europe/Berlin\"\n".to_owned();
        for (number, (timing, zone)) in entries.iter().enumerate() {
            text += &format!(
                "[[entry]]\nname = \"e{number}\"\npump = \"p{number}\"\ndose = \"1mL\"\nzone = \"{zone}\"\n{timing}\n"
            );
        }
        Schedule::read(&text, &TimeZone::UTC).unwrap()
    })
}

/// Three instants in their order, some days apart, with parts of a second.
fn instants() -> impl Strategy<Value = [Timestamp; 3]> {
    let begin = 1_293_000_000_000_i64..1_798_000_000_000;
    // Every second span begins near a change: of Samoa's day, of Cairo, or of Berlin.
    let begin = prop_oneof![
        begin,
        (-90_000_000..90_000_000_i64).prop_map(|off| 1_325_239_200_000 + off),
        (-90_000_000..90_000_000_i64).prop_map(|off| 1_682_632_800_000 + off),
        (-90_000_000..90_000_000_i64).prop_map(|off| 1_774_746_000_000 + off),
    ];
    let instant = |millis| Timestamp::from_millisecond(millis).unwrap();
    (begin, 0..300_000_000_i64, 0..300_000_000_i64)
        .prop_map(move |(begin, one, two)| [begin, begin + one, begin + one + two].map(instant))
}

fn names<'a>(runs: &[Due<'a>]) -> Vec<(&'a str, Timestamp)> {
    runs.iter().map(|due| (due.entry.name(), due.planned)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_span_that_is_cut_has_the_same_runs(schedule in schedule(), [a, b, c] in instants()) {
        let whole: Vec<Due<'_>> = schedule.due(a, c).collect();
        let parts: Vec<Due<'_>> = schedule.due(a, b).chain(schedule.due(b, c)).collect();
        prop_assert_eq!(&parts, &whole);
        // A run is cut off by its own instant too.
        if let Some(middle) = whole.get(whole.len() / 2).map(|due| due.planned) {
            let parts: Vec<Due<'_>> = schedule.due(a, middle).chain(schedule.due(middle, c)).collect();
            prop_assert_eq!(&parts, &whole);
        }
        prop_assert!(whole.iter().all(|due| due.planned > a && due.planned <= c));
        prop_assert!(whole.windows(2).all(|pair| pair[0].planned <= pair[1].planned));
        let mut known = names(&whole);
        known.dedup();
        prop_assert_eq!(known.len(), whole.len(), "an entry ran twice at one instant");
    }

    #[test]
    fn the_next_run_of_an_entry_is_its_first_that_is_due(schedule in schedule(), [a, _, c] in instants()) {
        for entry in schedule.entries() {
            let first = schedule.due(a, c).find(|due| due.entry.name() == entry.name());
            let next = schedule.next(entry.name(), a).filter(|due| due.planned <= c);
            prop_assert_eq!(next, first);
        }
    }

    #[test]
    fn a_schedule_that_is_written_is_read_as_it_was(schedule in schedule()) {
        let text = toml::to_string(&schedule).unwrap();
        prop_assert_eq!(Schedule::read(&text, &TimeZone::UTC).unwrap(), schedule);
    }

    #[test]
    fn no_text_panics(text in "\\PC*", key in "[a-z_]{1,9}") {
        let _ = Schedule::read(&text, &TimeZone::UTC);
        let head = "schema = \"schedule/1\"
[[entry]]
name = \"a\"
pump = \"p\"
dose = \"1mL\"";
        let entry = format!("{head}
{key} = {text:?}");
        let _ = Schedule::read(&entry, &TimeZone::UTC);
    }
}
