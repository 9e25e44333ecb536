//! Claims about the command `dose` with a node, in real time. It is killed, or pauses for longer than the board waits.
//!
//! The board goes on by its own clock and knows its count, so the steps of each dose are exact once it is met again.

use std::f64::consts::TAU;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use pump_bench::pump_file::DriverName;
use pump_bench::record::{PumpState, Unfinished};
use pump_bench::{Bench, built_in};
use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

use crate::child;
use crate::racks::compare_log;
use crate::random::Random;
use crate::simulated_node::SimulatedNode;

/// Number of boards at once. They mostly wait.
const BOARDS: u32 = 4;

/// Approximate number of steps that deliver 1 mL.
const STEPS_PER_ML: f64 = 1000.0;

/// Steps per revolution of the pump, and the angle of its rotor before the first dose.
const STEPS_PER_REV: f64 = 12_800.0;
const START_DEG: &str = "30deg";

/// Longest wait for a motor that comes to rest, and the time for which a board hears what was on the line.
const REST: Duration = Duration::from_secs(60);
const LINE: Duration = Duration::from_millis(50);

/// Words of a command that the board did not hear, and of one that heard nothing of the board. A computer that is busy
/// enough comes to both.
const NOT_HEARD: &str = "heard nothing of this program";
const NO_ANSWER: [&str; 2] = ["the board has not answered", "no board answers"];

/// Part of the killed commands that the next one follows at once.
const AT_ONCE: f64 = 0.3;

/// Exit code of a dose that ended in a fault.
const FAULT: i32 = 1;

/// Dose that a pause cuts off, and its rate. It takes four times as long as the board goes on without its host.
const PAUSED: [&str; 3] = ["12mL", "--rate", "3mL/s"];
const PAUSED_ML: f64 = 12.0;

/// Way in which the test cuts the command off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    None,
    Kill,
    /// The command stands still after this part of the dose, until the board has come to rest.
    Pause(f64),
}

/// Counts of the events so far.
#[derive(Debug, Default)]
struct Tally {
    midway: u32,
    resumed: u32,
    accepted: u32,
}

