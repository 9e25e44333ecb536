//! Claims about doses on a simulated board at the end of a pseudo-terminal.
//!
//! The death of the process, a defect of the board or a full disk cuts each dose off. The board counts the
//! steps that its motor has made, and the bounds on record must hold that count.

use std::fs;
use std::path::{Path, PathBuf};

use pump_bench::pump_file::DriverName;
use pump_bench::record::PumpState;
use pump_bench::{Bench, built_in};
use pump_ctl::plan::Phase;

use crate::child;
use crate::random::Random;
use crate::simulated::Simulated;
use crate::simulated::options::{Defects, Options};

/// Speed of these boards over that of a real board.
const TIME_SCALE: f64 = 8.0;

/// Approximate number of steps of the largest dose here.
const LONGEST: f64 = 2500.0;

/// Approximate number of steps that deliver 1 mL.
const STEPS_PER_ML: f64 = 1000.0;

/// Number of doses on each board.
const DOSES_A_BOARD: u32 = 4;

/// Angle of a step, rad.
const STEP_RAD: f64 = std::f64::consts::TAU / 12_800.0;

/// A pump, its record and its current board.
struct Rig {
    folder: PathBuf,
    board: Simulated,
    /// Angle of the rotor when the board's motor had made no step, rad.
    stood_rad: f64,
    /// Steps by which the board's counter jumps. A jump in the midst of a motion looks like the motion, so the
    /// record may be wrong by it.
    jump: i64,
}

/// The way in which the test cuts a dose off. The board has defects of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    None,
    Kill,
    FullDisk,
}

/// The counts of the events so far.
#[derive(Default)]
struct Tally {
    midway: u32,
    exact: u32,
    resumed: u32,
    unknown: u32,
}

pub(crate) fn run(runs: u32, random: &mut Random) {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = Rig::new(folder.path(), random, 0.4);
    let mut tally = Tally::default();
    let mut made = 0;
    // A slow machine may miss the motion of many doses, so more doses follow until enough are cut off midway.
    while made < runs || (tally.midway <= runs / 8 && made < 4 * runs) {
        if made % DOSES_A_BOARD == 0 {
            let stands_rad = rig.truth_rad();
            rig = Rig::new(folder.path(), random, stands_rad);
            rig.home();
        }
        rig.dose(random, &mut tally);
        made += 1;
    }
    let Tally { midway, exact, resumed, unknown } = tally;
    println!(
        "{made} doses on boards, {midway} cut off midway, {exact} of them known exactly from the board's count, \
         {resumed} resumed, {unknown} times the angle was unknown and said so: nothing lost"
    );
    assert!(midway > runs / 8, "too few of them were cut off midway to say much");
    assert!(runs < 100 || (exact > 0 && unknown > 0), "a kind of ending never came");
}

impl Rig {
    /// Switches a board on. Three boards in four have a defect.
    fn new(folder: &Path, random: &mut Random, stood_rad: f64) -> Self {
        let at = (LONGEST * 2.0 * random.part()) as u64;
        let mut defects = Defects { seed: at, ..Defects::default() };
        match (12.0 * random.part()) as u32 {
            0 => defects.alarm = Some((at, 1)),
            1 => defects.refuses = Some((1 + at as u32 / 100, 15)),
            2 => defects.resets = Some(at),
            3 => defects.silent = Some(at),
            4 => defects.stalls = Some(at),
            5 => defects.miscounts = Some((at, 40)),
            6 => defects.unplugged = Some(at),
            7 => defects.lost_cancels = 3,
            8 => (defects.noise, defects.chopped) = (true, true),
            _ => {}
        }
        Self::with(folder, stood_rad, random.part() < 0.3, defects)
    }

    /// Switches a board without defects on.
    fn healthy(folder: &Path, stood_rad: f64) -> Self {
        Self::with(folder, stood_rad, false, Defects::default())
    }

    fn with(folder: &Path, stood_rad: f64, resets_on_open: bool, defects: Defects) -> Self {
        let jump = defects.miscounts.map_or(0, |(_, by)| by);
        let options = Options { time_scale: TIME_SCALE, resets_on_open, defects, ..Options::default() };
        Self { folder: folder.to_owned(), board: Simulated::start(options).unwrap(), stood_rad, jump }
    }

    fn bench(&self) -> Bench {
        let bench = Bench::new(built_in("three-roller").unwrap(), Some(DriverName::Grbl), &self.folder);
        bench.unwrap().at_port(Some(self.board.path().to_owned())).confirming_pump(true)
    }

    fn state(&self) -> Option<PumpState> {
        self.bench().story().unwrap().state
    }

    /// Returns the true angle of the rotor, rad.
    fn truth_rad(&self) -> f64 {
        self.stood_rad + self.board.rest().steps as f64 * STEP_RAD
    }

