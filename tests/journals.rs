//! Journals whose bytes were changed or cut off.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::io::{Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use pump_bench::record::PhaseSource;
use pump_bench::record::{PumpState, Story};
use pump_bench::{Bench, DoseRequest, built_in};
use pump_ctl::plan::Phase;
use pump_model::Pump;

/// The journal of a dose that was done, one that was stopped and resumed, and one that was stopped.
static JOURNAL: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let mut session = bench.session().unwrap();
    let mut run = |volume_ml: f64, stop_at: u64| {
        let request = DoseRequest::dose(volume_ml);
        let prepared =
            if volume_ml == 0.0 { session.prepare_rest(request) } else { session.prepare(request) };
        let watch = |made| if made >= stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        session.run(&prepared.unwrap(), watch).unwrap();
    };
    run(3.0, u64::MAX);
    run(-4.0, 1000);
    run(0.0, u64::MAX);
    run(5.0, 2000);
    fs::read(bench.folder().path().join("journal.jsonl")).unwrap()
});

fn story(bytes: &[u8]) -> Result<Story, String> {
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = &folder.path().join("journal.jsonl");
    fs::write(path, bytes).unwrap();
    Story::read(path, &Pump::three_roller(), PumpState::fresh(Phase::known(0.0), PhaseSource::Home))
        .map_err(|error| error.to_string())
}

/// Texts of the journal's entries after its first line.
fn entries() -> Vec<String> {
    let text = str::from_utf8(&JOURNAL).unwrap();
    let entry = |line: &str| line.split_once(r#""entry":"#).unwrap().1.strip_suffix('}').unwrap().to_owned();
    text.lines().skip(1).map(entry).collect()
}

/// Writes these entries as a journal of format 1, whose lines have no number and which has no first line.
fn first_format(entries: &[String]) -> Vec<u8> {
    let line = |entry: &String| {
        let crc32 = crc32fast::hash(entry.as_bytes());
        format!("{{\"crc32\":\"{crc32:08x}\",\"entry\":{entry}}}\n")
    };
    entries.iter().map(line).collect::<String>().into_bytes()
}

/// Writes these entries as a journal of format 2.
fn second_format(entries: &[String]) -> Vec<u8> {
    let line = |(number, entry): (usize, &str)| {
        let crc32 = crc32fast::hash(format!("{number} {entry}").as_bytes());
        format!("{{\"crc32\":\"{crc32:08x}\",\"number\":{number},\"entry\":{entry}}}\n")
    };
    let entries = [r#"{"begins":{"format":2}}"#].into_iter().chain(entries.iter().map(String::as_str));
    entries.enumerate().map(line).collect::<String>().into_bytes()
}

/// Bytes up to the end of the last whole line among the first `length`.
fn whole_lines(length: usize) -> usize {
    JOURNAL[..length].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn a_journal_cut_anywhere_tells_what_its_whole_lines_tell(part in 0.0..=1.0_f64, rest in any::<Vec<u8>>()) {
        let cut = (part * JOURNAL.len() as f64) as usize;
        let whole = whole_lines(cut);
        if whole == 0 {
            // The first line of a journal is there as soon as its file is.
            prop_assert!(story(&JOURNAL[..cut]).unwrap_err().contains("line 1 of"));
            return Ok(());
        }
        let expected = story(&JOURNAL[..whole]).unwrap();
        prop_assert_eq!(story(&JOURNAL[..cut]).unwrap().state, expected.state);
        // Anything may follow the last newline.
        let rest: Vec<u8> = rest.into_iter().filter(|byte| *byte != b'\n').collect();
        let torn = story(&[&JOURNAL[..whole], &rest].concat()).unwrap();
        prop_assert_eq!(torn.state, expected.state);
        prop_assert_eq!(torn.torn, !rest.is_empty());
    }

    #[test]
    fn a_changed_byte_is_told_or_lies_before_what_counts(part in 0.0..1.0_f64, flip in 1..=255_u8) {
        let at = (part * JOURNAL.len() as f64) as usize;
        let mut bytes = JOURNAL.clone();
        bytes[at] ^= flip;
        let expected = story(&JOURNAL).unwrap();
        match story(&bytes) {
            Ok(told) if at + 1 == JOURNAL.len() => prop_assert!(told.torn),
            Ok(told) => prop_assert_eq!(told.state, expected.state),
            Err(message) => prop_assert!(message.contains("is damaged") && message.contains("angle")),
        }
    }

    #[test]
    fn anything_at_all_is_read_or_refused(bytes in any::<Vec<u8>>()) {
        if let Err(message) = story(&bytes) {
            prop_assert!(message.contains("is damaged"));
        }
    }
}

#[test]
fn the_end_of_a_long_journal_is_read_and_its_damage_found() {
    let entries = entries();
    assert_eq!(second_format(&entries), *JOURNAL, "these tests write what the program writes");
    // Longer than any window that is read at first, with and without a rest in the last of it.
    let many = 300_000 / JOURNAL.len() + 1;
    let long: Vec<String> = (0..many).flat_map(|_| entries.clone()).collect();
    let intent = entries.iter().find(|entry| entry.contains("intent")).unwrap();
    let progress = entries.iter().find(|entry| entry.contains("progress")).unwrap();
    let under_way: Vec<String> = [vec![intent.clone()], vec![progress.clone(); 3000]].concat();
    for written in [first_format as fn(&[String]) -> Vec<u8>, second_format] {
        assert_eq!(story(&written(&long)).unwrap().state, story(&JOURNAL).unwrap().state);
        assert!(story(&written(&[long.clone(), under_way.clone()].concat())).unwrap().cut_off.is_some());
        let mut damaged = written(&long);
        let last = damaged.len() - 20;
        damaged[last] ^= 1;
        let message = story(&damaged).unwrap_err();
        assert!(message.starts_with("the last line of the journal"), "{message}");
    }
}

#[test]
fn damage_at_the_end_of_a_huge_journal_is_found_without_reading_it_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    let mut file = fs::File::create(&path).unwrap();
    let head = JOURNAL.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    file.write_all(&JOURNAL[..head]).unwrap();
    // A hole takes no room on the disk, and more than any memory once it is read.
    file.seek(SeekFrom::Start(1 << 40)).unwrap();
    let mut end = [b"\n", &JOURNAL[head..]].concat();
    let read = || {
        Story::read(&path, &Pump::three_roller(), PumpState::fresh(Phase::known(0.0), PhaseSource::Home))
            .map_err(|error| error.to_string())
    };
    file.write_all(&end).unwrap();
    assert_eq!(read().unwrap().state, story(&JOURNAL).unwrap().state);
    let last = end.len() - 20;
    end[last] ^= 1;
    file.seek(SeekFrom::Start(1 << 40)).unwrap();
    file.write_all(&end).unwrap();
    let message = read().unwrap_err();
    assert!(message.contains("the last line of") && message.contains("is damaged"), "{message}");
    // Zeros without an end are no line that was torn.
    file.set_len(1 << 41).unwrap();
    let message = read().unwrap_err();
    assert!(message.contains("is damaged") && message.contains("zeros"), "{message}");
}

#[test]
fn a_dose_prepared_before_another_one_moved_the_rotor_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let mut session = bench.session().unwrap();
    let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
    session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    let before = session.state().copied();
    let refused = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(refused.contains("prepare the dose again"), "{refused}");
    assert_eq!(session.state().copied(), before);
}