/// Cuts the command off so often, on several boards at once.
pub(crate) fn run(runs: u32, random: &mut Random) {
    let boards: Vec<(u32, Random)> = (0..BOARDS)
        .map(|board| ((runs + board) / BOARDS, Random((random.part() * 2_f64.powi(53)) as u64)))
        .collect();
    let tallies: Vec<Tally> = thread::scope(|scope| {
        let threads: Vec<_> =
            boards.into_iter().map(|(runs, random)| scope.spawn(move || chain(runs, random))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let sum = |of: fn(&Tally) -> u32| tallies.iter().map(of).sum::<u32>();
    let midway = sum(|tally| tally.midway);
    println!(
        "{runs} commands killed and {BOARDS} paused on nodes, {midway} midway, {} resumed to their end, {} accepted: \
         every count exact",
        sum(|tally| tally.resumed),
        sum(|tally| tally.accepted)
    );
    assert!(midway > runs / 4, "too few of them were cut off midway to say much");
}

/// Makes a chain of doses on a board, of which so many are cut off.
fn chain(runs: u32, mut random: Random) -> Tally {
    let mut rig = Rig::new();
    let mut tally = Tally::default();
    let pause = Cut::Pause(0.4 * random.part());
    rig.makes(&PAUSED.map(str::to_owned), PAUSED_ML, pause, &mut random, &mut tally);
    assert!(tally.midway == 1 || rig.is_unheard, "a board made a whole dose without its host");
    rig.ends_the_rest(0, &mut random, &mut tally);
    let mut made = 0;
    while made < runs {
        if rig.is_unheard {
            rig = Rig::new();
        }
        let volume_ml = (0.5 + 3.0 * random.part()) * if random.part() < 0.3 { -1.0 } else { 1.0 };
        let rate = format!("{:.2}mL/s", 2.0 + 4.0 * random.part());
        let mut words = vec![format!("{volume_ml:.3}mL"), "--rate".to_owned(), rate];
        if random.part() < 0.5 {
            words.push("--smooth".to_owned());
        }
        rig.makes(&words, volume_ml.abs(), Cut::Kill, &mut random, &mut tally);
        made += 1;
        made += rig.ends_the_rest(runs - made, &mut random, &mut tally);
    }
    if !rig.is_unheard {
        compare_log(&rig.bench());
    }
    assert_eq!(rig.board.truth().stray, 0, "a motor without current was told to step");
    tally
}

/// Pump with its record and its board.
struct Rig {
    folder: TempDir,
    board: SimulatedNode,
    /// Steps of all doses, those in reverse too.
    turned: u64,
    /// True once the computer was so busy that the command heard nothing of the board for seconds. Its record is then
    /// as unsure as it says, and another board takes the place of this one.
    is_unheard: bool,
    /// Steps of the rest of the dose that is unfinished, those in reverse below 0.
    rest: Option<i64>,
}

/// Returns true if a dose is the one of before. A command that met the board and was killed before the rest knows by
/// the board's count how many steps of it were made.
fn is_same(dose: &Unfinished, begun: &Unfinished) -> bool {
    let bounds = begun.made_least..=begun.made_most;
    dose.intent == begun.intent && bounds.contains(&dose.made_least) && bounds.contains(&dose.made_most)
}

impl Rig {
    fn new() -> Self {
        let rig = Self {
            folder: tempfile::tempdir().unwrap(),
            board: SimulatedNode::start(1).unwrap(),
            turned: 0,
            is_unheard: false,
            rest: None,
        };
        let homed = ["home", "--set", START_DEG, "--tolerance", "0deg"].map(str::to_owned);
        let (code, said) = ended(rig.command(&homed));
        assert_eq!(code, Some(0), "{said}");
        rig
    }

    /// Starts the command with these words.
    fn command(&self, words: &[String]) -> Child {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        for name in ["DOSE_PUMP", "DOSE_CONFIG"] {
            command.env_remove(name);
        }
        command.env("XDG_CONFIG_HOME", self.folder.path()).env("DOSE_STATE_DIR", self.folder.path());
        command.args(words).args(["--confirm-pump", "--driver", "node", "--port"]).arg(self.board.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn bench(&self) -> Bench {
        let bench = Bench::new(built_in("three-roller").unwrap(), Some(DriverName::Node), self.folder.path());
        bench.unwrap().at_port(Some(self.board.path().to_owned())).confirming_pump(true)
    }

    fn state(&self) -> Option<PumpState> {
        self.bench().story().unwrap().state
    }

    fn steps(&self) -> i64 {
        self.board.truth().steps[0]
    }

    /// Waits until the board has heard what is on the line and its motor stands.
    fn comes_to_rest(&self) {
        sleep(LINE);
        let until = Instant::now() + REST;
        while self.board.truth().moving {
            assert!(Instant::now() < until, "the motor turns for ever without its host");
            sleep(Duration::from_millis(5));
        }
    }

    /// Runs a command that doses, until it ends or is cut off, and checks the record.
    fn makes(&mut self, words: &[String], volume_ml: f64, cut: Cut, random: &mut Random, tally: &mut Tally) {
        let (before, started) = (self.state(), self.steps());
        let journal = self.folder.path().join("three-roller/node/journal.jsonl");
        let length = fs::metadata(&journal).map_or(0, |found| found.len());
        let mut process = self.command(words);
        let is_announced = || fs::metadata(&journal).is_ok_and(|now| now.len() > length);
        let has_made = |part: f64| {
            let made = self.steps().abs_diff(started);
            made > 0 && made >= (STEPS_PER_ML * volume_ml * part) as u64
        };
        match cut {
            Cut::None => {}
            Cut::Kill => {
                child::runs_until_a_kill(&mut process, random, &is_announced, &has_made);
                process.kill().unwrap();
            }
            Cut::Pause(part) => {
                if child::runs_for(&mut process, 90.0, &|| has_made(part)) {
                    self.pauses(&process);
                }
            }
        }
        let (code, said) = self.ended(process);
        let begun = before.and_then(|state| state.unfinished);
        if cut == Cut::Kill && random.part() < AT_ONCE {
            let announced =
                self.state().and_then(|state| state.unfinished).filter(|dose| Some(*dose) != begun);
            if let Some(dose) = announced {
                tally.midway += 1;
                return self.resumes_at_once(started, dose.intent.steps, tally);
            }
        }
        self.comes_to_rest();
        let moved = self.steps() - started;
        self.turned += moved.unsigned_abs();
        let (after, said) = (self.state(), format!("{cut:?} of {words:?}, {moved} steps: {code:?} {said}"));
        assert!(cut != Cut::None || code == Some(0) || self.is_busy(&said), "{said}");
        match after.and_then(|state| state.unfinished) {
            Some(dose) if begun.is_some_and(|begun| is_same(&dose, &begun)) => {
                assert_eq!(moved, 0, "the rest was not begun: {said}");
            }
            Some(dose) => {
                let made = moved * dose.intent.steps.signum();
                assert!((dose.made_least..=dose.made_most).contains(&made), "{dose:?}: {said}");
                // A command that lives to hear of the end of its motion knows all of it.
                let is_deaf = code.is_none() || self.is_unheard;
                assert!(is_deaf || dose.made_least == dose.made_most, "{dose:?}: {said}");
                assert!(!matches!(cut, Cut::Pause(_)) || code == Some(FAULT), "{said}");
                self.rest = Some(dose.intent.steps - moved);
                tally.midway += 1;
            }
            None if after == before => assert_eq!(moved, 0, "a dose is lost: {said}"),
            None => {
                // A kill may leave the last word to the next command.
                if let Some(rest) = self.rest.take() {
                    assert_eq!(moved, rest, "{said}");
                    tally.resumed += 1;
                }
            }
        }
    }

    /// Lets the command pause until the board, which hears nothing, has come to rest by itself.
    fn pauses(&self, process: &Child) {
        let process = Pid::from_raw(process.id() as i32).unwrap();
        kill_process(process, Signal::STOP).unwrap();
        self.comes_to_rest();
        kill_process(process, Signal::CONT).unwrap();
    }

    /// Resumes or accepts the unfinished dose until none is left, and checks the record. Some commands are killed, so
    /// many at most. Returns their number.
    fn ends_the_rest(&mut self, kills: u32, random: &mut Random, tally: &mut Tally) -> u32 {
        let mut killed = 0;
        while let Some(dose) = self.state().and_then(|state| state.unfinished)
            && !self.is_unheard
        {
            if random.part() < 0.3 {
                self.accepts(tally);
                continue;
            }
            let cut = if killed < kills && random.part() < 0.3 { Cut::Kill } else { Cut::None };
            let volume_ml = dose.intent.steps.unsigned_abs() as f64 / STEPS_PER_ML;
            self.makes(&["resume".to_owned()], volume_ml, cut, random, tally);
            killed += u32::from(cut == Cut::Kill);
        }
        self.is_exact();
        killed
    }

    /// Resumes a dose whose command was just killed. The motor may still turn. All of its steps are made once.
    fn resumes_at_once(&mut self, started: i64, steps: i64, tally: &mut Tally) {
        let (code, said) = self.ended(self.command(&["resume".to_owned()]));
        self.comes_to_rest();
        let moved = self.steps() - started;
        self.turned += moved.unsigned_abs();
        self.rest = Some(steps - moved).filter(|_| code != Some(0));
        if code == Some(0) {
            assert_eq!(moved, steps, "{said}");
            tally.resumed += 1;
            return;
        }
        assert!(self.is_busy(&said), "{code:?} {said}");
        if self.is_unheard {
            return;
        }
        let dose = self.state().unwrap().unfinished.unwrap();
        let made = (moved - (steps - dose.intent.steps)) * dose.intent.steps.signum();
        assert!((dose.made_least..=dose.made_most).contains(&made), "{dose:?}, {made} steps: {said}");
    }

    /// Returns the exit code of a command that ends, and what it said.
    fn ended(&mut self, process: Child) -> (Option<i32>, String) {
        let (code, said) = ended(process);
        self.is_unheard |= NO_ANSWER.iter().any(|words| said.contains(words));
        (code, said)
    }

    /// Returns true if a command has failed because the computer was too busy to carry its bytes.
    fn is_busy(&self, said: &str) -> bool {
        self.is_unheard || said.contains(NOT_HEARD)
    }

    /// Accepts the unfinished dose. The board tells its exact steps.
    fn accepts(&mut self, tally: &mut Tally) {
        let (code, said) = self.ended(self.command(&["accept".to_owned()]));
        assert!(code == Some(0) || self.is_unheard, "{said}");
        assert!(self.is_unheard || self.state().unwrap().unfinished.is_none(), "{said}");
        self.rest = None;
        tally.accepted += 1;
    }

    /// Checks the record of a pump without an unfinished dose against the board: no step is lost, none counts twice.
    fn is_exact(&self) {
        if self.is_unheard {
            return;
        }
        let Some(state) = self.state() else { return assert_eq!(self.turned, 0, "nothing is on record") };
        let start_rad = TAU / 12.0;
        let stands_rad = start_rad + TAU / STEPS_PER_REV * self.steps() as f64;
        let off = ((state.angle_rad - stands_rad) / TAU * STEPS_PER_REV + 0.5 * STEPS_PER_REV)
            .rem_euclid(STEPS_PER_REV)
            - 0.5 * STEPS_PER_REV;
        let worn = state.wear.revolutions * STEPS_PER_REV - self.turned as f64;
        assert!(off.abs() < 1e-3, "the angle is {off} steps off: {state:?}");
        assert!(worn.abs() < 1e-3, "the tube's turns are {worn} steps off: {state:?}");
    }
}

/// Returns the exit code of a command that ends, and what it said.
fn ended(process: Child) -> (Option<i32>, String) {
    let output = process.wait_with_output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout) + &text(&output.stderr))
}
