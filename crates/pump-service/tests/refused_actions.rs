//! The text of every refusal of what an entry does, and of the file around the entries.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_service::schedule::{Schedule, TimeZone};

fn refusal(text: &str) -> String {
    Schedule::read(&format!("schema = \"schedule/1\"\n{text}"), &TimeZone::UTC).expect_err(text).to_string()
}

/// Refusal of an entry with these keys.
fn of_entry(keys: &str) -> String {
    let text = refusal(&format!("[[entry]]\nname = \"night\"\nat = \"06:30\"\n{keys}\n"));
    text.strip_prefix("entry `night` of the schedule, ").expect(&text).to_owned()
}

#[test]
fn an_entry_does_one_thing() {
    for (keys, told) in [
        ("", "what it does is missing; allowed: one of dose, prime, rack; add it"),
        (
            "pump = \"a\"\ndose = \"1mL\"\nprime = \"1mL\"",
            "dose is `beside prime`; allowed: one of dose, prime, rack; make an entry of each",
        ),
        ("dose = \"1mL\"", "pump is missing; allowed: name of a pump, as in the configuration; add it"),
        (
            "rack = \"mix\"\npump = \"a\"",
            "pump is `beside rack`; allowed: pump beside dose or prime; take pump out: the rack names its pumps",
        ),
        (
            "rack = \"mix\"\nbatch = { repeat = 2 }",
            "batch is `beside rack`; allowed: batch beside dose; take it out",
        ),
        (
            "pump = \"a\"\ndose = 25",
            "dose is `25`; allowed: a text of one line; write it in quotes, as \"25mL\"",
        ),
        (
            "pump = \" \"\ndose = \"1mL\"",
            "pump is ` `; allowed: a text of one line; write one, as \"ph-down\"",
        ),
    ] {
        assert_eq!(of_entry(keys), told, "{keys}");
    }
}

#[test]
fn a_wrong_batch_is_refused_with_its_value() {
    let number = "allowed: whole numbers from 1 to 100000";
    for (batch, told) in [
        (
            "20",
            "batch is `20`; allowed: a table, as { repeat = 20, every = \"30s\" }; write the number of its doses, \
             and their times if they have some"
                .to_owned(),
        ),
        ("{ every = \"30s\" }", format!("repeat of batch is missing; {number}; add it")),
        ("{ repeat = 0 }", format!("repeat of batch is `0`; {number}; write it without quotes, as 20")),
        ("{ repeat = \"2\" }", format!("repeat of batch is `2`; {number}; write it without quotes, as 20")),
        (
            "{ repeat = 2, each = 1 }",
            "`each of batch` is an unknown key; allowed: repeat, every; correct its spelling or take it out".to_owned(),
        ),
        (
            "{ repeat = 2, every = \"0s\" }",
            "every of batch is `0s`; allowed: 1s to 1d in whole seconds, with a unit of s, min, h, d; write a \
             number and its unit, as 30min"
                .to_owned(),
        ),
    ] {
        assert_eq!(of_entry(&format!("pump = \"a\"\ndose = \"1mL\"\nbatch = {batch}")), told, "{batch}");
    }
}

#[test]
fn a_wrong_option_is_refused_with_its_value() {
    for (options, told) in [
        (
            "\"fast\"",
            "options is `fast`; allowed: a table, as { rate = \"5mL/s\", smooth = true }; write the options in \
             braces",
        ),
        (
            "{ rate = 5 }",
            "rate of options is `5`; allowed: a text, true; write a value in quotes with its unit, or true for an \
             option without one",
        ),
        (
            "{ --rate = \"5mL/s\" }",
            "options is `--rate`; allowed: names of a-z, 0-9 and -; write the option's name without dashes before it",
        ),
        (
            "{ unfinished = \"ask\" }",
            "options is `unfinished`; allowed: options of a motion that are no keys of the entry; write the key \
             unfinished of the entry",
        ),
        (
            "{ repeat = \"3\" }",
            "options is `repeat`; allowed: options of a motion that are no keys of the entry; write the key batch of \
             the entry",
        ),
        (
            "{ dry-run = true }",
            "options is `dry-run`; allowed: options of a motion that are no keys of the entry; take it out: a run \
             with it moves nothing",
        ),
    ] {
        assert_eq!(
            of_entry(&format!("pump = \"a\"\ndose = \"1mL\"\noptions = {options}")),
            told,
            "{options}"
        );
    }
}

