//! Claims about flows over time that are killed: no step is lost, and none is counted twice.

use std::env;
use std::f64::consts::TAU;
use std::io::{BufRead, BufReader, Read, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};

use pump_bench::dosing::FlowProfile;
use pump_bench::record::{LogLine, PumpState, Purpose};
use pump_bench::{Bench, DoseRequest, built_in};
use pump_ctl::plan::Phase;

use crate::random::Random;

/// Flow that rises, drops, pauses and falls.
const PROFILE: &str = "time_s,flow_ml_s\n0,0\n4,4\n4.5,2\n9,3.5\n12,0\n15,0\n17,4\n20,0\n";

/// Steps between two lines of the child.
const WORDS_EVERY: u64 = 256;

/// Widest bounds of the steps that a record may tell after a kill.
const WIDEST: i64 = 2000;

/// Steps per revolution of the pump.
const STEPS_PER_REV: f64 = 12_800.0;

/// Kills so many runs, each after a random number of the motor's own steps.
pub(crate) fn run(runs: u32, random: &mut Random) {
    let folder = tempfile::tempdir().unwrap();
    let whole = check(folder.path(), None);
    let (mut midway, mut ended) = (0, 1);
    for _ in 0..runs {
        check(folder.path(), Some((whole as f64 * random.part()) as u64));
        if state(folder.path()).is_some_and(|state| state.unfinished.is_some()) {
            midway += 1;
            // A run whose times have passed is accepted as it is. A flow over time needs an angle known to a step, and
            // a kill leaves it less sure, so somebody looks at the rotor.
            let bench = bench(folder.path());
            let mut session = bench.session().unwrap();
            session.discard().unwrap();
            session.set_angle(Some(Phase::known(TAU * random.part()))).unwrap();
        }
        ended += 1;
        let logged = bench(folder.path()).log().unwrap().map(Result::unwrap);
        let logged = logged.filter(|line| matches!(line, LogLine::Dose(_))).count();
        assert!(logged <= ended, "{logged} entries of {ended} runs in the log");
    }
    println!("{runs} flows over time killed, {midway} of them midway: nothing lost");
    assert!(midway > runs / 2, "too few of them were cut off midway to say much");
}

fn bench(folder: &Path) -> Bench {
    Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap()
}

fn state(folder: &Path) -> Option<PumpState> {
    bench(folder).story().unwrap().state
}

/// Follows the flow and says every step that the motor makes. The argument is the folder of the records.
pub(crate) fn child(arguments: &[String]) {
    let [folder] = arguments else { panic!("{arguments:?}") };
    let bench = bench(Path::new(folder));
    let mut session = bench.session().unwrap();
    let profile = FlowProfile::parse("killed.csv", PROFILE).unwrap();
    let prepared = session.prepare_profile(DoseRequest::new(Purpose::Run, 0.0), &profile).unwrap();
    let steps = prepared.motion().steps().unsigned_abs();
    let say = |made: u64| {
        let line = format!("{made} {steps}\n");
        // One write, so that a kill leaves a whole line or none.
        std::io::stdout().lock().write_all(line.as_bytes()).unwrap();
    };
    let delivered = session.run_profile(&prepared, |made| {
        say(made);
        ControlFlow::Continue(())
    });
    say(delivered.unwrap().made);
}

/// Runs the flow, kills it once its motor has made `kill_after` steps, and compares the record with what the child
/// said. Returns the steps that were said.
fn check(folder: &Path, kill_after: Option<u64>) -> u64 {
    let worn = || state(folder).map_or(0.0, |state| state.wear.revolutions * STEPS_PER_REV);
    let before = worn();
    let mut child = Command::new(env::current_exe().unwrap())
        .arg("profile")
        .arg(folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let (mut said, mut line) = ((0, 0), String::new());
    while lines.read_line(&mut line).unwrap() > 0 {
        said = heard(&line);
        line.clear();
        if kill_after.is_some_and(|after| said.0 >= after) {
            child.kill().unwrap();
            break;
        }
    }
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    said = rest.lines().last().map_or(said, heard);
    let killed = !child.wait().unwrap().success();
    assert!(kill_after.is_some() || !killed);
    let (made, steps) = said;
    let (recorded, most) = (worn() - before, (made + WORDS_EVERY).min(steps));
    match state(folder).and_then(|state| state.unfinished) {
        Some(run) => {
            let (least_told, most_told) = (run.made_least, run.made_most);
            assert_eq!(run.intent.steps.unsigned_abs(), steps);
            assert!(
                least_told <= most as i64 && made as i64 <= most_told && most_told - least_told <= WIDEST,
                "{least_told} to {most_told} steps on record, {made} to {most} made"
            );
            let told = least_told as f64 - 1.0..=most_told as f64 + 1.0;
            assert!(told.contains(&recorded), "{recorded} steps on record, {least_told} to {most_told} told");
        }
        // The run is whole and on record, or was killed before its first word.
        None => {
            let is_whole = (recorded - steps as f64).abs() < 1e-3 && most == steps;
            assert!(is_whole || (recorded == 0.0 && made == 0), "{recorded} steps on record after {said:?}");
        }
    }
    made
}

fn heard(line: &str) -> (u64, u64) {
    let (made, steps) = line.trim_end().split_once(' ').unwrap();
    (made.parse().unwrap(), steps.parse().unwrap())
}
