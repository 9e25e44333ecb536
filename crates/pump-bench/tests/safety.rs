//! Claims about the safety limits: nothing is pumped beyond one, whatever the clock does, and only a person lets a pump
//! go on that stands.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pump_bench::dosing::{RunBound, RunEnd};
use pump_bench::record::{Clock, LogLine, Purpose, Stamp};
use pump_bench::report::{Ending, ErrorKind, Explain, Remedy, Status, StatusRow};
use pump_bench::safety::SafetyLimit;
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};

const DAY: u64 = 86_400;
const START: u64 = 1_795_400_100;

/// Clock that a test sets.
#[derive(Debug, Clone)]
struct SetClock(Arc<AtomicU64>);

impl SetClock {
    fn new() -> Self {
        Self(Arc::new(AtomicU64::new(START)))
    }

    fn set(&self, unix_s: u64) {
        self.0.store(unix_s, Ordering::Relaxed);
    }
}

impl Clock for SetClock {
    fn now(&self) -> Stamp {
        Stamp::new(self.0.load(Ordering::Relaxed), 0)
    }
}

fn bench(folder: &tempfile::TempDir, day_ml: Option<f64>, vessel_ml: Option<f64>) -> Bench {
    let mut file = built_in("three-roller").unwrap();
    (file.safety.max_ml_per_day, file.safety.vessel_ml) = (day_ml, vessel_ml);
    Bench::new(file, None, folder.path()).unwrap()
}

fn session<'a>(bench: &'a Bench, clock: &SetClock) -> Session<'a> {
    let mut session = bench.session().unwrap();
    session.keep_time_by(Box::new(clock.clone()));
    session
}

fn run(session: &mut Session<'_>, request: DoseRequest) -> Result<f64, DoseError> {
    let prepared = session.prepare(request)?;
    Ok(session.run(&prepared, |_| ControlFlow::Continue(()))?.volume_ml)
}

fn dose(session: &mut Session<'_>, volume_ml: f64) -> Result<f64, DoseError> {
    run(session, DoseRequest::dose(volume_ml))
}

/// The limit at which a pump stands, and true if it came to stand with this dose.
fn stands(refused: Result<f64, DoseError>) -> (SafetyLimit, bool) {
    let error = refused.unwrap_err();
    assert_eq!((error.ending(), error.facts().kind), (Ending::Stands, ErrorKind::Safety), "{error}");
    assert!(!error.remedies().is_empty());
    match error {
        DoseError::Stands { stand, is_new, .. } => (stand.limit, is_new),
        other => panic!("{other}"),
    }
}

fn steps(bench: &Bench) -> f64 {
    bench.stands().unwrap().wear.revolutions
}

#[test]
fn a_pump_stands_at_its_day_before_it_moves_and_over_restarts_until_a_person_clears_it() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), None);
    let mut first = session(&bench, &clock);
    dose(&mut first, 25.0).unwrap();
    dose(&mut first, 25.0).unwrap();
    let before = steps(&bench);
    assert_eq!(stands(dose(&mut first, 0.1)), (SafetyLimit::Day, true));
    drop(first);
    // Days later, and by another process, it stands still. What would have fitted is refused too.
    clock.set(START + 3 * DAY);
    let mut second = session(&bench, &clock);
    assert_eq!(stands(dose(&mut second, 0.1)), (SafetyLimit::Day, false));
    assert!(second.jog(10, 1.0, |_| ControlFlow::Continue(())).is_err());
    assert_eq!(steps(&bench), before, "nothing moved");
    for reason in ["", " \n"] {
        assert!(matches!(second.clear_safety(reason), Err(DoseError::NotCleared { .. })));
    }
    let cleared = second.clear_safety("looked at the tank: it is fine").unwrap();
    assert_eq!((cleared.stand.limit, cleared.stand.unix_s), (SafetyLimit::Day, START));
    let journal = fs::read_to_string(bench.folder().path().join("journal.jsonl")).unwrap();
    assert!(
        journal.contains("\"why\":\"stands\"") && journal.contains("looked at the tank: it is fine"),
        "{journal}"
    );
    dose(&mut second, 50.0).unwrap();
    assert!(matches!(second.clear_safety("again"), Err(DoseError::NotCleared { .. })), "it does not stand");
}

