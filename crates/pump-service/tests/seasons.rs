//! First and last days, and zones that leave out a day.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_service::schedule::{Schedule, TimeZone, Timestamp};

/// Runs of one entry with these keys, in UTC.
fn runs(keys: &str, after: &str, until: &str) -> Vec<String> {
    let text =
        format!("schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"p\"\ndose = \"1mL\"\n{keys}\n");
    let schedule = Schedule::read(&text, &TimeZone::UTC).unwrap();
    let runs = schedule.due(after.parse().unwrap(), until.parse().unwrap());
    runs.map(|due| due.planned.to_string()).collect()
}

#[test]
fn an_interval_begins_at_the_first_midnight_and_ends_before_the_last() {
    let keys =
        "every = \"12h\"\nanchor = \"2026-01-01 00:00\"\nfrom = \"2026-03-01\"\nuntil = \"2026-03-02\"";
    assert_eq!(
        runs(keys, "2026-01-01T00:00:00Z", "2027-01-01T00:00:00Z"),
        ["2026-03-01T00:00:00Z", "2026-03-01T12:00:00Z", "2026-03-02T00:00:00Z", "2026-03-02T12:00:00Z"]
    );
}

#[test]
fn an_interval_keeps_its_anchor_whatever_its_first_day_is() {
    let keys = "every = \"7h\"\nanchor = \"2026-02-28 00:00\"\nfrom = \"2026-03-01\"";
    let day = runs(keys, "2026-02-01T00:00:00Z", "2026-03-02T00:00:00Z");
    assert_eq!(day, ["2026-03-01T04:00:00Z", "2026-03-01T11:00:00Z", "2026-03-01T18:00:00Z"]);
}

#[test]
fn times_of_day_run_on_the_first_and_on_the_last_day() {
    let keys = "at = [\"00:00\", \"23:59:59\"]\nfrom = \"2026-03-01\"\nuntil = \"2026-03-01\"";
    let all = runs(keys, "2026-01-01T00:00:00Z", "2027-01-01T00:00:00Z");
    assert_eq!(all, ["2026-03-01T00:00:00Z", "2026-03-01T23:59:59Z"]);
}

#[test]
fn a_leap_day_is_a_day() {
    let all = runs("at = \"12:00\"\ndates = \"2028-02-29\"", "2026-01-01T00:00:00Z", "2030-01-01T00:00:00Z");
    assert_eq!(all, ["2028-02-29T12:00:00Z"]);
}

#[test]
fn the_runs_of_a_day_that_a_zone_leaves_out_are_one_run_at_the_begin_of_the_next() {
    // Samoa crossed the date line: after 2011-12-29 came 2011-12-31, at 10:00 UTC on the 30th (IANA, Pacific/Apia).
    let keys = "at = [\"06:00\", \"18:00\"]\nzone = \"Pacific/Apia\"";
    let days = runs(keys, "2011-12-29T12:00:00Z", "2011-12-31T12:00:00Z");
    let told = ["2011-12-29T16:00:00Z", "2011-12-30T04:00:00Z", "2011-12-30T10:00:00Z"];
    assert_eq!(days[..3], told);
    assert_eq!(days[3..], ["2011-12-30T16:00:00Z", "2011-12-31T04:00:00Z"]);
}

#[test]
fn a_gap_at_midnight_runs_at_one_oclock() {
    // Cairo, 2026-04-24: 00:00 does not exist (IANA, Africa/Cairo).
    let keys = "at = \"00:00\"\nzone = \"Africa/Cairo\"";
    let days = runs(keys, "2026-04-22T22:30:00Z", "2026-04-25T00:00:00Z");
    assert_eq!(days, ["2026-04-23T22:00:00Z", "2026-04-24T21:00:00Z"]);
}

#[test]
fn the_ends_of_time_are_no_panic() {
    for keys in [
        "at = \"06:00\"",
        "every = \"1h\"\nbetween = [\"01:00\", \"23:00\"]",
        "at = \"06:00\"\ndays = \"mon\"",
    ] {
        for zone in ["UTC", "Pacific/Apia", "America/New_York"] {
            let keys = format!("{keys}\nzone = \"{zone}\"");
            let text = format!(
                "schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"p\"\ndose = \"1mL\"\n{keys}\n"
            );
            let schedule = Schedule::read(&text, &TimeZone::UTC).unwrap();
            assert_eq!(schedule.due(Timestamp::MIN, Timestamp::MAX).take(100).count(), 100);
            assert_eq!(schedule.next("a", Timestamp::MAX), None);
            assert!(schedule.catch_up(|_| None, Timestamp::MIN, Timestamp::MAX).run.is_empty());
            assert!(schedule.catch_up(|_| None, Timestamp::MIN, Timestamp::MIN).run.is_empty());
        }
    }
    let interval = "every = \"1h\"\nanchor = \"2199-12-31 23:59\"";
    assert_eq!(runs(interval, "2199-12-31T00:00:00Z", "2200-01-01T00:00:00Z"), ["2199-12-31T23:59:00Z"]);
}
