//! Claims about racks of three simulated pumps that are killed: no pump loses a dose or counts one twice.

use std::collections::BTreeMap;
use std::env;
use std::io::{BufRead, BufReader, Read, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};

use pump_bench::pump_file::Pace;
use pump_bench::rack::{Rack, RackFile};
use pump_bench::record::{LogLine, PumpState};
use pump_bench::{Bench, DoseError, DoseRequest, built_in};
use pump_ctl::plan::Phase;

use crate::random::Random;

/// Rack that is killed.
const RACK: &str = r#"
schema = "rack/1"
[pumps]
acid = "three-roller"
base = "two-roller"
salt = "three-roller-published"
[[step]]
ratio = { acid = 3, base = 2, salt = 1 }
volume = "24mL"
rate = "12mL/s"
[[step]]
pump = "salt"
volume = "3mL"
[[step]]
ratio = { acid = 1, base = 1 }
volume = "6mL"
rate = "6mL/s"
[[step]]
gradient = { acid = [1, 0], salt = [0, 1] }
rate = "4mL/s"
for = "3s"
"#;

/// Pumps of the rack.
const PUMPS: [(&str, &str); 3] =
    [("acid", "three-roller"), ("base", "two-roller"), ("salt", "three-roller-published")];

/// Angle that is stated after a kill: a gradient needs one that is known to a motor step.
const KNOWN: Option<Phase> = Some(Phase::known(0.3));

/// Steps between two lines of the child.
const WORDS_EVERY: u64 = 256;

/// Steps per revolution of the pumps.
const STEPS_PER_REV: f64 = 12_800.0;

/// Kills so many racks, each after a random number of the motors' own steps.
pub(crate) fn run(runs: u32, random: &mut Random) {
    let folder = tempfile::tempdir().unwrap();
    let whole = check(folder.path(), None);
    let (mut midway, mut resumed, mut accepted) = (0, 0, 0);
    for _ in 0..runs {
        check(folder.path(), Some((whole as f64 * random.part()) as u64));
        for (name, _) in PUMPS {
            if state(folder.path(), name).is_none_or(|state| state.unfinished.is_none()) {
                continue;
            }
            midway += 1;
            let bench = bench(folder.path(), name);
            let mut session = bench.session().unwrap();
            let rest =
                if random.part() < 0.3 { None } else { Some(session.prepare_rest(DoseRequest::dose(0.0))) };
            let rest = match rest {
                Some(Ok(rest)) => rest,
                // Somebody accepts the dose. The times of a gradient have passed, so it has no rest.
                None | Some(Err(DoseError::NoRestOfProfile { .. })) => {
                    session.discard().unwrap();
                    session.set_angle(KNOWN).unwrap();
                    accepted += 1;
                    continue;
                }
                Some(Err(error)) => panic!("{error}"),
            };
            let made = session.run(&rest, |_| ControlFlow::Continue(())).unwrap();
            assert!(made.completed && session.state().unwrap().unfinished.is_none());
            session.set_angle(KNOWN).unwrap();
            resumed += 1;
        }
    }
    for (name, _) in PUMPS {
        compare_log(&bench(folder.path(), name));
    }
    println!(
        "{runs} racks killed, {midway} pumps cut off midway, {resumed} resumed to their end, {accepted} accepted: \
         nothing lost, and each dose is in the log once"
    );
    assert!(midway > runs / 2, "too few of them were cut off midway to say much");
}

fn bench(folder: &Path, name: &str) -> Bench {
    let (_, pump) = PUMPS.iter().find(|(known, _)| *known == name).unwrap();
    Bench::new(built_in(pump).unwrap(), None, folder).unwrap()
}

fn state(folder: &Path, name: &str) -> Option<PumpState> {
    bench(folder, name).story().unwrap().state
}

/// Runs the rack and says every step that the motors make. The argument is the folder of the records.
pub(crate) fn child(arguments: &[String]) {
    let [folder] = arguments else { panic!("{arguments:?}") };
    let file = RackFile::parse(RACK, Path::new("rack.toml")).unwrap();
    let benches = PUMPS.map(|(name, _)| bench(Path::new(folder), name));
    let rack = Rack::new(file, benches.into()).unwrap().paced(Pace::Fast);
    let report = rack.run(|progress| {
        let line = format!("{} {} {} {}\n", progress.pump, progress.step, progress.made, progress.steps);
        // One write, so that a kill leaves a whole line or none.
        std::io::stdout().lock().write_all(line.as_bytes()).unwrap();
    });
    match report {
        Ok(report) => assert!(report.completed, "{}", report.json()),
        Err(error) => panic!("{error:?}"),
    }
}

/// Steps that a child said of a pump.
#[derive(Debug, Default, Clone, Copy)]
struct Said {
    /// Number of the step under way, or of the last one.
    step: usize,
    made: u64,
    steps: u64,
    /// Steps of the parts before.
    before: u64,
}

