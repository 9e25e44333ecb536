//! Bought heads from nothing to a calibrated dose: the interval that a report states holds for the true pump behind the
//! board.
//!
//! `BOUGHT_HEADS` is the number of heads; `make long` draws 500.
#![allow(clippy::print_stdout, reason = "the runs are there to show their coverage")]

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};

use pump_bench::calibration::{
    Calibration, CalibrationError, CalibrationRun, Earlier, Expected, Fit, Reading, Source,
};
use pump_bench::displacement::PulsePrior;
use pump_bench::pump_file::{OutletEnd, PumpFile};
use pump_bench::report::calibration_text;
use pump_bench::units::stated_reading;
use pump_bench::{Bench, DoseError, DoseReport, DoseRequest, Session};
use pump_ctl::plan::{Cruise, Phase};
use pump_model::{DefaultPulse, Line, Pump};

use crate::plant::{Board, Dice, Fate, Plant};

/// Pulse and tube of the heads over the prior and the data sheet: 1.5 times as wide a law, and 15 % either way.
const WIDER: f64 = 1.5;
const TUBE: f64 = 0.15;

/// Standard deviation of a dose of the true pumps, as a part of it: what a pump file states where nobody measured it.
const REPEATABILITY: f64 = 0.0047;

/// Half width of an angle that a person reads by eye, in rad.
const BY_EYE_RAD: f64 = 0.017_453_292_519_943_295;

/// mL of water of 25 °C for a gram that a balance shows at sea level (table of ISO 8655-6).
const Z_ML_G: f64 = 1.0040;

/// Returns a normal number with mean 0 and standard deviation 1 (Box, Muller 1958).
fn normal(dice: &mut Dice) -> f64 {
    (-2.0 * (1.0 - dice.part()).ln()).sqrt() * (TAU * dice.part()).cos()
}

/// Draws a true pump whose data sheet says `ml_per_rev`. Its pulse has the measured shape of McIntyre et al. What
/// geometry rules out is drawn again: a roller seals over a pitch between two engagements, all in one turn, and takes
/// two thirds of the bore's volume over its own width at most, a pitch at most.
fn true_pump(ml_per_rev: f64, rollers: u32, dice: &mut Dice) -> Pump {
    let prior = PulsePrior::of(rollers);
    let pitch_deg = 360.0 / f64::from(rollers);
    let (phi_deg, share) = loop {
        let phi_deg = prior.engagement_deg * (WIDER * prior.engagement_spread * normal(dice)).exp();
        let fullness = prior.fullness + WIDER * prior.fullness_standard * normal(dice);
        let share = fullness * phi_deg / pitch_deg;
        let fits = 2.0 * phi_deg + pitch_deg <= 360.0 && fullness > 0.0 && fullness <= 2.0 / 3.0;
        if fits && share <= 2.0 / 3.0 {
            break (phi_deg, share);
        }
    };
    let line = Line::PUBLISHED;
    let revolution_ml = ml_per_rev * (1.0 + TUBE * dice.either_way());
    let pump =
        Pump::from_ml_per_rev(revolution_ml, rollers, DefaultPulse::new(share, phi_deg), line, line).unwrap();
    let measured = Pump::three_roller();
    let roller = measured.roller_volume().scaled_to(pump.roller_volume().total_ml()).unwrap();
    let pump = pump.with_roller_volume(roller.stretched_to(phi_deg).unwrap()).unwrap();
    assert!((pump.revolution_ml() / revolution_ml - 1.0).abs() < 1e-9);
    pump
}

/// A person with a new pump, a board and a balance of 0.01 g.
struct Person {
    bench: Bench,
    plant: Arc<Mutex<Plant>>,
    dice: Dice,
    angle_is_known: bool,
}

impl Person {
    fn new(seed: u64, folder: &Path, file: PumpFile, angle_is_known: bool) -> Self {
        let mut dice = Dice(seed);
        let pump = true_pump(file.head.as_ref().unwrap().ml_per_rev, file.rollers.count, &mut dice);
        let plant = Plant {
            pump,
            factor: 1.0,
            angle_rad: dice.part() * TAU,
            count: 0,
            has_count: true,
            tells_resets: false,
            is_reachable: true,
            lets_go: false,
            fall_rad: 0.0,
            event: None,
            fate: Fate::Completes,
            motions: Vec::new(),
            died_in: None,
            dice: Dice(seed + 1_000_000),
        };
        let plant = Arc::new(Mutex::new(plant));
        let bench = Bench::new(file, None, folder).unwrap().driven_by(&Board(Arc::clone(&plant))).unwrap();
        Self { bench, plant, dice, angle_is_known }
    }

