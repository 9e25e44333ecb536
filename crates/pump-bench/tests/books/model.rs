//! Random sequences of operations against an account of the truth: what is stated holds for the true rotor.
//!
//! `BOOKS_RUNS` is the number of sequences, and `BOOKS_FIRST` the number of the first one.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::{Arc, Mutex};

use pump_bench::calibration::{Calibration, CalibrationRun, Expected, Fit, Reading, Source};
use pump_bench::drives::Disturbance;
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseReport, DoseRequest, Prepared, Session};
use pump_ctl::plan::{Cruise, Finish, Phase};
use pump_model::units::{TURN_RAD, rad_s};

use crate::bench::file;
use crate::plant::{Board, Dice, Fate, Killed, Plant};

const ROUNDING: f64 = 1e-7;

/// An unfinished dose, in truth.
#[derive(Debug, Clone, Copy)]
struct Whole {
    purpose: Purpose,
    requested_ml: f64,
    delivered_ml: f64,
}

struct Run {
    bench: Bench,
    plant: Arc<Mutex<Plant>>,
    dice: Dice,
    /// Volume asked for and not delivered since the carry was last dropped, in mL.
    carry_ml: f64,
    whole: Option<Whole>,
    told: Vec<String>,
}

impl Run {
    fn new(seed: u64, folder: &Path) -> Self {
        let file = file();
        let mut dice = Dice(seed);
        let fall_rad = 2.0 * TURN_RAD / (f64::from(file.motor.full_steps_per_rev) * file.motor.gear);
        let plant = Plant {
            pump: file.model().unwrap(),
            factor: 1.0,
            angle_rad: dice.part() * TURN_RAD,
            count: 1000,
            has_count: dice.chance(0.7),
            tells_resets: seed.is_multiple_of(2),
            is_reachable: true,
            lets_go: dice.chance(0.15),
            fall_rad,
            event: None,
            fate: Fate::Completes,
            motions: Vec::new(),
            died_in: None,
            dice: Dice(seed + 1_000_000),
        };
        let plant = Arc::new(Mutex::new(plant));
        let board = Board(Arc::clone(&plant));
        let bench = Bench::new(file, None, folder).unwrap().driven_by(&board).unwrap();
        Self { bench, plant, dice, carry_ml: 0.0, whole: None, told: Vec::new() }
    }