#[test]
fn a_pump_that_is_ordered_to_stand_moves_nothing_over_restarts_until_a_person_clears_it() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), None);
    let mut first = session(&bench, &clock);
    dose(&mut first, 30.0).unwrap();
    for reason in ["", " \n", "two\nlines", &"x".repeat(1001)] {
        assert!(matches!(first.stand(reason), Err(DoseError::NotPutToStand { .. })), "{reason:?}");
    }
    let reason = format!("there is water under the rack {}", "é".repeat(60));
    let ordered = first.stand(&reason).unwrap();
    assert_eq!((ordered.limit, ordered.unix_s), (SafetyLimit::Ordered, START));
    let before = steps(&bench);
    drop(first);
    clock.set(START + 3600);
    let mut second = session(&bench, &clock);
    let refused = dose(&mut second, 0.1).unwrap_err();
    let text = refused.to_string();
    assert!(text.contains("stands by order since ") && text.contains("water under the rack"), "{text}");
    assert_eq!(stands(Err(refused)), (SafetyLimit::Ordered, false));
    assert_eq!(
        stands(run(&mut second, DoseRequest::new(Purpose::Purge, -1.0))),
        (SafetyLimit::Ordered, false)
    );
    assert!(second.jog(10, 1.0, |_| ControlFlow::Continue(())).is_err());
    assert_eq!(steps(&bench), before, "nothing moved");
    // The journal has the whole reason, and the state the part that every refusal shows.
    let journal = fs::read_to_string(bench.folder().path().join("journal.jsonl")).unwrap();
    assert!(journal.contains(&format!("\"reason\":\"{reason}\"")), "{journal}");
    assert_eq!(second.clear_safety("dry again").unwrap().forgotten_ml, 0.0);
    // The volumes of the day have nothing to do with an order: they count on.
    assert_eq!(stands(dose(&mut second, 30.0)), (SafetyLimit::Day, true));
    // An order takes the place of the limit, which stands in the way again once the order is cleared.
    second.stand("the hose is off").unwrap();
    assert_eq!(stands(dose(&mut second, 0.1)), (SafetyLimit::Ordered, false));
    second.clear_safety("the hose is on").unwrap();
    assert_eq!(stands(dose(&mut second, 30.0)), (SafetyLimit::Day, true));
    assert_eq!(second.clear_safety("a new tank").unwrap().stand.reason, None);
    dose(&mut second, 30.0).unwrap();
}

#[test]
fn a_dose_that_was_cut_off_stays_unfinished_while_its_pump_is_ordered_to_stand() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, None, None);
    let mut session = session(&bench, &clock);
    let prepared = session.prepare(DoseRequest::dose(20.0)).unwrap();
    let mut looks = 0;
    let stopped = session.run(&prepared, |_| {
        looks += 1;
        if looks > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(stopped.is_ok_and(|delivered| delivered.unfinished));
    session.stand("there is water under the rack").unwrap();
    assert!(matches!(session.prepare_rest(DoseRequest::dose(0.0)), Err(DoseError::Stands { .. })));
    session.clear_safety("dry again").unwrap();
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    session.run(&rest, |_| ControlFlow::Continue(())).unwrap();
    assert!((bench.stands().unwrap().wear.volume_ml - 20.0).abs() < 0.01);
}

#[test]
fn every_purpose_counts() {
    for (purpose, volume_ml) in [
        (Purpose::Prime, 50.0),
        (Purpose::Purge, 50.0),
        (Purpose::Purge, -50.0),
        (Purpose::Run, 50.0),
        (Purpose::Calibrate, 50.0),
    ] {
        let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
        let bench = bench(&folder, Some(50.0), None);
        let mut session = session(&bench, &clock);
        run(&mut session, DoseRequest::new(purpose, volume_ml)).unwrap();
        assert_eq!(stands(dose(&mut session, 0.1)), (SafetyLimit::Day, true), "{purpose} {volume_ml}");
    }
}

#[test]
fn a_day_rolls_to_the_second() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), None);
    let mut session = session(&bench, &clock);
    for purpose in [Purpose::Prime, Purpose::Purge, Purpose::Run, Purpose::Calibrate] {
        run(&mut session, DoseRequest::new(purpose, 10.0)).unwrap();
    }
    run(&mut session, DoseRequest::new(Purpose::Purge, -10.0)).unwrap();
    clock.set(START + DAY);
    let refused = |session: &mut Session<'_>, volume_ml| {
        let told = stands(dose(session, volume_ml));
        session.clear_safety("a test").unwrap();
        told
    };
    dose(&mut session, 50.0).unwrap();
    clock.set(START + 2 * DAY - 1);
    assert_eq!(refused(&mut session, 1.0), (SafetyLimit::Day, true));
    clock.set(START + 3 * DAY);
    assert_eq!(refused(&mut session, 50.1), (SafetyLimit::Day, true));
}