#[test]
fn the_file_around_the_entries_is_checked() {
    let dose = "pump = \"a\"\ndose = \"1mL\"\nat = \"06:30\"\n";
    for (text, told) in [
        (
            "entries = 1".to_owned(),
            "schedule, `entries` is an unknown key; allowed: schema, zone, entry; correct its spelling or take it \
             out",
        ),
        (
            "entry = 1".to_owned(),
            "schedule, entry is `1`; allowed: 1000 tables [[entry]] at most; write each entry below a line [[entry]]",
        ),
        (
            format!("[[entry]]\n{dose}"),
            "entry 1 of the schedule, name is missing; allowed: 1 to 64 of a-z, 0-9, - and _; add it",
        ),
        (
            format!("[[entry]]\nname = \"pH down\"\n{dose}"),
            "entry 1 of the schedule, name is `pH down`; allowed: 1 to 64 of a-z, 0-9, - and _; write a name as \
             ph-down",
        ),
        (
            format!("[[entry]]\nname = \"one\"\n{dose}[[entry]]\nname = \"one\"\n{dose}"),
            "entry 2 of the schedule, name is `one`; allowed: a name that no other entry has, and entry 1 has it; \
             rename one of them",
        ),
        (
            format!("[[entry]]\nname = \"one\"\n{dose}[[entry]]\nname = \"two\"\n{dose}"),
            "entry `two` of the schedule, at is `06:30`; allowed: times at which entry `one` does not move the same \
             pump; write another time, or busy = \"wait\"",
        ),
        (
            format!("[[entry]]\nname = \"one\"\n{dose}speed = 1"),
            "entry `one` of the schedule, `speed` is an unknown key; allowed: name, enabled, pump, dose, batch, \
             prime, rack, options, at, every, between, anchor, days, dates, from, until, zone, missed, \
             missed_within, unfinished, busy; correct its spelling or take it out",
        ),
    ] {
        assert_eq!(refusal(&text), told, "{text}");
    }
    let refused = |text: &str| Schedule::read(text, &TimeZone::UTC).unwrap_err().to_string();
    assert_eq!(refused("zone = \"UTC\""), "schedule, schema is missing; allowed: schedule/1; add it");
    assert_eq!(
        refused("schema = \"schedule/2\""),
        "schedule, schema is `schedule/2`; allowed: schedule/1; this program reads no other schema"
    );
    let broken = refused("schema = \"schedule/1\"\nzone = 06:99:00");
    assert!(broken.starts_with("the schedule is not TOML: TOML parse error at line 2"), "{broken}");
}

#[test]
fn entries_of_one_pump_that_do_not_meet_are_allowed() {
    let two = |one: &str, two: &str| {
        let dose = "pump = \"a\"\ndose = \"1mL\"\nat = \"06:30\"\n";
        let text = format!(
            "schema = \"schedule/1\"\n[[entry]]\nname = \"one\"\n{dose}{one}\n[[entry]]\nname = \"two\"\n{dose}{two}\n"
        );
        Schedule::read(&text, &TimeZone::UTC).is_ok()
    };
    assert!(!two("", ""));
    assert!(!two("days = \"mon\"", "dates = \"2026-03-02\""));
    assert!(!two("until = \"2026-03-03\"", "from = \"2026-03-03\""));
    assert!(two("", "busy = \"wait\""));
    assert!(two("enabled = false", ""));
    assert!(two("", "zone = \"Asia/Kathmandu\""));
    assert!(two("days = \"mon\"", "days = \"tue\""));
    assert!(two("days = \"mon\"", "dates = \"2026-03-03\""));
    assert!(two("until = \"2026-03-03\"", "from = \"2026-03-04\""));
}
