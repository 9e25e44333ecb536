//! Doses cut off at random instants, by the death of the process and by a disk that fills up: none is lost, none is counted
//! twice, and what was delivered lies within the bounds on record.
//!
//! `cargo test` runs a few dozen; `make faults` runs 500. The program starts itself again to have something to kill: the
//! child doses, and writes down every so often how many steps it has made, which is the truth that its parent compares
//! the record with.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and says what it did")]

use std::env;
use std::fs;
use std::io::{Read, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_dose::journal::State;
use pump_dose::{Bench, DoseRequest, built_in};

/// Steps between two words of the child.
const WORDS_EVERY: u64 = 256;

fn main() {
    let arguments: Vec<String> = env::args().collect();
    if arguments.get(1).is_some_and(|word| word == "child") {
        return child(&arguments[2], &arguments[3]);
    }
    let runs: u32 = env::var("FAULTS_RUNS").map_or(40, |runs| runs.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0x9E37_79B9_7F4A_7C15 ^ u64::from(std::process::id()));
    // How long a dose takes here: processes are killed within that.
    let began = Instant::now();
    check(folder.path(), 50.0, &mut random, Cut::None);
    let usual_s = began.elapsed().as_secs_f64();
    let (mut midway, mut resumed) = (0, 0);
    for run in 0..runs {
        let volume_ml = 20.0 + 60.0 * random.part();
        check(
            folder.path(),
            volume_ml,
            &mut random,
            if run % 4 == 3 { Cut::FullDisk } else { Cut::Kill { within_s: usual_s } },
        );
        // Resumed until it is through, now and then cut off once more; or accepted as it is.
        while state(folder.path()).is_some_and(|state| state.unfinished.is_some()) {
            midway += 1;
            if random.part() < 0.3 {
                bench(folder.path()).session().unwrap().discard().unwrap();
            } else if random.part() < 0.3 {
                check(folder.path(), 0.0, &mut random, Cut::Kill { within_s: usual_s });
            } else {
                check(folder.path(), 0.0, &mut random, Cut::None);
                resumed += 1;
            }
        }
    }
    println!("{runs} doses, {midway} times cut off midway, {resumed} resumed to their end: nothing lost");
    assert!(midway > runs / 10, "too few of them were cut off midway to say much");
}

/// How a run is cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    None,
    Kill { within_s: f64 },
    FullDisk,
}

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn bench(folder: &Path) -> Bench {
    Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap()
}

fn state(folder: &Path) -> Option<State> {
    bench(folder).story().unwrap().state
}

/// Doses, or resumes, and says how far it is.
fn child(folder: &str, volume_ml: &str) {
    let bench = bench(Path::new(folder));
    let mut session = bench.session().unwrap();
    let request = DoseRequest::dose(volume_ml.parse().unwrap());
    let prepared =
        if request.volume_ml == 0.0 { session.prepare_rest(request) } else { session.prepare(request) };
    let prepared = prepared.unwrap();
    say("begin", prepared.plan.steps.unsigned_abs());
    let delivered = session.run(&prepared, |made| {
        say("made", made);
        ControlFlow::Continue(())
    });
    match delivered {
        Ok(delivered) => say("end", delivered.made),
        Err(error) => {
            say("failed", 0);
            println!("{error}");
        }
    }
}

/// One write, so that a kill leaves a whole line or none.
fn say(word: &str, number: u64) {
    let line = format!("{word} {number}\n");
    std::io::stdout().write_all(line.as_bytes()).and_then(|()| std::io::stdout().flush()).unwrap();
}

fn start(folder: &Path, volume_ml: f64, bytes: Option<u64>) -> Child {
    let this = env::current_exe().unwrap();
    let volume = volume_ml.to_string();
    let mut command = match bytes {
        None => Command::new(&this),
        Some(bytes) => {
            // The shell ignores the signal, so that writing beyond the limit is an error as on a full disk.
            let mut shell = Command::new("bash");
            let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$@\"";
            shell.args(["-c", script, &bytes.to_string()]).arg(&this);
            shell
        }
    };
    command.arg("child").arg(folder).arg(&volume).stdout(Stdio::piped()).spawn().unwrap()
}

/// Runs a dose (0: resumes one), cuts it off and compares the record with what the child has said.
fn check(folder: &Path, volume_ml: f64, random: &mut Random, cut: Cut) {
    let before = state(folder);
    let journal = folder.join("three-roller/sim/journal.jsonl");
    let length = fs::metadata(&journal).map_or(0, |found| found.len());
    let bytes = (cut == Cut::FullDisk).then(|| length + (20_000.0 * random.part()) as u64);
    let mut child = start(folder, volume_ml, bytes);
    if let Cut::Kill { within_s } = cut {
        // Some are killed before they begin, some are through.
        let until = Instant::now() + Duration::from_secs_f64(within_s * random.part());
        while Instant::now() < until && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_micros(500));
        }
        child.kill().unwrap();
    }
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
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
    // What it has really made.
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
                *told.start() <= most && least <= *told.end(),
                "{told:?}, made {least} to {most} in {cut:?}"
            );
            assert!(told.end() - told.start() <= 2000, "{told:?}");
        }
        Some(_) => assert_eq!((least, after), (0, before), "the rest was not begun"),
        None if after == before => assert_eq!(least, 0, "a dose is lost: {said}"),
        None => {
            // Through, and on record; the child may have been killed before it could say so.
            assert!(most == steps, "made {least} to {most} of {steps} in {cut:?}: {said}");
            let worn = |state: Option<State>| state.map_or(0.0, |state| state.wear.revolutions);
            let turned = (worn(after) - worn(before)) * 12_800.0;
            assert!((turned - steps as f64).abs() < 1e-6, "{turned} steps on record of {steps}");
        }
    }
}