    /// Does `job` in a session of its own. Returns `None` if the process died.
    fn session<T>(&mut self, fate: Fate, job: impl FnOnce(&mut Session<'_>, &Bench) -> T) -> Option<T> {
        self.plant.lock().unwrap().fate = fate;
        self.plant.lock().unwrap().motions.clear();
        self.plant.lock().unwrap().is_reachable = true;
        let (bench, board) = (self.bench.clone(), Board(Arc::clone(&self.plant)));
        let done = catch_unwind(AssertUnwindSafe(|| {
            let mut session = Session::with_drive(&bench, Box::new(board)).unwrap();
            session.connect().unwrap();
            job(&mut session, &bench)
        }));
        match done {
            Ok(done) => Some(done),
            Err(payload) if Killed::is(payload.as_ref()) => {
                let (_, part) = self.bench.story().unwrap().cut_off.unwrap();
                let spread = (part.made_most - part.made_least).unsigned_abs();
                let made = part.made_least.unsigned_abs() + self.dice.up_to(spread);
                self.plant.lock().unwrap().dead_after(made);
                None
            }
            Err(payload) => resume_unwind(payload),
        }
    }

    fn fate(&mut self) -> Fate {
        let look = self.dice.up_to(30);
        match self.dice.up_to(11) {
            0..=4 => Fate::Completes,
            9 | 10 => Fate::Unplugs(look),
            5 => Fate::Stops(look),
            6 | 7 => Fate::Dies(look),
            8 => Fate::Fails(look),
            _ => {
                if self.dice.chance(0.3) {
                    Fate::Derails(look)
                } else {
                    Fate::Fails(look)
                }
            }
        }
    }

    fn request(&mut self) -> DoseRequest {
        let purpose = match self.dice.up_to(9) {
            0 => Purpose::Prime,
            1 => Purpose::Calibrate,
            _ => Purpose::Dose,
        };
        let volume_ml = (0.2 + 3.0 * self.dice.part()) * if self.dice.chance(0.2) { -1.0 } else { 1.0 };
        let retract = purpose == Purpose::Dose && self.dice.chance(0.25);
        DoseRequest::new(purpose, volume_ml)
            .with_cruise(self.dice.chance(0.5).then(|| Cruise::Flow { ml_s: 1.0 + 9.0 * self.dice.part() }))
            .with_finish(self.dice.chance(0.1).then_some(Finish::LowFlow))
            .with_retraction(retract.then(|| 0.5 * volume_ml.abs() * self.dice.part() + 0.01))
    }

    /// Prepares and runs a dose or the rest of one, and notes the truth.
    fn doses(&mut self, request: DoseRequest, rest: bool) {
        let fate = self.fate();
        self.told.push(format!("{}{request:?}, {fate:?}", if rest { "rest " } else { "" }));
        let prepared: RefCell<Option<Prepared>> = RefCell::new(None);
        let stated = self.session(fate, |session, bench| {
            let found = if rest { session.prepare_rest(request) } else { session.prepare(request) };
            let found = found.ok()?;
            *prepared.borrow_mut() = Some(found.clone());
            let delivered = session.run(&found, |_| ControlFlow::Continue(())).ok()?;
            Some(DoseReport::new(bench, &found, Some(&delivered)))
        });
        let Some(prepared) = prepared.into_inner() else {
            self.told.push("refused".to_owned());
            return;
        };
        let mut motions = self.plant.lock().unwrap().motions.clone();
        if prepared.request.purpose == Purpose::Calibrate {
            // Weighed runs are booked by the model without calibration: the scale tells their volume.
            motions.iter_mut().for_each(|motion| motion.volume_ml = motion.uncalibrated_ml);
        }
        let Some(first) = motions.first() else { return };
        if prepared.request.purpose == Purpose::Retract {
            self.carry_ml -= first.volume_ml;
        } else {
            let purpose = prepared.request.purpose;
            let whole = self.whole.take().filter(|_| rest);
            let whole = whole.unwrap_or(Whole {
                purpose,
                requested_ml: prepared.plan.requested_ml(),
                delivered_ml: 0.0,
            });
            self.whole = Some(Whole { delivered_ml: whole.delivered_ml + first.volume_ml, ..whole });
        }
        // The way back follows a dose that was finished.
        for back in motions.iter().skip(1) {
            self.carry_ml -= back.volume_ml;
        }
        if let Some(report) = stated.flatten() {
            let range = report.volume_least_ml - ROUNDING..=report.volume_most_ml + ROUNDING;
            assert!(range.contains(&first.volume_ml), "{first:?} is not within {range:?}");
            self.settle();
            if report.completed && report.purpose == Purpose::Dose && !self.plant.lock().unwrap().lets_go {
                let off_ml = (report.carry_ml - self.carry_ml).abs();
                assert!(off_ml <= report.carry_half_width_ml + ROUNDING, "carry reported: off by {off_ml}");
            }
        }
    }

    /// Adds a dose that is no longer unfinished to the carry.
    fn settle(&mut self) {
        if self.bench.stands().unwrap().unfinished.is_none()
            && let Some(whole) = self.whole.take()
            && whole.purpose == Purpose::Dose
        {
            self.carry_ml += whole.requested_ml - whole.delivered_ml;
        }
    }

    fn homes(&mut self) {
        let angle_rad = self.plant.lock().unwrap().angle_rad;
        let half_width_rad = [0.0, 0.01, 0.3][self.dice.up_to(2) as usize];
        let phase = Phase::within(angle_rad + half_width_rad * self.dice.either_way(), half_width_rad);
        let phase = self.dice.chance(0.6).then_some(phase);
        self.bench = self.bench.clone().homing_unfinished(self.dice.chance(0.5));
        let kept = self.whole.is_some();
        let set = self.session(Fate::Completes, |session, _| session.set_angle(phase).is_ok());
        self.told.push(format!("home {phase:?}: {set:?}, kept {kept}"));
        self.settle();
        if set == Some(true) && self.whole.is_none() {
            self.carry_ml = 0.0;
        }
    }

    /// Puts a tube of another volume in place and keeps the calibration that finds it, or goes back to the drawing. The
    /// record refuses both while a dose is unfinished.
    fn calibrates(&mut self) {
        let factor = if self.dice.chance(0.3) { 1.0 } else { 0.9 + 0.2 * self.dice.part() };
        let kept = if factor == 1.0 {
            self.bench.use_calibration(None)
        } else {
            let run = CalibrationRun {
                digit: None,
                speed_rpm: 60.0,
                start_angle_deg: None,
                start_half_width_deg: None,
                turned_deg: 720.0,
                reading: Reading::VolumeMl(2.0 * factor * self.bench.model().revolution_ml()),
                temperature_degc: None,
                time: None,
            };
            let (file, expected) = (self.bench.file(), Expected::of(self.bench.file(), 0.0));
            let found = Calibration::of_runs(file, Source::File, vec![run], Fit::Factor, &expected, None);
            self.bench.keep_calibration(found.unwrap()).map(drop)
        };
        self.told.push(format!("calibrated to {factor}: {kept:?}"));
        assert_eq!(kept.is_ok(), self.whole.is_none());
        if kept.is_ok() {
            self.plant.lock().unwrap().factor = factor;
        }
    }

    /// Turns the rotor as a person does with the arrow keys. What it pumps is owed to nobody.
    fn jogs(&mut self) {
        let turn_rad = 0.3 * self.dice.either_way();
        let turned = self.session(Fate::Completes, |session, _| {
            let steps = session.steps_of(turn_rad);
            session.jog(steps, rad_s(20.0), |_| ControlFlow::Continue(())).is_ok()
        });
        self.told.push(format!("jog {turn_rad}: {turned:?}"));
    }

    fn operate(&mut self) {
        match self.dice.up_to(13) {
            12 => self.calibrates(),
            13 => self.jogs(),
            0..=4 if self.whole.is_none() => {
                let request = self.request();
                self.doses(request, false);
            }
            0..=6 => {
                let cruise = self.dice.chance(0.2).then_some(Cruise::Flow { ml_s: 3.0 });
                let finish = self.dice.chance(0.1).then_some(Finish::Any);
                self.doses(DoseRequest::dose(0.0).with_cruise(cruise).with_finish(finish), true);
            }
            7 => {
                if self.session(Fate::Completes, |session, _| session.discard().is_ok()) == Some(true) {
                    (self.carry_ml, self.whole) = (0.0, None);
                    self.told.push("accepted".to_owned());
                }
            }
            8 => {
                self.session(Fate::Completes, |session, _| session.release().unwrap());
                self.plant.lock().unwrap().falls();
                self.told.push("released".to_owned());
            }
            9 => self.homes(),
            10 => {
                if self.session(Fate::Completes, |session, _| session.new_tube().is_ok()) == Some(true) {
                    (self.carry_ml, self.whole) = (0.0, None);
                    self.plant.lock().unwrap().factor = 1.0;
                    self.told.push("new tube".to_owned());
                }
            }
            _ if self.bench.stands().unwrap().released => {}
            _ => {
                let mut plant = self.plant.lock().unwrap();
                plant.count = 0;
                plant.disturb(Disturbance::Reset);
                self.told.push("power off and on".to_owned());
            }
        }
        self.settle();
    }

    /// Compares the record with the truth.
    fn check(&self) {
        let (state, pump) = (self.bench.stands().unwrap(), self.bench.model());
        let plant = self.plant.lock().unwrap();
        if plant.event.is_none() {
            let pitch_rad = pump.pitch_rad();
            let off_rad = (plant.angle_rad - state.angle_rad + 0.5 * pitch_rad).rem_euclid(pitch_rad);
            let off_rad = (off_rad - 0.5 * pitch_rad).abs();
            assert!(off_rad <= state.half_width_rad + ROUNDING, "angle: off by {off_rad} in {state:?}");
        }
        let (off_ml, within_ml) = ((state.carry_ml - self.carry_ml).abs(), state.carry_within_ml(pump));
        assert!(off_ml <= within_ml + ROUNDING, "carry: off by {off_ml} in {state:?}");
        match (state.unfinished, self.whole) {
            (Some(part), Some(whole)) => {
                let (least_ml, most_ml) = part.delivered_ml(pump);
                let range = least_ml - ROUNDING..=most_ml + ROUNDING;
                assert!(range.contains(&whole.delivered_ml), "{whole:?} is not within {range:?}");
            }
            (None, None) => {}
            both => panic!("{both:?}"),
        }
    }
}

#[test]
fn what_the_record_states_holds_for_the_true_rotor() {
    let number = |name: &str, usual: u64| std::env::var(name).map_or(usual, |number| number.parse().unwrap());
    let first = number("BOOKS_FIRST", 0);
    for seed in first..first + number("BOOKS_RUNS", 300) {
        let memory = Path::new("/dev/shm");
        let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
        let folder = folder.unwrap();
        let mut run = Run::new(seed, folder.path());
        run.session(Fate::Completes, |session, _| session.set_angle(None).unwrap());
        let checked = catch_unwind(AssertUnwindSafe(|| {
            for _ in 0..12 {
                run.operate();
                run.check();
            }
        }));
        assert!(checked.is_ok(), "sequence {seed}: {:#?}", run.told);
    }
}