/// Runs a rack, kills it once its motors have made `kill_after` steps in all, and compares every record with what the
/// child said. Returns the steps that were said in all.
fn check(folder: &Path, kill_after: Option<u64>) -> u64 {
    let before = PUMPS.map(|(name, _)| state(folder, name));
    let mut child = Command::new(env::current_exe().unwrap())
        .arg("rack")
        .arg(folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut said: BTreeMap<String, Said> = BTreeMap::new();
    let mut line = String::new();
    while lines.read_line(&mut line).unwrap() > 0 {
        hear(&mut said, &line);
        line.clear();
        if kill_after.is_some_and(|after| steps_of(&said) >= after) {
            child.kill().unwrap();
            break;
        }
    }
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    rest.lines().for_each(|line| hear(&mut said, line));
    let ended = child.wait().unwrap();
    assert!(kill_after.is_some() || ended.success());
    for ((name, _), before) in PUMPS.iter().zip(before) {
        compare(name, before, state(folder, name), said.get(*name).copied().unwrap_or_default());
    }
    steps_of(&said)
}

fn steps_of(said: &BTreeMap<String, Said>) -> u64 {
    said.values().map(|said| said.before + said.made).sum()
}

fn hear(said: &mut BTreeMap<String, Said>, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [pump, step, made, steps] = words[..] else { panic!("{line}") };
    let said = said.entry(pump.to_owned()).or_default();
    let step = step.parse().unwrap();
    if step != said.step {
        *said = Said { step, before: said.before + said.steps, ..Said::default() };
    }
    (said.made, said.steps) = (made.parse().unwrap(), steps.parse().unwrap());
}

/// Compares a pump's record with the steps that its motor has made.
fn compare(name: &str, before: Option<PumpState>, after: Option<PumpState>, said: Said) {
    let worn = |state: Option<PumpState>| state.map_or(0.0, |state| state.wear.revolutions * STEPS_PER_REV);
    let recorded = worn(after) - worn(before);
    // A part is on record before the child says it, so a kill may come between the two.
    let intended = after.and_then(|state| state.unfinished).map(|dose| dose.intent.steps.unsigned_abs());
    let is_unsaid = intended.is_some_and(|steps| steps != said.steps) && said.made == said.steps;
    let said = match intended {
        Some(steps) if is_unsaid => Said { before: said.before + said.steps, made: 0, steps, ..said },
        _ => said,
    };
    let (least, most) = (said.made, (said.made + WORDS_EVERY).min(said.steps));
    match after.and_then(|state| state.unfinished) {
        Some(dose) => {
            assert_eq!(dose.intent.steps.unsigned_abs(), said.steps, "{name}: {said:?}");
            let (told_least, told_most) = (dose.made_least, dose.made_most);
            assert!(
                told_least <= most as i64 && least as i64 <= told_most && told_most - told_least <= 2000,
                "{name}: {told_least} to {told_most} steps on record, {least} to {most} made"
            );
            let first = said.before as f64;
            assert!(
                (first + told_least as f64 - 1.0..=first + told_most as f64 + 1.0).contains(&recorded),
                "{name}: {recorded} steps on record after {said:?}"
            );
        }
        None => {
            // The part is whole and on record, or was not begun: the child says a part before its first step.
            let is_whole = (recorded - (said.before + said.steps) as f64).abs() < 1e-3 && most == said.steps;
            let is_unbegun = (recorded - said.before as f64).abs() < 1e-3 && said.made == 0;
            assert!(is_whole || is_unbegun, "{name}: {recorded} steps on record after {said:?}");
        }
    }
}

/// Compares a pump's log with its record: the doses are numbered without a gap, and their volumes are those that the
/// tube has pumped, to the bounds of those that were cut off.
pub(crate) fn compare_log(bench: &Bench) {
    drop(bench.session().unwrap());
    let doses = bench.log().unwrap().map(|line| match line.unwrap() {
        LogLine::Dose(entry) => entry,
        other => panic!("{other:?}"),
    });
    let (mut count, mut logged_ml, mut unsure_ml) = (0, 0.0, 0.0);
    for dose in doses {
        count += 1;
        assert_eq!(dose.number, count, "a dose is lost or doubled: {dose:?}");
        let (least_ml, most_ml) = dose.delivered_range_ml.unwrap_or((dose.delivered_ml, dose.delivered_ml));
        logged_ml += dose.delivered_ml.abs();
        // A step more or less is the rounding of a dose, and the tube wears by the most that may have been made.
        unsure_ml += most_ml - least_ml + 4e-3;
    }
    let worn_ml = bench.stands().unwrap().wear.volume_ml;
    assert!(
        (logged_ml - worn_ml).abs() <= unsure_ml,
        "{logged_ml} mL in {count} doses of the log, {worn_ml} mL through the tube, to {unsure_ml} mL"
    );
}
