//! Journals whose bytes were changed or cut off.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use pump_bench::record::PhaseSource;
use pump_bench::record::{State, Story};
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
    Story::read(path, &Pump::three_roller(), State::fresh(Phase::known(0.0), PhaseSource::Home))
        .map_err(|error| error.to_string())
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
            Err(message) => prop_assert!(message.contains("is damaged") && message.contains("home --set")),
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
fn of_a_long_journal_the_end_is_read() {
    // Longer than any window that is read at first, with and without a rest in the last of it.
    let one = JOURNAL.len();
    let many = 300_000 / one + 1;
    let long = JOURNAL.repeat(many);
    assert_eq!(story(&long).unwrap().state, story(&JOURNAL).unwrap().state);
    let lines: Vec<&[u8]> = JOURNAL.split_inclusive(|byte| *byte == b'\n').collect();
    let progress = lines.iter().find(|line| line.windows(8).any(|word| word == b"progress")).unwrap();
    let intent = lines.iter().find(|line| line.windows(6).any(|word| word == b"intent")).unwrap();
    let under_way = [&long, *intent, &progress.repeat(3000)].concat();
    assert!(story(&under_way).unwrap().cut_off.is_some());
    // The number of a damaged line is that in the file.
    let mut damaged = long.clone();
    let last = damaged.len() - 20;
    damaged[last] ^= 1;
    let message = story(&damaged).unwrap_err();
    assert!(message.contains(&format!("line {} of", lines.len() * many)), "{message}");
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
