//! A year of a rich schedule, against a sweep of the year minute by minute.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod sweep;

use pump_service::schedule::{Schedule, Shift, TimeZone, Timestamp};
use sweep::{Days, Rule, Sweep, minute_of};

const EVERY_DAY: Days = Days { week: [true; 7], dates: &[] };
const WORKDAYS: Days = Days { week: [true, true, true, true, true, false, false], dates: &[] };
const SUNDAYS: Days = Days { week: [false, false, false, false, false, false, true], dates: &[] };
/// The days of the changes of 2026 in the three zones that have them, and a day without.
const CHANGES: Days = Days {
    week: [false; 7],
    dates: &[
        "2026-03-08",
        "2026-03-29",
        "2026-04-05",
        "2026-10-04",
        "2026-10-25",
        "2026-11-01",
        "2026-12-24",
    ],
};

/// Entries of each zone: their keys in the file, and the same rules for the sweep.
fn entries() -> Vec<(&'static str, Rule)> {
    let at = |times: &'static [u16], days| Rule::At { times, days, from: None, until: None };
    vec![
        ("at = [\"06:00\", \"18:00\"]", at(&[360, 1080], EVERY_DAY)),
        (
            "at = [\"02:30\", \"02:00\", \"03:00\", \"02:15\", \"01:45\"]",
            at(&[105, 120, 135, 150, 180], EVERY_DAY),
        ),
        ("at = [\"01:00\", \"01:30\", \"01:59\"]\ndays = [\"sun\"]", at(&[60, 90, 119], SUNDAYS)),
        (
            "at = \"00:00\"\ndays = [\"mon\", \"tue\", \"wed\", \"thu\", \"fri\"]\nfrom = \"2026-02-10\"\n\
             until = \"2026-10-30\"",
            Rule::At { times: &[0], days: WORKDAYS, from: Some("2026-02-10"), until: Some("2026-10-30") },
        ),
        (
            "at = [\"02:10\", \"23:59\"]\ndates = [\"2026-03-08\", \"2026-03-29\", \"2026-04-05\", \
             \"2026-10-04\", \"2026-10-25\", \"2026-11-01\", \"2026-12-24\"]",
            at(&[130, 1439], CHANGES),
        ),
        (
            "every = \"30min\"\nbetween = [\"08:00\", \"20:00\"]",
            Rule::Window { every: 30, between: [480, 1200], days: EVERY_DAY },
        ),
        (
            "every = \"7min\"\nbetween = [\"00:05\", \"04:00\"]",
            Rule::Window { every: 7, between: [5, 240], days: EVERY_DAY },
        ),
        (
            "every = \"40min\"\nbetween = [\"02:10\", \"02:50\"]\ndays = \"sun\"",
            Rule::Window { every: 40, between: [130, 170], days: SUNDAYS },
        ),
        (
            "every = \"10min\"\nbetween = [\"01:30\", \"23:00\"]\ndays = [\"fri\", \"mon\", \"tue\", \"wed\", \
             \"thu\"]",
            Rule::Window { every: 10, between: [90, 1380], days: WORKDAYS },
        ),
        (
            "every = \"8h\"\nanchor = \"2026-01-02 06:00\"",
            Rule::Interval { every: 480, anchor: "2026-01-02 06:00", from: None, until: None },
        ),
        (
            "every = \"90min\"\nanchor = \"2026-03-01 02:30\"\nfrom = \"2026-03-20\"\nuntil = \"2026-10-25\"",
            Rule::Interval {
                every: 90,
                anchor: "2026-03-01 02:30",
                from: Some("2026-03-20"),
                until: Some("2026-10-25"),
            },
        ),
        (
            "every = \"1min\"\nanchor = \"2026-01-02 00:00\"",
            Rule::Interval { every: 1, anchor: "2026-01-02 00:00", from: None, until: None },
        ),
    ]
}

fn schedule(zone: &str) -> Schedule {
    let mut text = format!("schema = \"schedule/1\"\nzone = \"{zone}\"\n");
    for (number, (keys, _)) in entries().iter().enumerate() {
        text += &format!("[[entry]]\nname = \"e{number}\"\npump = \"p{number}\"\ndose = \"1mL\"\n{keys}\n");
    }
    Schedule::read(&text, &TimeZone::UTC).unwrap()
}

