//! The text of every refusal.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_service::schedule::{Place, Schedule, ScheduleError, TimeZone};

const DOSE: &str = "[[entry]]\nname = \"night\"\npump = \"ph-down\"\ndose = \"25mL\"\n";

fn refusal(text: &str) -> ScheduleError {
    Schedule::read(text, &TimeZone::UTC).expect_err(text)
}

/// Refusal of an entry of a dose with these keys.
fn of_entry(keys: &str) -> String {
    let error = refusal(&format!("schema = \"schedule/1\"\n{DOSE}{keys}\n"));
    assert_eq!(error.place(), Some(&Place::Entry("night".to_owned())), "{error}");
    error.to_string()
}

fn assert_refused(cases: &[(&str, &str)]) {
    for (keys, told) in cases {
        assert_eq!(of_entry(keys), format!("entry `night` of the schedule, {told}"), "{keys}");
    }
}

#[test]
fn an_hour_of_one_digit_is_an_hour_and_a_blank_name_is_missing() {
    let text = |at: &str| format!("schema = \"schedule/1\"\n{DOSE}at = \"{at}\"\n");
    let [short, long] = ["3:30", "03:30"].map(|at| Schedule::read(&text(at), &TimeZone::UTC).unwrap());
    assert_eq!(short, long);
    for blank in ["", " "] {
        let told = refusal(&text("03:30").replace("\"night\"", &format!("\"{blank}\""))).to_string();
        assert!(told.contains("name is missing; allowed: 1 to 64 of a-z, 0-9, - and _; add it"), "{told}");
    }
}

#[test]
fn a_wrong_time_of_day_is_refused_with_its_value() {
    let time = "allowed: 00:00 to 23:59:59; write a time of day as 06:30";
    for wrong in ["25:00", "24:00", "6:3", "06:60", "06:30:60", "06:30:00.5", "noon", "06", "-6:30", "06:30Z"]
    {
        let told = format!("at is `{wrong}`; {time}");
        assert_refused(&[(&format!("at = \"{wrong}\""), &told)]);
    }
    assert_refused(&[
        ("at = []", "at is `[]`; allowed: one or more, as [\"06:30\"]; write one or take the key out"),
        ("at = 630", "at is `630`; allowed: a text of one line; write it in quotes, as \"06:30\""),
        ("at = [\"06:30\", \"06:30:00\"]", "at is `06:30:00`; allowed: each time once; take one of them out"),
        (
            "between = [\"08:00\", \"20:00\"]\nat = \"06:30\"",
            "between is `beside at`; allowed: at; every with between; every with anchor; take one of them out",
        ),
        ("", "its time is missing; allowed: at; every with between; every with anchor; add it"),
    ]);
}

#[test]
fn wrong_days_and_dates_are_refused_with_their_value() {
    let dates = "allowed: days that the calendar has, of the years 1970 to 2199; write it as 2026-03-01";
    for wrong in
        ["2026-02-30", "2026-2-3", "1969-12-31", "2200-01-01", "tomorrow", "2026-13-01", "2025-02-29"]
    {
        assert_refused(&[
            (&format!("at = \"06:30\"\ndates = \"{wrong}\""), &format!("dates is `{wrong}`; {dates}")),
            (&format!("at = \"06:30\"\nfrom = \"{wrong}\""), &format!("from is `{wrong}`; {dates}")),
        ]);
    }
    assert_refused(&[
        (
            "at = \"06:30\"\ndays = [\"monday\"]",
            "days is `monday`; allowed: mon, tue, wed, thu, fri, sat, sun; write one of them",
        ),
        (
            "at = \"06:30\"\ndays = [\"mon\", \"mon\"]",
            "days is `mon`; allowed: each day once; take one of them out",
        ),
        (
            "at = \"06:30\"\ndates = [\"2026-03-01\", \"2026-03-01\"]",
            "dates is `2026-03-01`; allowed: each date once; take one of them out",
        ),
        (
            "at = \"06:30\"\ndays = \"mon\"\ndates = \"2026-03-01\"",
            "days is `beside dates`; allowed: days or dates; take one of them out",
        ),
        (
            "at = \"06:30\"\nfrom = \"2026-03-02\"\nuntil = \"2026-03-01\"",
            "until is `2026-03-01`; allowed: 2026-03-02, which is from, or later; write the first day as from, the \
             last as until",
        ),
    ]);
}

