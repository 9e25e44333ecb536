//! Claims about the log: each dose has one entry, whatever ended it and whenever the process ended.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs::{self, File};
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pump_bench::record::{Clock, LogEnd, LogEntry, LogLine, Purpose, Stamp, Storage};
use pump_bench::report::{AcceptedReport, Status};
use pump_bench::{Bench, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::Phase;

/// Clock that a test sets.
#[derive(Debug, Clone)]
struct SetClock(Arc<AtomicU64>);

impl Clock for SetClock {
    fn now(&self) -> Stamp {
        Stamp::new(self.0.load(Ordering::Relaxed), 3600)
    }
}

fn bench(folder: &tempfile::TempDir) -> Bench {
    Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap()
}

fn doses(bench: &Bench) -> Vec<LogEntry> {
    let read = |line| match line {
        LogLine::Dose(entry) => entry,
        other => panic!("{other:?}"),
    };
    bench.log().unwrap().map(|line| read(line.unwrap())).collect()
}

fn dose(session: &mut Session<'_>, volume_ml: f64) {
    let prepared = session.prepare(DoseRequest::dose(volume_ml).with_asked("as typed")).unwrap();
    session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
}

/// Runs a dose that stops after some steps.
fn stop_after(session: &mut Session<'_>, volume_ml: f64, steps: u64) {
    let prepared = session.prepare(DoseRequest::dose(volume_ml)).unwrap();
    let watch = |made| if made >= steps { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    assert!(!session.run(&prepared, watch).unwrap().completed);
}

#[test]
fn a_log_tells_time_volume_end_and_tube_of_each_dose() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    assert!(doses(&bench).is_empty());
    let now = Arc::new(AtomicU64::new(1_795_400_100));
    let mut session = bench.session().unwrap();
    session.keep_time_by(Box::new(SetClock(now.clone())));
    let prepared = session.prepare(DoseRequest::dose(25.0).with_asked("25 mL").with_retraction(0.1)).unwrap();
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let report = DoseReport::new(&bench, &prepared, Some(&delivered));
    assert_eq!(report.time.unwrap().to_string(), "2026-11-23T03:15:00+01:00");
    // The clock jumps back by a day.
    now.store(1_795_313_700, Ordering::Relaxed);
    stop_after(&mut session, 10.0, 3000);
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    session.run(&rest, |_| ControlFlow::Continue(())).unwrap();
    session.new_tube().unwrap();
    dose(&mut session, -1.0);
    let found = doses(&bench);
    let numbers: Vec<u64> = found.iter().map(|dose| dose.number).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5]);
    let [first, back, stopped, rest, reverse] = &found[..] else { panic!("{found:?}") };
    assert_eq!(first.time.to_string(), "2026-11-23T03:15:00+01:00");
    assert_eq!((first.asked.unwrap().as_str(), first.end, first.tube), ("25 mL", LogEnd::Done, 1));
    assert!((first.delivered_ml - delivered.volume_ml).abs() < 1e-3, "{first:?}");
    assert_eq!(first.expanded_uncertainty_ml, Some(report.expanded_uncertainty_ml));
    assert_eq!(first.motion_s, Some(delivered.measured_s));
    assert_eq!((back.purpose, back.asked), (Purpose::Retract, None));
    assert!((back.delivered_ml + 0.1).abs() < 1e-3, "{back:?}");
    assert_eq!(stopped.time.to_string(), "2026-11-22T03:15:00+01:00");
    assert_eq!(
        (stopped.end, stopped.resumed, rest.end, rest.resumed),
        (LogEnd::Stopped, false, LogEnd::Done, true)
    );
    // The parts of a dose add up, with the volume that the retraction before it is repaid.
    let both_ml = stopped.delivered_ml + rest.delivered_ml;
    assert!((both_ml - 10.1).abs() < 2e-3, "{both_ml}");
    assert!(stopped.expanded_uncertainty_ml.unwrap() < first.expanded_uncertainty_ml.unwrap());
    assert_eq!((reverse.tube, reverse.carry_ml), (2, session.owed_ml()));
    assert!((reverse.delivered_ml + 1.0).abs() < 2e-3 && reverse.steps.unwrap() < 0, "{reverse:?}");
}

#[test]
fn a_log_that_is_lost_or_behind_is_complete_for_a_reader_and_mended_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    let path = bench.folder().path().join("log.jsonl");
    {
        let mut session = bench.session().unwrap();
        (0..6).for_each(|_| dose(&mut session, 0.5));
    }
    let whole = fs::read(&path).unwrap();
    let listed = doses(&bench);
    assert_eq!(listed.len(), 6);
    // A process that is killed between journal and log leaves any beginning of the log.
    for length in [0, 1, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        assert_eq!(doses(&bench), listed, "a reader misses nothing");
        drop(bench.session().unwrap());
        assert_eq!(fs::read(&path).unwrap(), whole, "{length}");
    }
    fs::remove_file(&path).unwrap();
    drop(bench.session().unwrap());
    assert_eq!(fs::read(&path).unwrap(), whole);
}

/// Disk that never waits.
#[derive(Debug)]
struct NoDisk;