#[test]
fn a_clock_that_jumps_back_frees_nothing_and_is_told() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), None);
    let mut session = session(&bench, &clock);
    dose(&mut session, 25.0).unwrap();
    // The board's battery is empty: it starts in 1970, and the network sets it an hour later.
    clock.set(60);
    let prepared = session.prepare(DoseRequest::dose(20.0)).unwrap();
    assert!(
        prepared.warnings.iter().any(|notice| notice.text().contains("it was set back")),
        "{:?}",
        prepared.warnings
    );
    session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    clock.set(START + 3600);
    assert_eq!(stands(dose(&mut session, 6.0)), (SafetyLimit::Day, true));
}

#[test]
fn a_vessel_counts_until_it_is_emptied_and_what_is_pumped_back_leaves_it() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, None, Some(60.0));
    let mut session = session(&bench, &clock);
    for day in 0..3 {
        clock.set(START + day * DAY);
        dose(&mut session, 20.0).unwrap();
    }
    dose(&mut session, -5.0).unwrap();
    // A line that is purged backwards may draw air: nothing leaves the vessel for sure.
    run(&mut session, DoseRequest::new(Purpose::Purge, -5.0)).unwrap();
    dose(&mut session, 5.0).unwrap();
    assert_eq!(stands(dose(&mut session, 1.0)), (SafetyLimit::Vessel, true));
    // Emptied, the pump stands on: a person clears it too.
    assert_eq!(dose(&mut session, 1.0).unwrap_err().remedies(), [Remedy::EmptyVessel, Remedy::ClearStand]);
    let received_ml = session.vessel_emptied().unwrap();
    assert!((received_ml - 60.0).abs() < 0.01, "{received_ml}");
    let refused = dose(&mut session, 1.0);
    let error = refused.as_ref().unwrap_err();
    assert!(error.to_string().contains("and it was emptied since"), "{error}");
    assert_eq!(error.remedies(), [Remedy::ClearStand], "it is empty");
    assert_eq!(stands(refused), (SafetyLimit::Vessel, false));
    let row = StatusRow::new("tank", Ok(Status::of(&bench).unwrap())).text(4);
    assert!(row.starts_with("tank  STANDS at a safety limit; "), "{row}");
    session.clear_safety("emptied").unwrap();
    dose(&mut session, 60.0).unwrap();
    // Cleared and not emptied, it stands again.
    assert_eq!(stands(dose(&mut session, 1.0)), (SafetyLimit::Vessel, true));
    session.clear_safety("not emptied").unwrap();
    assert_eq!(stands(dose(&mut session, 1.0)), (SafetyLimit::Vessel, true));
}

#[test]
fn a_run_until_stopped_ends_within_the_limits_and_a_batch_is_refused_whole() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), Some(30.0));
    let mut session = session(&bench, &clock);
    let endless = DoseRequest::new(Purpose::Run, 1.0).with_end(RunEnd::Stop);
    let prepared = session.prepare(endless).unwrap();
    assert!(prepared.plan.planned_ml() < 30.0 && prepared.plan.planned_ml() > 29.0);
    assert!(prepared.warnings.iter().any(|notice| notice.text().contains("the safety limits leave 30 mL")));
    assert!(session.keep_batch_safe(5.0, 6, 60.0).is_ok());
    let refused = session.keep_batch_safe(5.0, 7, 60.0).map(|()| 0.0);
    assert_eq!(stands(refused), (SafetyLimit::Vessel, true));
    assert_eq!(bench.stands().unwrap().wear.volume_ml, 0.0, "nothing moved");
}

#[test]
fn a_run_that_outlasts_the_window_of_its_limit_stands_at_the_limit_it_was_planned_by() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), Some(60.0));
    let mut session = session(&bench, &clock);
    dose(&mut session, 45.0).unwrap();
    // The day leaves 5 mL, and the vessel 15.
    let prepared = session.prepare(DoseRequest::new(Purpose::Run, 1.0).with_end(RunEnd::Stop)).unwrap();
    let delivered = session
        .run(&prepared, |_| {
            clock.set(START + DAY + 1);
            ControlFlow::Continue(())
        })
        .unwrap();
    // The day has begun anew, and the vessel leaves 10 mL.
    let limit = delivered.stand.map(|stand| stand.limit);
    assert_eq!(
        (limit, delivered.ran_out),
        (Some(SafetyLimit::Day), Some(RunBound::Safety(SafetyLimit::Day)))
    );
    assert_eq!(stands(dose(&mut session, 0.1)), (SafetyLimit::Day, false));
    drop(session);
    let LogLine::Dose(entry) = bench.log().unwrap().last().unwrap().unwrap() else { panic!("no dose") };
    assert_eq!(entry.cause.as_deref(), Some("a safety limit is reached"));
    assert!(entry.delivered_range_ml.is_none() && entry.expanded_uncertainty_ml.is_some(), "{entry:?}");
}