    fn session<T>(&mut self, job: impl FnOnce(&mut Session<'_>) -> T) -> T {
        let mut session = Session::with_drive(&self.bench, Box::new(Board(Arc::clone(&self.plant)))).unwrap();
        session.connect().unwrap();
        job(&mut session)
    }

    fn sets_angle(&mut self) {
        let angle_rad = self.plant.lock().unwrap().angle_rad + BY_EYE_RAD * self.dice.either_way();
        let phase = self.angle_is_known.then(|| Phase::within(angle_rad, BY_EYE_RAD));
        self.session(|session| session.set_angle(phase).unwrap());
    }

    /// Doses. Returns the report and the volume that arrives in the vessel, in mL: a drop of 20 to 50 µL hangs at the
    /// nozzle before and after, each time as large as it may be.
    fn doses(&mut self, volume_ml: f64) -> (DoseReport, f64) {
        self.plant.lock().unwrap().motions.clear();
        let bench = self.bench.clone();
        let report = self.session(|session| {
            let prepared = session.prepare(DoseRequest::dose(volume_ml)).unwrap();
            let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
            DoseReport::new(&bench, &prepared, Some(&delivered))
        });
        let turned_ml: f64 = self.plant.lock().unwrap().motions.iter().map(|motion| motion.volume_ml).sum();
        let drop_ml = 0.02 + 0.03 * self.dice.part();
        let kept_ml = drop_ml * (self.dice.part() - self.dice.part());
        (report, turned_ml * (1.0 + REPEATABILITY * normal(&mut self.dice)) + kept_ml)
    }

    /// Doses `volume_ml`, weighs it and calibrates by the reading. Returns false if the angle leaves the dose too
    /// unsure.
    fn calibrates(&mut self, volume_ml: f64) -> bool {
        let (_, arrived_ml) = self.doses(volume_ml);
        let tare_g = 20.0 + self.dice.part();
        let rounded = |grams: f64| (100.0 * grams).round() / 100.0;
        let shown_g = rounded(tare_g + arrived_ml / Z_ML_G) - rounded(tare_g);
        let reading = stated_reading(&format!("{shown_g:.2}g")).unwrap();
        let expected = Expected::of_digits(self.bench.file(), &reading);
        let file = self.bench.file_of_last_dose(None, None).unwrap();
        match self.bench.weigh_last_dose(&file, &reading, Earlier::Joined, &expected) {
            Ok(weighed) => self.bench.keep_calibration(weighed.calibration).unwrap(),
            Err(DoseError::Calibration(CalibrationError::LastDoseFromUnknownAngle { .. })) => return false,
            Err(error) => panic!("{error}"),
        };
        true
    }
}

fn file(ml_per_rev: f64, rollers: u32) -> PumpFile {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/pumps/bought-head.toml");
    let mut file = PumpFile::read(Path::new(path)).unwrap();
    assert_eq!(file.motor.steps_per_rev, 3200);
    file.rollers.count = rollers;
    file.head.as_mut().unwrap().ml_per_rev = ml_per_rev;
    file.pump.default_rate_ml_s = 0.4 * ml_per_rev;
    file
}

/// Returns the part of the doses of each of `volumes_ml` that lie in their intervals, over `heads` heads.
fn covered(file: &PumpFile, heads: u64, volumes_ml: impl Fn(&mut Dice) -> Vec<f64>) -> Vec<f64> {
    let memory = Path::new("/dev/shm");
    let mut inside = Vec::new();
    for seed in 0..heads {
        let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
        let folder = folder.unwrap();
        // Every third person does not know the angle, and weighs whole pitches where the command asks for them.
        let mut person = Person::new(seed, folder.path(), file.clone(), seed % 3 > 0);
        person.sets_angle();
        let pitch_ml = person.bench.model().outlet_curve().pitch_ml();
        let weighed_ml = [5.0, 10.0][seed as usize % 2];
        if !person.calibrates(weighed_ml) {
            assert!(!person.angle_is_known && person.calibrates(pitch_ml * (weighed_ml / pitch_ml).ceil()));
        }
        let volumes_ml = volumes_ml(&mut person.dice);
        inside.resize(volumes_ml.len(), 0);
        for (inside, volume_ml) in inside.iter_mut().zip(volumes_ml) {
            let (report, arrived_ml) = person.doses(volume_ml);
            let error_ml = arrived_ml - report.delivered_ml.unwrap();
            *inside += u64::from(error_ml.abs() <= report.expanded_uncertainty_ml);
        }
    }
    inside.into_iter().map(|inside| inside as f64 / heads as f64).collect()
}

fn heads() -> u64 {
    std::env::var("BOUGHT_HEADS").map_or(40, |heads| heads.parse().unwrap())
}

#[test]
fn doses_of_a_bought_head_lie_in_their_intervals_after_one_weighing() {
    let file = file(0.5, 4);
    let parts = covered(&file, heads(), |dice| vec![5.0, 0.06 * (25.0_f64 / 0.06).powf(dice.part())]);
    println!("{} heads of 0.5 mL: {parts:?} of their doses within the interval", heads());
    assert!(parts.iter().all(|part| *part >= 0.93), "{parts:?}");
}

#[test]
fn doses_of_other_bought_heads_lie_in_their_intervals_after_one_weighing() {
    let (mut sum, mut count) = (0.0, 0.0);
    for (ml_per_rev, rollers) in [(0.05, 12), (0.2, 8), (1.0, 6), (3.0, 3), (20.0, 2), (20.0, 4)] {
        let file = file(ml_per_rev, rollers);
        let parts = covered(&file, heads() / 5, |dice| vec![5.0, 0.06 * (25.0_f64 / 0.06).powf(dice.part())]);
        println!("{} heads of {ml_per_rev} mL and {rollers} rollers: {parts:?}", heads() / 5);
        sum += parts.iter().sum::<f64>();
        count += parts.len() as f64;
    }
    assert!(sum / count >= 0.93, "{}", sum / count);
}

/// Calibrates a head of a data sheet by the readings of runs of 20 revolutions, and plans 6 mL. Returns the plan's
/// volume, its interval and what the calibration says in percent.
fn planned_after(ml_per_rev: f64, source: Source, readings_ml: &[f64]) -> (f64, f64, Vec<String>) {
    let mut file = file(ml_per_rev, 4);
    file.pump.default_rate_ml_s = 0.12;
    file.outlet.end = Some(OutletEnd::Immersed);
    let run = |volume_ml: &f64| CalibrationRun {
        digit: Some(0.001),
        speed_rpm: 25.0,
        start_angle_deg: Some(30.0),
        start_half_width_deg: None,
        turned_deg: 7200.0 + 20.0,
        reading: Reading::VolumeMl(*volume_ml),
        temperature_degc: None,
        time: None,
    };
    let runs: Vec<_> = readings_ml.iter().map(run).collect();
    let expected = Expected::of_runs(&file, &runs);
    let calibration = Calibration::of_runs(&file, source, runs, Fit::Factor, &expected, None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::new(file, None, folder.path()).unwrap();
    let stored = bench.keep_calibration(calibration).unwrap();
    let told = calibration_text(&bench, &stored, None, true, |_| "").unwrap();
    let in_percent = ["runs scatter by", "assumed", "now", "next"];
    let is_said = |line: &&str| in_percent.iter().any(|words| line.trim_start().starts_with(words));
    let said = told.lines().filter(is_said).map(str::to_owned).collect();
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::within(0.0, BY_EYE_RAD))).unwrap();
    let request = DoseRequest::dose(6.0).with_cruise(Cruise::Flow { ml_s: 0.12 });
    let prepared = session.prepare(request).unwrap();
    let report = DoseReport::new(&bench, &prepared, None);
    (report.planned_ml, report.expanded_uncertainty_ml, said)
}

#[test]
fn the_same_readings_give_the_same_doses_whatever_volume_a_data_sheet_states() {
    // Five runs that scatter by 0.791 %, and one alone.
    let five = [5.94, 6.06, 6.00, 5.97, 6.03];
    for (source, readings_ml) in
        [(Source::File, &five[..]), (Source::Last, &five[..]), (Source::Last, &five[2..3])]
    {
        let (planned_ml, interval_ml, said) = planned_after(0.3, source, readings_ml);
        for ml_per_rev in [0.16, 0.21, 0.42, 0.55] {
            let other = planned_after(ml_per_rev, source, readings_ml);
            assert!((other.0 / planned_ml - 1.0).abs() < 1e-6, "{ml_per_rev}: {} {planned_ml}", other.0);
            assert!((other.1 / interval_ml - 1.0).abs() < 1e-4, "{ml_per_rev}: {} {interval_ml}", other.1);
            assert_eq!(other.2, said, "{ml_per_rev}");
        }
        assert!(!said.is_empty());
    }
    let (.., said) = planned_after(0.5, Source::File, &five);
    assert!(said[0].contains("runs scatter by 0.791 %"), "{said:?}");
}
