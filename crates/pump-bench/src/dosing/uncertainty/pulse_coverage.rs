//! Coverage of small doses of pumps whose roller volume is another than the pump file's, once weighed runs and
//! short doses have calibrated them.
//!
//! The pumps here are computed apart from the model: V(x) is the integral of the published polynomial's rising
//! part by sums over a fine grid, and a volume is a turn less what the rollers give back (PHYSICS of McIntyre
//! et al.: q = a - sum g(phi - p)).

use std::f64::consts::TAU;

use pump_ctl::plan::{Cruise, Phase, Request};
use pump_model::units::{degrees, rad_s, radians};

use crate::calibration::{Calibration, CalibrationRun, Expected, Fit, Reading, ShortDose, Source, Stored};
use crate::displacement::SpeedDependentPump;
use crate::dosing::planner::Planner;
use crate::dosing::{Budget, Swept};
use crate::pump_file::PumpFile;
use crate::sampling::Dice;

const PLANTS: u32 = 600;
const VOLUMES_ML: [f64; 4] = [0.5, 1.0, 2.0, 3.0];

/// Standard deviation of a dose, as a part of it, and of a reading, in mL.
const REPEATABILITY: f64 = 0.0047;
const READING_ML: f64 = 0.002;

/// V(x) of the paper's polynomial over its engagement angle, 1 at the end.
pub(super) struct Shape(Vec<f64>);

impl Shape {
    const POINTS: usize = 20_000;

    pub(super) fn published() -> Self {
        // mL over deg, lowest order first (McIntyre et al., fitted to the mean of seven rollers).
        const C: [f64; 6] = [
            -2.870791521667906e-4,
            -3.158742581049441e-3,
            2.7926272254840817e-3,
            -8.751039956479692e-6,
            -1.2381057474044833e-6,
            1.3157682477570371e-8,
        ];
        let volume = |deg: f64| C.iter().rev().fold(0.0, |sum, c| sum * deg + c);
        let grid = |n: usize| volume(50.53 * n as f64 / Self::POINTS as f64);
        let mut sums = vec![0.0];
        for n in 0..Self::POINTS {
            sums.push(sums[n] + (grid(n + 1) - grid(n)).max(0.0));
        }
        let total = sums[Self::POINTS];
        assert!((total - 2.105466).abs() < 1e-5, "{total}");
        Self(sums.iter().map(|sum| sum / total).collect())
    }

    pub(super) fn at(&self, part: f64) -> f64 {
        let place = part.clamp(0.0, 1.0) * Self::POINTS as f64;
        let n = (place as usize).min(Self::POINTS - 1);
        self.0[n] + (self.0[n + 1] - self.0[n]) * (place - n as f64)
    }
}

/// A pump of three rollers.
struct Plant<'a> {
    shape: &'a Shape,
    revolution_ml: f64,
    roller_ml: f64,
    phi_rad: f64,
    zero_rad: f64,
}

impl Plant<'_> {
    /// Volume that the rollers have left to give back at an angle, in mL: V of the roller that leaves.
    fn left_ml(&self, angle_rad: f64) -> f64 {
        let away_rad = (angle_rad + self.zero_rad).rem_euclid(TAU / 3.0);
        self.roller_ml * self.shape.at((self.phi_rad - away_rad) / self.phi_rad)
    }

    fn volume_ml(&self, from_rad: f64, turn_rad: f64) -> f64 {
        let nominal_ml_rad = (self.revolution_ml + 3.0 * self.roller_ml) / TAU;
        let place = |angle_rad: f64| ((angle_rad + self.zero_rad) / (TAU / 3.0)).floor();
        let pulses = place(from_rad + turn_rad) - place(from_rad);
        let given_ml = pulses * self.roller_ml + self.left_ml(from_rad) - self.left_ml(from_rad + turn_rad);
        nominal_ml_rad * turn_rad - given_ml
    }

    fn delivers_ml(&self, from_rad: f64, turn_rad: f64, dice: &mut Dice) -> f64 {
        self.volume_ml(from_rad, turn_rad) * (1.0 + REPEATABILITY * dice.normal())
    }
}

/// Returns the pump file, whose doses scatter by the same part at every volume, as the pumps here do.
fn pump_file() -> PumpFile {
    let mut file = crate::catalogue::built_in("three-roller").unwrap();
    file.uncertainty.repeatability_at_ml = Some(VOLUMES_ML[0]);
    file
}