#[test]
fn a_run_until_stopped_at_a_limit_that_is_used_up_is_refused_by_the_limit_and_not_by_a_volume() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(30.0), None);
    let mut session = session(&bench, &clock);
    dose(&mut session, 30.0).unwrap();
    let refused = session.prepare(DoseRequest::new(Purpose::Run, 1.0).with_end(RunEnd::Stop)).unwrap_err();
    // The dose was made to within its carry.
    let told = "a run until it is stopped ends at the limit: 29.9991 mL were pumped in the last 24 h";
    assert!(refused.to_string().contains(told), "{refused}");
    assert_eq!(stands(dose(&mut session, 0.1)), (SafetyLimit::Day, false));
}

#[test]
fn a_dose_that_is_cut_off_counts_with_the_most_that_it_may_have_pumped() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(50.0), None);
    let mut first = session(&bench, &clock);
    let prepared = first.prepare(DoseRequest::dose(30.0)).unwrap();
    let watch = |made| if made > 9000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let part_ml = first.run(&prepared, watch).unwrap().volume_ml;
    assert!(part_ml > 10.0 && part_ml < 25.0, "{part_ml}");
    // The rest counts with the part: 50 mL in all, and not 65.
    let rest = first.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    first.run(&rest, |_| ControlFlow::Continue(())).unwrap();
    dose(&mut first, 20.0).unwrap();
    assert_eq!(stands(dose(&mut first, 0.1)), (SafetyLimit::Day, true));
}

#[test]
fn a_record_of_an_early_version_counts_in_full_as_of_now() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let free = bench(&folder, None, None);
    dose(&mut session(&free, &clock), 60.0).unwrap();
    // The journal as a version without the account wrote it: the lines lack it, and so do their checksums.
    let path = free.folder().path().join("journal.jsonl");
    let journal = fs::read_to_string(&path).unwrap();
    let mut early = String::new();
    for line in journal.lines() {
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        if let Some(state) = line["entry"].get_mut("rest").and_then(|rest| rest.get_mut("state")) {
            assert!(state.as_object_mut().unwrap().remove("safety").is_some());
        }
        let (number, entry) = (line["number"].as_u64().unwrap(), line["entry"].to_string());
        let crc32 = crc32fast::hash(format!("{number} {entry}").as_bytes());
        early += &format!("{{\"crc32\":\"{crc32:08x}\",\"number\":{number},\"entry\":{entry}}}\n");
    }
    fs::write(&path, early).unwrap();
    clock.set(START + 9 * DAY);
    let limited = bench(&folder, Some(100.0), None);
    let mut late = session(&limited, &clock);
    dose(&mut late, 40.0).unwrap();
    assert_eq!(stands(dose(&mut late, 0.1)), (SafetyLimit::Day, true));
    drop(late);
    clock.set(START + 10 * DAY);
    let mut later = session(&limited, &clock);
    later.clear_safety("a day has passed").unwrap();
    dose(&mut later, 100.0).unwrap();
}

#[test]
fn a_clock_that_was_set_back_is_told_once_and_where_the_pump_refuses() {
    let (folder, clock) = (tempfile::tempdir().unwrap(), SetClock::new());
    let bench = bench(&folder, Some(30.0), None);
    let mut session = session(&bench, &clock);
    dose(&mut session, 20.0).unwrap();
    clock.set(START - 3 * 86_400);
    let behind = "the clock is 3 days behind the latest time on record";
    let mut told = 0;
    for _ in 0..2 {
        let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
        let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        let notes = [prepared.warnings, delivered.warnings, session.notes()].concat();
        told += notes.iter().filter(|note| note.text().contains(behind)).count();
    }
    assert_eq!(told, 1);
    // The dose that has the pump stand says it, and so does every one after it.
    for _ in 0..2 {
        let refused = dose(&mut session, 10.0).unwrap_err().to_string();
        assert_eq!(refused.matches(behind).count(), 1, "{refused}");
    }
}
