//! Tests of the journal.

use std::fs;

use pump_ctl::plan::Phase;

use crate::displacement::Correction;

use super::*;
use crate::record::{DoseTerms, Intent, PhaseSource, Why};

fn story(entries: &[Entry]) -> Result<Story, (String, String)> {
    let bytes: String = entries.iter().map(|entry| line::encode(entry).unwrap()).collect();
    Story::from_bytes(bytes.as_bytes(), &Pump::three_roller(), fresh())
}

fn fresh() -> PumpState {
    PumpState::fresh(Phase::known(0.0), PhaseSource::Home)
}

fn open(path: &Path) -> Result<(Journal, Story), JournalError> {
    Journal::open(path, &Pump::three_roller(), fresh())
}

/// Reads the entries of a file, with their numbers.
fn entries(path: &Path) -> Vec<(Option<u64>, Entry)> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().map(|text| line::decode_numbered(text).unwrap()).collect()
}

/// Writes the entries of a motion to a rest at an angle.
fn move_to(journal: &mut Journal, angle_rad: f64) {
    journal.append(&INTENT).unwrap();
    journal.append(&Entry::Progress { made: 0, may: 2000 }).unwrap();
    journal.append(&rest(7, angle_rad)).unwrap();
}

fn rest(unix_s: u64, angle_rad: f64) -> Entry {
    let state = PumpState::fresh(Phase::known(angle_rad), PhaseSource::Home);
    Entry::Rest { unix_s, why: Why::Set, state, dose: None, reason: None }
}

const INTENT: Entry = Entry::Intent(Intent {
    unix_s: 0,
    purpose: crate::record::Purpose::Dose,
    requested_ml: 3.0,
    carry_in_ml: 0.0,
    carry_in_half_width_ml: 0.0,
    planned_ml: 3.0,
    carry_out_ml: 0.0,
    start_angle_rad: 1.0,
    half_width_rad: 0.01,
    turned: None,
    steps: -2000,
    step_rad: 0.0005,
    revolution_ml: None,
    inverted: false,
    motor_way: None,
    motion_s: 1.0,
    speed_rad_s: 1.0,
    retract_ml: None,
    whole: None,
    terms: DoseTerms {
        until_stopped: false,
        profile: false,
        cruise_rad_s: None,
        flow_ml_s: None,
        fastest: false,
        smooth: false,
        low_flow: false,
        by_weight: false,
        weighing: None,
        ramps: None,
        max_outlet_kpa: None,
        min_inlet_kpa: None,
    },
    correction: Correction::NONE,
    told: None,
});

#[test]
fn the_order_of_entries_counts_and_no_clock() {
    let told = story(&[rest(2_000_000_000, 1.0), rest(5, 2.0)]).unwrap();
    assert_eq!(told.state.unwrap().angle_rad, 2.0);
}

#[test]
fn a_dose_under_way_is_known_by_what_was_announced() {
    let unfinished = |entries: &[Entry]| story(entries).unwrap().state.unwrap();
    let begun = unfinished(&[rest(0, 1.0), INTENT]);
    assert_eq!((begun.angle_rad, begun.half_width_rad), (1.0, 0.01));
    let moved = unfinished(&[
        rest(0, 1.0),
        INTENT,
        Entry::Progress { made: 0, may: 400 },
        Entry::Progress { made: 300, may: 500 },
    ]);
    let dose = moved.unfinished.unwrap();
    assert_eq!((dose.made_least, dose.made_most), (300, 500));
    assert!((moved.angle_rad - (1.0 - 0.2)).abs() < 1e-12);
    assert!((moved.half_width_rad - (0.01 + 0.05)).abs() < 1e-12);
}

#[test]
fn entries_that_do_not_follow_from_each_other_are_damage() {
    let progress = Entry::Progress { made: 0, may: 1 };
    for entries in [&[progress.clone()][..], &[INTENT, INTENT], &[rest(0, 0.0), progress]] {
        assert!(story(entries).is_err());
    }
}

#[test]
fn an_empty_or_zeroed_journal_is_damage_and_a_missing_one_a_fresh_pump() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    assert_eq!(open(&path).unwrap().1, Story::default());
    for bytes in [vec![], vec![0; 100], vec![0; 200_000], b"{\"crc32\":\"0".to_vec()] {
        fs::write(&path, &bytes).unwrap();
        let error = open(&path).unwrap_err();
        assert!(matches!(error, JournalError::Damaged { .. }), "{error}");
    }
}

#[test]
fn a_line_that_is_missing_is_damage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let (mut journal, _) = open(&path).unwrap();
    journal.append(&rest(0, 1.0)).unwrap();
    move_to(&mut journal, 2.0);
    move_to(&mut journal, 3.0);
    journal.append(&INTENT).unwrap();
    for made in [300, 600] {
        journal.append(&Entry::Progress { made, may: 2000 }).unwrap();
    }
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    assert_eq!(lines.len(), 11);
    assert!(open(&path).unwrap().1.cut_off.is_some());
    // The last rest is line 8, and the lines before line 7 count for nothing any more.
    for n in 0..10 {
        let without: String =
            lines.iter().enumerate().filter(|(at, _)| *at != n).map(|(_, line)| *line).collect();
        fs::write(&path, without).unwrap();
        let told = open(&path).map(|(_, story)| story.state);
        assert_eq!(told.is_err(), n == 0 || n > 5, "without line {}: {told:?}", n + 1);
    }
}

#[test]
fn a_newer_format_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    fs::write(&path, line::encode_numbered(0, &Entry::Begins { format: 3 }).unwrap() + "anything\n").unwrap();
    let error = open(&path).unwrap_err().to_string();
    assert!(error.contains("has format 3") && error.contains("formats 1 to 2"), "{error}");
}