impl Storage for NoDisk {
    fn sync(&mut self, _file: &File) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_log_is_complete_and_mended_over_a_journal_that_was_rotated() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    let [journal, older] = ["journal.jsonl", "journal-1.jsonl"].map(|name| bench.folder().path().join(name));
    let path = bench.folder().path().join("log.jsonl");
    let mut session = bench.session().unwrap();
    session.store_by(Box::new(NoDisk));
    (0..3).for_each(|_| dose(&mut session, 0.5));
    // Rests fill the journal, and the next dose begins a new file.
    while fs::metadata(&journal).unwrap().len() <= 8 << 20 {
        session.set_angle(Some(Phase::known(0.3))).unwrap();
    }
    (0..3).for_each(|_| dose(&mut session, 0.5));
    assert!(older.exists(), "the journal is rotated");
    drop(session);
    let (listed, whole) = (doses(&bench), fs::read(&path).unwrap());
    let numbers: Vec<u64> = listed.iter().map(|dose| dose.number).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6]);
    // The log is lost, or ends among the doses of the older part.
    for length in [0, whole.len() / 3] {
        fs::write(&path, &whole[..length]).unwrap();
        assert_eq!(doses(&bench), listed, "a reader misses nothing");
        drop(bench.session().unwrap());
        assert_eq!(fs::read(&path).unwrap(), whole, "{length}");
    }
}

#[test]
fn a_dose_whose_process_ended_is_logged_once_with_its_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    let journal = bench.folder().path().join("journal.jsonl");
    {
        let mut session = bench.session().unwrap();
        dose(&mut session, 1.0);
        dose(&mut session, 5.0);
    }
    let log = bench.folder().path().join("log.jsonl");
    let (text, logged) = (fs::read_to_string(&journal).unwrap(), fs::read_to_string(&log).unwrap());
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let intent = lines.iter().rposition(|line| line.contains("\"intent\"")).unwrap();
    let before = logged.split_inclusive('\n').next().unwrap();
    // The process ends after the intent, after each announcement, or just before the rest is written.
    for kept in intent + 1..lines.len() {
        fs::write(&journal, lines[..kept].concat()).unwrap();
        fs::write(&log, before).unwrap();
        assert_eq!(doses(&bench).len(), 1, "the end is not on record");
        for _ in 0..2 {
            let mut session = bench.session().unwrap();
            if session.state().unwrap().unfinished.is_some() {
                session.discard().unwrap();
            }
        }
        let found = doses(&bench);
        let numbers: Vec<u64> = found.iter().map(|dose| dose.number).collect();
        assert_eq!(numbers, [1, 2], "{kept}");
        let cut = &found[1];
        assert_eq!((cut.end, cut.asked.unwrap().as_str()), (LogEnd::CutOff, "as typed"));
        let (least_ml, most_ml) = cut.delivered_range_ml.unwrap_or((cut.delivered_ml, cut.delivered_ml));
        assert!((0.0..=5.01).contains(&least_ml) && least_ml <= most_ml && most_ml <= 5.01, "{cut:?}");
        assert!(cut.expanded_uncertainty_ml.unwrap() >= 0.5 * (most_ml - least_ml), "{cut:?}");
    }
}

#[test]
fn accept_status_log_and_safety_tell_one_volume_of_a_dose_that_was_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    let journal = bench.folder().path().join("journal.jsonl");
    {
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::within(0.5, 0.1))).unwrap();
        dose(&mut session, 10.0);
    }
    let text = fs::read_to_string(&journal).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    fs::write(&journal, lines[..lines.len() - 1].concat()).unwrap();
    fs::remove_file(bench.folder().path().join("log.jsonl")).unwrap();
    let unfinished = Status::of(&bench).unwrap().unfinished.unwrap();
    let range_ml = (unfinished.delivered_least_ml, unfinished.delivered_most_ml);
    assert!(unfinished.steps_made_least < unfinished.steps_made_most);
    assert!(range_ml.1 - range_ml.0 > 0.3, "the angle makes the volume unsure: {range_ml:?}");
    assert_eq!((unfinished.end, unfinished.cause), (None, None), "the log does not have it yet");
    let accepted = bench.session().unwrap().accept().unwrap();
    let report = AcceptedReport::new(&bench, &accepted, Vec::new());
    assert_eq!((report.delivered_least_ml, report.delivered_most_ml), range_ml);
    let found = doses(&bench);
    assert_eq!((found.len(), found[0].end), (1, LogEnd::CutOff));
    assert_eq!(found[0].delivered_range_ml, Some(range_ml));
    assert!((range_ml.0..range_ml.1).contains(&found[0].delivered_ml), "{:?}", found[0]);
    let safety = Status::of(&bench).unwrap().safety;
    assert_eq!((safety.day_ml, safety.received_ml), (range_ml.1, range_ml.1));
}

#[test]
fn numbers_go_on_after_a_journal_that_was_set_aside() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(&folder);
    dose(&mut bench.session().unwrap(), 0.5);
    fs::remove_file(bench.folder().path().join("journal.jsonl")).unwrap();
    dose(&mut bench.session().unwrap(), 0.5);
    let numbers: Vec<u64> = doses(&bench).iter().map(|dose| dose.number).collect();
    assert_eq!(numbers, [1, 2]);
}