    /// Sets the rotor's angle on record to the true angle, on a board that has not moved yet.
    fn home(&self) {
        let bench = self.bench();
        let mut session = bench.session().unwrap();
        if session.state().is_some_and(|state| state.unfinished.is_some()) {
            session.discard().unwrap();
        }
        session.set_angle(Some(Phase::known(self.truth_rad()))).unwrap();
    }

    /// Checks the record against the true angle. Returns true if the angle is known.
    fn holds(&self, state: &PumpState, what: &str) -> bool {
        let pitch_rad = std::f64::consts::TAU / 3.0;
        if state.half_width_rad >= 0.5 * pitch_rad {
            return false;
        }
        let off_rad = [0, self.jump].map(|jump| {
            let stands_rad = self.truth_rad() + jump as f64 * STEP_RAD;
            (stands_rad - state.angle_rad + 0.5 * pitch_rad).rem_euclid(pitch_rad) - 0.5 * pitch_rad
        });
        assert!(
            off_rad.iter().any(|off_rad| off_rad.abs() <= state.half_width_rad + 1e-9),
            "{what}: {} steps off, {} said: {state:?}",
            off_rad[0] / STEP_RAD,
            state.half_width_rad / STEP_RAD
        );
        true
    }

    /// Runs a dose, or the rest of one (0 mL), until it ends or is cut off, and checks the record.
    fn cut(&self, random: &mut Random, volume_ml: f64, cut: Cut) {
        let before = self.state();
        let started = self.board.rest().steps;
        let journal = self.folder.join("three-roller/grbl/journal.jsonl");
        let length = fs::metadata(&journal).map_or(0, |found| found.len());
        let bytes = (cut == Cut::FullDisk).then(|| length + (3000.0 * random.part()) as u64);
        // At this board's speed the disk may take a tenth of a second before the motor pauses for it.
        let sync_ms = (random.part() < 0.4).then(|| 150.0 * random.part());
        let mut process = child::start(&self.folder, volume_ml, bytes, sync_ms, Some(self.board.path()));
        match cut {
            Cut::Kill => {
                let is_announced = || fs::metadata(&journal).is_ok_and(|now| now.len() > length);
                let has_made = |part: f64| {
                    let made = self.board.truth().steps.abs_diff(started);
                    made >= (STEPS_PER_ML * volume_ml.abs() * part) as u64
                };
                child::runs_until_a_kill(&mut process, random, &is_announced, &has_made);
            }
            Cut::None | Cut::FullDisk => {
                let runs = child::runs_for(&mut process, 120.0, &|| false);
                assert!(!runs, "a dose without an end");
            }
        }
        process.kill().unwrap();
        let said = child::said(process);
        let moved = self.board.rest().steps - started;
        let after = self.state();
        let Some(state) = after else {
            assert_eq!(moved, 0, "nothing is on record: {said}");
            return;
        };
        let known = self.holds(&state, &said);
        match state.unfinished {
            Some(dose) if Some(dose) != before.and_then(|state| state.unfinished) => {
                let made = [moved, moved + self.jump].map(|moved| moved * dose.intent.steps.signum());
                assert!(
                    !known || made.iter().any(|made| (dose.made_least..=dose.made_most).contains(made)),
                    "{} steps made: {dose:?}; {said}",
                    made[0]
                );
            }
            Some(_) => assert_eq!(moved, 0, "the rest was not begun: {said}"),
            None if after == before => assert_eq!(moved, 0, "a dose is lost: {said}"),
            None => {}
        }
    }

    fn dose(&mut self, random: &mut Random, tally: &mut Tally) {
        let volume_ml = (0.5 + 2.0 * random.part()) * if random.part() < 0.3 { -1.0 } else { 1.0 };
        let cut = match random.part() {
            part if part < 0.6 => Cut::Kill,
            part if part < 0.7 => Cut::FullDisk,
            _ => Cut::None,
        };
        self.cut(random, volume_ml, cut);
        for _ in 0..3 {
            let Some(state) = self.state() else { return };
            let Some(dose) = state.unfinished else { break };
            tally.midway += 1;
            // The board may know more when a session meets it again.
            let bench = self.bench();
            let mut session = bench.session().unwrap();
            if session.connect().is_err() {
                // The board does not answer any more. It is switched off and on.
                drop(session);
                *self = Self { jump: self.jump, ..Self::healthy(&self.folder, self.truth_rad()) };
                continue;
            }
            let met = *session.state().unwrap();
            self.holds(&met, "met again");
            let exact = met.unfinished.is_some_and(|now| now.made_least == now.made_most);
            tally.exact += u32::from(exact && dose.made_least < dose.made_most);
            if random.part() < 0.4 {
                if session.state().is_some_and(|state| state.unfinished.is_some()) {
                    session.discard().unwrap();
                }
                break;
            }
            drop(session);
            self.cut(random, 0.0, Cut::None);
            tally.resumed += 1;
        }
        let unknown = self.state().is_some_and(|state| !self.holds(&state, "at the end"));
        tally.unknown += u32::from(unknown);
    }
}