#[test]
fn a_long_journal_is_kept_and_the_next_goes_on_from_its_rest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let (mut journal, _) = open(&path).unwrap();
    journal.long = 2000;
    journal.append(&rest(0, 1.0)).unwrap();
    for n in 0..20 {
        move_to(&mut journal, f64::from(n) / 10.0);
        assert_eq!(open(&path).unwrap().1.state.unwrap().angle_rad, f64::from(n) / 10.0);
    }
    let part = |n: u32| folder.path().join(format!("journal-{n}.jsonl"));
    let parts: Vec<_> = (1..).map(part).take_while(|path| path.exists()).collect();
    assert!(parts.len() > 3);
    let mut expected = 0;
    let mut last = None;
    for path in parts.iter().chain([&path]) {
        let entries = entries(path);
        assert_eq!(entries[0].1, Entry::Begins { format: 2 });
        if last.is_some() {
            assert_eq!(Some(&entries[1].1), last.as_ref(), "it begins with the rest before");
        }
        for (number, _) in &entries {
            assert_eq!(*number, Some(expected));
            expected += 1;
        }
        last = entries.last().map(|(_, entry)| entry.clone());
    }
}

#[test]
fn a_journal_of_the_first_version_is_kept_before_the_next_motion_and_goes_on_in_the_new_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let old: String = [INTENT, Entry::Progress { made: 0, may: 400 }]
        .iter()
        .map(|entry| line::encode(entry).unwrap())
        .collect();
    fs::write(&path, &old).unwrap();
    let (mut journal, story) = open(&path).unwrap();
    assert!(story.cut_off.is_some());
    journal.append(&rest(0, 1.0)).unwrap();
    assert!(fs::read_to_string(&path).unwrap().starts_with(&old), "it goes on as it is");
    let (mut journal, _) = open(&path).unwrap();
    move_to(&mut journal, 2.0);
    assert!(fs::read_to_string(folder.path().join("journal-1.jsonl")).unwrap().starts_with(&old));
    assert_eq!(entries(&path)[..2], [(Some(0), Entry::Begins { format: 2 }), (Some(1), rest(0, 1.0))]);
    assert_eq!(open(&path).unwrap().1.state.unwrap().angle_rad, 2.0);
}

#[test]
fn a_process_that_ends_while_it_keeps_a_journal_loses_and_doubles_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let (mut journal, _) = open(&path).unwrap();
    journal.append(&rest(0, 1.0)).unwrap();
    rotation::keep(&path).unwrap();
    let (mut journal, story) = open(&path).unwrap();
    assert_eq!(story.state.unwrap().angle_rad, 1.0);
    move_to(&mut journal, 2.0);
    journal.long = 0;
    move_to(&mut journal, 3.0);
    assert_eq!(entries(&folder.path().join("journal-1.jsonl")).len(), 5);
    assert!(!folder.path().join("journal-2.jsonl").exists());
}

/// Disk that tells what the file holds at each sync.
#[derive(Debug, Clone, Default)]
struct Watched(std::sync::Arc<std::sync::Mutex<Vec<Vec<u8>>>>);

impl Storage for Watched {
    fn sync(&mut self, file: &File) -> io::Result<()> {
        use std::os::unix::fs::FileExt;
        let mut bytes = vec![0; file.metadata()?.len() as usize];
        // The file is open for writing alone, so its place tells the path.
        let path = fs::read_link(format!("/proc/self/fd/{}", std::os::fd::AsRawFd::as_raw_fd(file)))?;
        File::open(path)?.read_exact_at(&mut bytes, 0)?;
        self.0.lock().unwrap().push(bytes);
        Ok(())
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_long_motion_keeps_its_last_announcements_and_tells_them_at_every_sync() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let (mut journal, _) = open(&path).unwrap();
    for n in 0..7 {
        move_to(&mut journal, 0.1 * f64::from(n));
    }
    let Entry::Intent(intent) = INTENT else { unreachable!() };
    let steps = 400_000_000;
    journal.append(&Entry::Intent(Intent { steps, motion_s: 86_400.0, ..intent })).unwrap();
    let watched = Watched::default();
    journal.store_by(Box::new(watched.clone()));
    // Four announcements a second for 50 min.
    let (mut longest, mut compacted) = (0, 0);
    for n in 0..12_000_u64 {
        let (made, may) = (1000 * n, 1000 * n + 5000);
        journal.append(&Entry::Progress { made, may }).unwrap();
        journal.compact().unwrap();
        let syncs = std::mem::take(&mut *watched.0.lock().unwrap());
        longest = longest.max(syncs.iter().map(Vec::len).max().unwrap_or(0));
        if syncs.len() > 1 {
            compacted += 1;
        } else if n % 300 > 2 {
            continue;
        }
        // Wherever a process ends, the last announcement on the disk is the one that counts.
        for bytes in &syncs {
            let story = Story::from_bytes(bytes, &Pump::three_roller(), fresh()).unwrap();
            let (_, part) = story.cut_off.unwrap();
            assert_eq!((part.made_least, part.made_most), (made as i64, may as i64));
        }
    }
    assert!(longest < 300_000, "{longest} bytes");
    assert!((3..6).contains(&compacted), "{compacted}");
    journal.append(&rest(9, 3.0)).unwrap();
    let (_, story) = open(&path).unwrap();
    assert!(story.cut_off.is_none() && !story.torn);
    assert_eq!(story.state.unwrap().angle_rad, 3.0);
    // The numbers go on, so that a line which is missing shows.
    let numbers: Vec<_> = entries(&path).iter().map(|(number, _)| number.unwrap()).collect();
    assert!(numbers.windows(2).all(|pair| pair[0] + 1 == pair[1]));
}