#[test]
fn a_wrong_interval_or_window_is_refused_with_its_value() {
    let every = "allowed: 1min to 366d in whole seconds, with a unit of s, min, h, d; write a number and its unit, \
                 as 30min";
    for wrong in ["0h", "0s", "59s", "367d", "8", "8 hours", "-8h", "1.0001s", "nanh"] {
        let keys = format!("every = \"{wrong}\"\nanchor = \"2026-03-01 06:00\"");
        assert_refused(&[(&keys, &format!("every is `{wrong}`; {every}"))]);
    }
    let same_day = "allowed: two times of the same day, the first before the second";
    let midnight =
        "make two entries of a window over midnight, which end at 23:59:59 and begin at 00:00".to_owned();
    let anchor = "allowed: a date and a time of day: days that the calendar has, of the years 1970 to 2199, and \
                  00:00 to 23:59:59; write it as 2026-03-01 06:30";
    assert_refused(&[
        (
            "every = \"1h\"\nbetween = [\"20:00\", \"08:00\"]",
            &format!("between is `20:00 to 08:00`; {same_day}; {midnight}"),
        ),
        (
            "every = \"1h\"\nbetween = [\"08:00\", \"08:00\"]",
            &format!("between is `08:00 to 08:00`; {same_day}; {midnight}"),
        ),
        (
            "every = \"1h\"\nbetween = [\"08:00\"]",
            &format!("between is `[\"08:00\"]`; {same_day}; write them as [\"08:00\", \"20:00\"]"),
        ),
        (
            "every = \"1h\"\nbetween = [\"08:00\", \"24:00\"]",
            "between is `24:00`; allowed: 00:00 to 23:59:59; write a time of day as 06:30",
        ),
        ("every = \"1h\"\nanchor = \"2026-02-30 06:00\"", &format!("anchor is `2026-02-30 06:00`; {anchor}")),
        ("every = \"1h\"\nanchor = \"06:00\"", &format!("anchor is `06:00`; {anchor}")),
        (
            "every = \"1h\"",
            "between or anchor is missing; allowed: between beside every; anchor beside every; add it",
        ),
        (
            "every = \"1h\"\nbetween = [\"08:00\", \"20:00\"]\nanchor = \"2026-03-01 06:00\"",
            "between is `beside anchor`; allowed: at; every with between; every with anchor; take one of them out",
        ),
        (
            "every = \"1h\"\nanchor = \"2026-03-01 06:00\"\ndays = \"mon\"",
            "days is `beside anchor`; allowed: at; every with between; every with anchor; take it out, or write \
             between in place of anchor",
        ),
    ]);
}

#[test]
fn a_wrong_zone_is_refused_with_the_name_that_was_meant() {
    assert_refused(&[
        (
            "at = \"06:30\"\nzone = \"Berlin\"",
            "zone is `Berlin`; allowed: names of the IANA time zone database; did you mean Europe/Berlin?",
        ),
        (
            "at = \"06:30\"\nzone = \"New York\"",
            "zone is `New York`; allowed: names of the IANA time zone database; did you mean America/New_York?",
        ),
        (
            "at = \"06:30\"\nzone = \"Mars/Olympus\"",
            "zone is `Mars/Olympus`; allowed: names of the IANA time zone database; write a place of the zone, as \
             Europe/Berlin",
        ),
    ]);
    assert_eq!(
        refusal("schema = \"schedule/1\"\nzone = \"Lord_Howe\"").to_string(),
        "schedule, zone is `Lord_Howe`; allowed: names of the IANA time zone database; did you mean \
         Australia/Lord_Howe?"
    );
}

#[test]
fn a_wrong_policy_is_refused_with_its_choices() {
    assert_refused(&[
        ("at = \"06:30\"\nmissed = \"now\"", "missed is `now`; allowed: skip, once, all; write one of them"),
        (
            "at = \"06:30\"\nmissed = \"all\"",
            "missed_within is missing; allowed: 1min to 7d, how late a missed run may begin; add it",
        ),
        (
            "at = \"06:30\"\nmissed_within = \"2h\"",
            "missed_within is `beside missed = skip`; allowed: missed = once or all beside it; take it out, or \
             choose which missed runs are made up for",
        ),
        (
            "at = \"06:30\"\nmissed = \"once\"\nmissed_within = \"8d\"",
            "missed_within is `8d`; allowed: 1min to 7d in whole seconds, with a unit of s, min, h, d; write a \
             number and its unit, as 30min",
        ),
        (
            "at = \"06:30\"\nunfinished = \"yes\"",
            "unfinished is `yes`; allowed: ask, resume, accept; write one of them",
        ),
        ("at = \"06:30\"\nbusy = \"queue\"", "busy is `queue`; allowed: skip, wait; write one of them"),
        (
            "at = \"06:30\"\nenabled = \"no\"",
            "enabled is `no`; allowed: true, false; write one of them without quotes",
        ),
    ]);
}
