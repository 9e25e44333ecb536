//! Missed runs, busy pumps, and clocks that are set back.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;

use pump_service::schedule::{Catchup, Schedule, TimeZone, Timestamp};

/// A schedule of one entry with these keys, in UTC.
fn schedule(keys: &str) -> Schedule {
    let text =
        format!("schema = \"schedule/1\"\n[[entry]]\nname = \"a\"\npump = \"p\"\ndose = \"1mL\"\n{keys}\n");
    Schedule::read(&text, &TimeZone::UTC).unwrap()
}

/// An instant of 2026-03-01, or of another day before it.
fn at(time: &str) -> Timestamp {
    let text = if time.len() > 8 { format!("{time}Z") } else { format!("2026-03-01T{time}Z") };
    text.parse().unwrap()
}

/// Times to run, and the number of missed runs with the first and the last.
fn told(catchup: &Catchup<'_>) -> (Vec<String>, Option<(u64, String, String)>) {
    let time = |instant: Timestamp| instant.strftime("%d %H:%M").to_string();
    let runs = catchup.run.iter().map(|due| time(due.planned)).collect();
    let missed = catchup.missed.first().map(|missed| (missed.count, time(missed.first), time(missed.last)));
    (runs, missed)
}

/// What the policy does at `now` if the runs up to `last` are on record, of an entry that runs every hour.
fn hourly(policy: &str, last: &str, now: &str) -> (Vec<String>, Option<(u64, String, String)>) {
    let schedule = schedule(&format!("every = \"1h\"\nanchor = \"2026-02-01 00:00\"\n{policy}"));
    told(&schedule.catch_up(|_| Some(at(last)), at("2026-02-01T00:00:00"), at(now)))
}

fn missed(count: u64, first: &str, last: &str) -> Option<(u64, String, String)> {
    Some((count, first.to_owned(), last.to_owned()))
}

#[test]
fn a_run_is_on_time_for_less_than_a_minute() {
    assert_eq!(hourly("", "05:00:00", "05:59:59"), (vec![], None));
    assert_eq!(hourly("", "05:00:00", "06:00:00"), (vec!["01 06:00".to_owned()], None));
    assert_eq!(hourly("", "05:00:00", "06:00:59"), (vec!["01 06:00".to_owned()], None));
    assert_eq!(hourly("", "05:00:00", "06:01:00"), (vec![], missed(1, "01 06:00", "01 06:00")));
}

#[test]
fn skip_leaves_out_all_that_was_missed_and_runs_what_is_on_time() {
    let (runs, left) = hourly("missed = \"skip\"", "01:00:00", "06:00:10");
    assert_eq!((runs, left), (vec!["01 06:00".to_owned()], missed(4, "01 02:00", "01 05:00")));
}

#[test]
fn once_makes_one_run_of_all_that_were_missed() {
    let once = "missed = \"once\"\nmissed_within = \"2h\"";
    assert_eq!(
        hourly(once, "01:00:00", "06:30:00"),
        (vec!["01 06:00".to_owned()], missed(4, "01 02:00", "01 05:00"))
    );
    // The run that is on time makes up for the others.
    assert_eq!(
        hourly(once, "04:00:00", "06:00:10"),
        (vec!["01 06:00".to_owned()], missed(1, "01 05:00", "01 05:00"))
    );
    // Within the bound there is none.
    let half = "missed = \"once\"\nmissed_within = \"20min\"";
    assert_eq!(hourly(half, "04:00:00", "06:30:00"), (vec![], missed(2, "01 05:00", "01 06:00")));
}

#[test]
fn all_makes_each_run_within_the_bound_and_reports_the_rest() {
    let all = "missed = \"all\"\nmissed_within = \"2h\"";
    let runs = ["01 05:00", "01 06:00", "01 07:00"].map(str::to_owned).to_vec();
    assert_eq!(hourly(all, "01:00:00", "07:00:00"), (runs, missed(3, "01 02:00", "01 04:00")));
    let runs = ["01 06:00", "01 07:00"].map(str::to_owned).to_vec();
    assert_eq!(hourly(all, "01:00:00", "07:00:01"), (runs, missed(4, "01 02:00", "01 05:00")));
}

#[test]
fn an_entry_without_a_record_has_missed_nothing_before_its_schedule_was_in_force() {
    let schedule = schedule("at = \"06:00\"\nmissed = \"once\"\nmissed_within = \"2h\"");
    assert_eq!(told(&schedule.catch_up(|_| None, at("06:30:00"), at("07:00:00"))), (vec![], None));
    // A record that is older than the schedule tells nothing of its times.
    let old = Some(at("2026-02-28T09:00:00"));
    assert_eq!(told(&schedule.catch_up(|_| old, at("06:30:00"), at("07:00:00"))), (vec![], None));
    let run = (vec!["01 06:00".to_owned()], None);
    assert_eq!(told(&schedule.catch_up(|_| None, at("05:00:00"), at("07:00:00"))), run);
}

#[test]
fn missed_runs_are_counted_over_a_year_at_most() {
    let schedule = schedule("every = \"1h\"\nanchor = \"2000-01-01 00:00\"");
    let catchup = schedule.catch_up(|_| None, at("2001-01-01T00:00:00"), at("00:30:00"));
    assert_eq!(catchup.missed[0].count, 366 * 24);
}

#[test]
fn an_entry_that_is_not_enabled_neither_runs_nor_misses() {
    let schedule = schedule("at = \"06:00\"\nenabled = false");
    assert_eq!(schedule.next("a", at("00:00:00")), None);
    assert_eq!(told(&schedule.catch_up(|_| None, at("00:00:00"), at("09:00:00"))), (vec![], None));
}