/// Calibrates with one weighed run, which shows no scatter of its own, and with short doses.
fn calibrated(file: &PumpFile, plant: &Plant<'_>, dice: &mut Dice) -> Calibration {
    let runs = vec![CalibrationRun {
        digit: None,
        speed_rpm: 20.0,
        start_angle_deg: None,
        start_half_width_deg: None,
        turned_deg: 1800.0,
        reading: Reading::VolumeMl(
            plant.delivers_ml(0.3, radians(1800.0), dice) + READING_ML * dice.normal(),
        ),
        temperature_degc: None,
        time: None,
    }];
    let expected = Expected::new(REPEATABILITY, READING_ML);
    let weighed = Calibration::of_runs(file, Source::File, runs, Fit::Line, &expected, None).unwrap();
    let doses = (0..24)
        .map(|n| {
            let start_angle_deg = 5.0 * f64::from(n);
            let volume_ml =
                plant.delivers_ml(radians(start_angle_deg), radians(24.0), dice) + READING_ML * dice.normal();
            ShortDose { start_angle_deg, turned_deg: 24.0, volume_ml, speed_rpm: None }
        })
        .collect();
    Calibration::of_short_doses(file, doses, &expected, Some(&weighed)).unwrap().0
}

/// Returns the part of the doses of each volume within the interval that was stated, of pumps with
/// `roller_part` of the model's roller volume. `change` is what happens to a calibration before it is used.
fn covered(roller_part: f64, change: impl Fn(&PumpFile, Calibration) -> Calibration) -> [f64; 4] {
    let file = pump_file();
    let pump = SpeedDependentPump::constant(file.model().unwrap());
    let (shape, limits, mut dice) = (Shape::published(), file.limits(), Dice::new(2028));
    let mut inside = [0; 4];
    for _ in 0..PLANTS {
        let plant = Plant {
            shape: &shape,
            revolution_ml: 21.3185 * (1.0 + 0.024 * dice.normal()),
            roller_ml: 2.105466 * roller_part,
            phi_rad: radians(50.53 + dice.normal()),
            zero_rad: radians(120.0 * dice.uniform()),
        };
        let stored = Stored { version: 1, calibration: change(&file, calibrated(&file, &plant, &mut dice)) };
        let planner = Planner { file: &file, pump: &pump, stored: Some(&stored), limits: &limits };
        for (inside, volume_ml) in inside.iter_mut().zip(VOLUMES_ML) {
            let start_rad = TAU / 3.0 * dice.uniform();
            let request = Request::new(volume_ml, Cruise::Speed { rad_s: rad_s(20.0) });
            let found = planner.plan(Phase::known(start_rad), &request).unwrap();
            let swept = Swept::whole(&found.model, &found.plan);
            let budget = Budget::new(&found.model, &swept, &file.uncertainty, found.applied.as_ref());
            let turn_rad =
                found.plan.end_angle_rad() - start_rad + found.plan.step_rad() * (dice.uniform() - 0.5);
            let delivered_ml = plant.delivers_ml(start_rad, turn_rad, &mut dice);
            *inside += u32::from((delivered_ml - found.plan.planned_ml()).abs() <= budget.expanded_ml());
        }
    }
    inside.map(|inside| f64::from(inside) / f64::from(PLANTS))
}

#[test]
fn small_doses_are_covered_once_short_doses_have_found_a_roller_volume_that_is_5_percent_off() {
    for roller_part in [0.95, 1.0, 1.05] {
        let parts = covered(roller_part, |_, calibration| calibration);
        for (part, volume_ml) in parts.into_iter().zip(VOLUMES_ML) {
            assert!((0.93..=0.985).contains(&part), "V_r times {roller_part}: {volume_ml} mL: {part}");
        }
    }
}

#[test]
fn the_zero_alone_leaves_the_roller_volume_in_small_doses() {
    let parts = covered(1.05, |_, calibration| Calibration { pulse: None, ..calibration });
    assert!(parts.iter().all(|part| *part < 0.85), "{parts:?}");
}

#[test]
fn runs_that_are_weighed_after_the_short_doses_have_the_pulse_found_again() {
    let file = pump_file();
    let (shape, mut dice) = (Shape::published(), Dice::new(7));
    // The pump delivers 4 % more than the model: short doses alone take that for a smaller roller volume.
    let plant = Plant {
        shape: &shape,
        revolution_ml: 1.04 * 21.3185,
        roller_ml: 2.105466,
        phi_rad: radians(50.53),
        zero_rad: radians(33.0),
    };
    let both = calibrated(&file, &plant, &mut dice);
    let expected = both.pulse.unwrap().expected();
    let (alone, _) = Calibration::of_short_doses(&file, both.short_doses.clone(), &expected, None).unwrap();
    let after =
        Calibration::of_runs(&file, Source::File, both.runs.clone(), Fit::Line, &expected, Some(&alone))
            .unwrap();
    let (before, found, again) = (alone.pulse.unwrap(), both.pulse.unwrap(), after.pulse.unwrap());
    assert!((before.roller_volume_ml / found.roller_volume_ml - 1.0).abs() > 0.01, "{before:?} {found:?}");
    assert!((again.roller_volume_ml - found.roller_volume_ml).abs() < 1e-6, "{again:?} {found:?}");
    assert!((after.zero_deg - both.zero_deg).abs() < 1e-5);
    assert!((degrees(plant.zero_rad) - after.zero_deg).abs() < 2.0 * after.zero_standard_deg + 0.2);
}
