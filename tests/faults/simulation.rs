//! Claims about doses on the simulated drive, cut off by the death of the process and by a full disk.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::record::PumpState;
use pump_bench::{Bench, built_in};

use crate::child;
use crate::random::Random;

/// Number of steps between two lines of the child.
const WORDS_EVERY: u64 = 256;

pub(crate) fn run(runs: u32, random: &mut Random) {
    let folder = tempfile::tempdir().unwrap();
    // The time of a dose here is the time within which processes are killed.
    let began = Instant::now();
    check(folder.path(), 50.0, random, Cut::None);
    let usual_s = began.elapsed().as_secs_f64();
    let (mut midway, mut resumed, mut made) = (0, 0, 0);
    // A machine whose load changes may kill many too early or too late, so more doses follow until enough are cut off.
    while made < runs || (midway <= runs / 10 && made < 4 * runs) {
        let volume_ml = 20.0 + 60.0 * random.part();
        check(
            folder.path(),
            volume_ml,
            random,
            if made % 4 == 3 { Cut::FullDisk } else { Cut::Kill { within_s: usual_s } },
        );
        // The dose is resumed to its end, now and then cut off once more, or accepted as it is.
        while state(folder.path()).is_some_and(|state| state.unfinished.is_some()) {
            midway += 1;
            if random.part() < 0.3 {
                bench(folder.path()).session().unwrap().discard().unwrap();
                continue;
            }
            let is_cut = random.part() < 0.3;
            let cut = if is_cut { Cut::Kill { within_s: usual_s } } else { Cut::None };
            check(folder.path(), 0.0, random, cut);
            resumed += u32::from(!is_cut);
        }
        made += 1;
    }
    println!("{made} doses, {midway} times cut off midway, {resumed} resumed to their end: nothing lost");
    assert!(midway > runs / 10, "too few of them were cut off midway to say much");
}

/// The way in which a run is cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    None,
    Kill { within_s: f64 },
    FullDisk,
}

fn bench(folder: &Path) -> Bench {
    Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap()
}

fn state(folder: &Path) -> Option<PumpState> {
    bench(folder).story().unwrap().state
}

/// Runs a dose, or resumes one (0 mL), cuts it off and compares the record with the child's output.
fn check(folder: &Path, volume_ml: f64, random: &mut Random, cut: Cut) {
    let before = state(folder);
    let journal = folder.join("three-roller/sim/journal.jsonl");
    let length = fs::metadata(&journal).map_or(0, |found| found.len());
    let bytes = (cut == Cut::FullDisk).then(|| length + (20_000.0 * random.part()) as u64);
    // A disk that takes some milliseconds is killed with an entry on its way more often.
    let sync_ms = (random.part() < 0.3).then_some(4.0);
    let mut child = child::start(folder, volume_ml, bytes, sync_ms, None);
    if let Cut::Kill { within_s } = cut {
        // Some processes die before they begin, some end before they are killed.
        let until = Instant::now() + Duration::from_secs_f64(within_s * random.part());
        while Instant::now() < until && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_micros(500));
        }
        child.kill().unwrap();
    }
    let said = child::said(child);
    let words = |wanted: &str| {
        let mut found =
            said.lines().filter_map(|line| line.split_once(' ')).filter(|(word, _)| *word == wanted);
        found.next_back().map(|(_, number)| number.parse::<u64>().unwrap())
    };

    let after = state(folder);
    let Some(steps) = words("begin") else {
        assert_eq!(after, before, "nothing was to happen: {said}");
        return;
    };
    // The child has really made this many steps.
    let (least, most) = match (words("made"), words("end")) {
        (_, Some(made)) => (made, made),
        (Some(made), None) => (made, (made + WORDS_EVERY).min(steps)),
        (None, None) => (0, 0),
    };
    match after.and_then(|state| state.unfinished) {
        Some(dose) if Some(dose) != before.and_then(|state| state.unfinished) => {
            assert!(words("end").is_none(), "it was through: {dose:?}");
            assert_eq!(dose.intent.steps.unsigned_abs(), steps);
            let told = dose.made_least..=dose.made_most;
            assert!(
                *told.start() <= most as i64 && least as i64 <= *told.end(),
                "{told:?}, made {least} to {most} in {cut:?}"
            );
            assert!(told.end() - told.start() <= 2000, "{told:?}");
        }
        // A rest that was begun in the second of the one before, and cut off before its first step, is on record as
        // that one was. Only the number of doses differs.
        Some(_) => {
            let stands = |state: Option<PumpState>| {
                state.map(|state| (state.angle_rad, state.half_width_rad, state.carry_ml, state.unfinished))
            };
            assert_eq!((least, stands(after)), (0, stands(before)), "the rest was not begun");
        }
        None if after == before => assert_eq!(least, 0, "a dose is lost: {said}"),
        None => {
            // The dose is complete and on record. The child may have been killed before it could say so.
            assert!(most == steps, "made {least} to {most} of {steps} in {cut:?}: {said}");
            let worn = |state: Option<PumpState>| state.map_or(0.0, |state| state.wear.revolutions);
            let turned = (worn(after) - worn(before)) * 12_800.0;
            assert!((turned - steps as f64).abs() < 1e-6, "{turned} steps on record of {steps}");
        }
    }
}