#[test]
fn runs_of_several_entries_come_in_the_order_of_their_times() {
    let entry = |name: &str, times: &str| {
        let policy = "missed = \"all\"\nmissed_within = \"1d\"";
        format!("[[entry]]\nname = \"{name}\"\npump = \"{name}\"\ndose = \"1mL\"\nat = {times}\n{policy}\n")
    };
    let text = format!(
        "schema = \"schedule/1\"\n{}{}",
        entry("one", "[\"07:00\", \"09:00\"]"),
        entry("two", "[\"06:00\", \"07:00\", \"08:00\"]")
    );
    let schedule = Schedule::read(&text, &TimeZone::UTC).unwrap();
    let catchup = schedule.catch_up(|_| None, at("00:00:00"), at("10:00:00"));
    let runs: Vec<_> = catchup.run.iter().map(|due| (due.entry.name(), due.planned)).collect();
    let told = [("two", "06"), ("one", "07"), ("two", "07"), ("two", "08"), ("one", "09")];
    assert_eq!(runs, told.map(|(name, hour)| (name, at(&format!("{hour}:00:00")))));
}

/// A service that wakes at these times, and the runs that it made.
fn service(schedule: &Schedule, wakes: impl IntoIterator<Item = Timestamp>) -> Vec<Timestamp> {
    let mut record: BTreeMap<String, Timestamp> = BTreeMap::new();
    let mut made = Vec::new();
    for now in wakes {
        let catchup = schedule.catch_up(|name| record.get(name).copied(), at("00:00:00"), now);
        let runs = catchup.run.iter().map(|due| (due.entry.name(), due.planned));
        let missed = catchup.missed.iter().map(|missed| (missed.entry.name(), missed.last));
        for (name, planned) in missed.chain(runs) {
            let last = record.entry(name.to_owned()).or_insert(planned);
            *last = planned.max(*last);
        }
        made.extend(catchup.run.iter().map(|due| due.planned));
    }
    made
}

#[test]
fn a_clock_that_is_set_back_never_repeats_a_run_that_is_on_record() {
    let minute = |minute: i64| Timestamp::from_second(at("00:00:00").as_second() + minute * 60).unwrap();
    for policy in
        ["", "missed = \"once\"\nmissed_within = \"2h\"", "missed = \"all\"\nmissed_within = \"7d\""]
    {
        let schedule = schedule(&format!("every = \"30min\"\nbetween = [\"01:00\", \"23:00\"]\n{policy}"));
        // At 12:00 the clock is set back to 09:00, at 15:00 to 14:45 and at 18:00 to 00:00.
        let wakes = (0..720).chain(540..900).chain(885..1080).chain(0..1440);
        let made = service(&schedule, wakes.map(minute));
        let all: Vec<Timestamp> = schedule.due(minute(0), minute(1439)).map(|due| due.planned).collect();
        assert_eq!(made, all, "{policy}");
    }
}

#[test]
fn a_clock_that_is_set_back_is_told() {
    let schedule = schedule("at = \"06:00\"");
    let catchup = schedule.catch_up(|_| Some(at("06:00:00")), at("00:00:00"), at("05:00:00"));
    assert!(catchup.run.is_empty() && catchup.missed.is_empty());
    assert_eq!((catchup.ahead[0].entry.name(), catchup.ahead[0].recorded), ("a", at("06:00:00")));
    assert!(schedule.catch_up(|_| Some(at("06:00:00")), at("00:00:00"), at("06:00:00")).ahead.is_empty());
}

#[test]
fn a_run_waits_for_its_pump_until_the_next_time_or_a_day() {
    let waits = |keys: &str| schedule(keys).entry("a").unwrap().waits_until(at("06:00:00"));
    assert_eq!(waits("at = \"06:00\""), None);
    assert_eq!(waits("at = [\"06:00\", \"18:00\"]\nbusy = \"skip\""), None);
    assert_eq!(waits("at = [\"06:00\", \"18:00\"]\nbusy = \"wait\""), Some(at("18:00:00")));
    let next_day = Some(at("2026-03-02T06:00:00"));
    assert_eq!(waits("at = \"06:00\"\ndays = \"sun\"\nbusy = \"wait\""), next_day);
    assert_eq!(waits("at = \"06:00\"\nuntil = \"2026-03-01\"\nbusy = \"wait\""), next_day);
}

#[test]
fn meetings_of_two_entries_at_one_pump_are_found() {
    let entry = |name: &str, keys: &str| format!("[[entry]]\nname = \"{name}\"\ndose = \"1mL\"\n{keys}\n");
    let text = format!(
        "schema = \"schedule/1\"\n{}{}{}",
        entry("third", "pump = \"p\"\nevery = \"8h\"\nanchor = \"2026-01-01 00:00\""),
        entry("other", "pump = \"q\"\nat = \"16:00\""),
        entry("window", "pump = \"p\"\nevery = \"1h\"\nbetween = [\"15:00\", \"18:00\"]"),
    );
    let schedule = Schedule::read(&text, &TimeZone::UTC).unwrap();
    let found: Vec<_> = schedule
        .meetings(at("00:00:00"), at("2026-03-02T00:00:00"))
        .map(|meeting| (meeting.first.entry.name(), meeting.second.entry.name(), meeting.second.planned))
        .collect();
    assert_eq!(found, [("third", "window", at("16:00:00"))]);
}