fn instant(text: &str) -> Timestamp {
    text.parse().unwrap()
}

/// Compares the year of a zone, and returns the number of runs and of those that a change of the clock moved.
fn compare(zone: &str) -> (usize, usize) {
    let schedule = schedule(zone);
    let (after, until) = (instant("2026-01-01T12:00:00Z"), instant("2027-01-01T12:00:00Z"));
    let offsets = schedule.entry("e0").unwrap().zone().clone();
    let mut sweeps: Vec<Sweep> = entries().into_iter().map(|(_, rule)| Sweep::new(rule)).collect();
    let mut due = schedule.due(after, until);
    let (mut runs, mut shifted) = (0, 0);
    let local = |minute: i64| {
        let now = Timestamp::from_second(minute * 60).unwrap();
        minute + i64::from(offsets.to_offset(now).seconds()) / 60
    };
    // The sweep begins two days earlier, to know the windows that are open.
    let compared = after.as_second() / 60;
    let first = compared - 2880;
    // The highest time that the clock has shown.
    let mut shown = local(first);
    for minute in first + 1..=until.as_second() / 60 {
        let now = local(minute);
        for (number, sweep) in sweeps.iter_mut().enumerate() {
            if sweep.runs(minute, shown, now) && minute > compared {
                let run = due.next().expect("the sweep has a run");
                assert_eq!(
                    run.planned,
                    Timestamp::from_second(minute * 60).unwrap(),
                    "{zone} {number}: {run}"
                );
                assert_eq!(run.entry.name(), format!("e{number}"), "{zone}: {run}");
                runs += 1;
                shifted += usize::from(run.shift.is_some());
            }
        }
        shown = shown.max(now);
    }
    assert_eq!(due.next(), None, "{zone}");
    (runs, shifted)
}

#[test]
fn a_year_in_berlin_runs_as_the_sweep_does() {
    let (runs, shifted) = compare("Europe/Berlin");
    assert!(runs > 500_000 && shifted >= 4, "{runs} runs, {shifted} shifted");
}

#[test]
fn a_year_in_new_york_runs_as_the_sweep_does() {
    let (runs, shifted) = compare("America/New_York");
    assert!(runs > 500_000 && shifted >= 4, "{runs} runs, {shifted} shifted");
}

#[test]
fn a_year_on_lord_howe_whose_change_is_half_an_hour_runs_as_the_sweep_does() {
    let (runs, shifted) = compare("Australia/Lord_Howe");
    assert!(runs > 500_000 && shifted >= 4, "{runs} runs, {shifted} shifted");
}

#[test]
fn a_year_in_kathmandu_which_has_no_change_runs_as_the_sweep_does() {
    let (runs, shifted) = compare("Asia/Kathmandu");
    assert!(runs > 500_000 && shifted == 0, "{runs} runs, {shifted} shifted");
}

#[test]
fn the_changes_of_the_clock_are_told() {
    let schedule = schedule("Europe/Berlin");
    let spring: Vec<_> = schedule
        .due(instant("2026-03-28T12:00:00Z"), instant("2026-03-29T12:00:00Z"))
        .filter(|due| due.entry.name() == "e1")
        .collect();
    // 02:00, 02:15, 02:30 and 03:00 are one instant, and one run.
    assert_eq!(spring.len(), 2);
    assert!(matches!(spring[1].shift, Some(Shift::Gap { .. })));
    assert_eq!(
        spring[1].to_string(),
        "e1 at 2026-03-29 03:00:00 +02 (02:00 does not exist on 2026-03-29; the run comes at the first instant \
         after the gap)"
    );
    let autumn: Vec<String> = schedule
        .due(instant("2026-10-24T12:00:00Z"), instant("2026-10-25T12:00:00Z"))
        .filter(|due| due.entry.name() == "e1")
        .map(|due| due.to_string())
        .collect();
    assert_eq!(
        autumn[1],
        "e1 at 2026-10-25 02:00:00 +02 (the clock shows this time again at 2026-10-25T01:00:00Z; the run comes \
         once, the first time)"
    );
    assert_eq!(autumn.len(), 5);
}

#[test]
fn the_sweep_knows_the_calendar() {
    assert_eq!(minute_of("1970-01-01 00:00"), 0);
    assert_eq!(minute_of("2026-03-29 02:30") * 60, instant("2026-03-29T02:30:00Z").as_second());
}
