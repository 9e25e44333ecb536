//! Coverage of doses of bought heads, of which only the volume per revolution is known, after one weighed run.
//!
//! The heads here are computed apart from the model: a volume is the bore's less what the rollers give back, and V(x)
//! is the measured shape of McIntyre et al., which is not the shape of the default pulse.

use std::f64::consts::TAU;

use pump_ctl::plan::{Cruise, Phase, Ramps, Request};
use pump_model::units::{rad_s, radians};

use super::pulse_coverage::Shape;
use super::share::ShareSource;
use crate::calibration::{Calibration, CalibrationRun, Expected, Fit, Reading, Source, Stored};
use crate::catalogue::BoughtPump;
use crate::displacement::{PulsePrior, SpeedDependentPump};
use crate::dosing::planner::Planner;
use crate::dosing::{Budget, Swept};
use crate::pump_file::{HeadTable, PumpFile};
use crate::sampling::Dice;

const HEADS: u32 = 500;

/// Standard deviation of a dose, as a part of it, and of a reading, in mL.
const REPEATABILITY: f64 = 0.0047;
const READING_ML: f64 = 0.002;

/// A head as it is.
struct Head<'a> {
    shape: &'a Shape,
    rollers: u32,
    revolution_ml: f64,
    phi_rad: f64,
    roller_ml: f64,
}

impl<'a> Head<'a> {
    /// Draws a head. `wider` is its law over the default pulse's: ln phi and the fullness are normal.
    fn drawn(shape: &'a Shape, rollers: u32, wider: f64, dice: &mut Dice) -> Self {
        let prior = PulsePrior::of(rollers);
        let angle = (wider * prior.engagement_spread * dice.normal()).exp();
        let phi_rad = radians((prior.engagement_deg * angle).min(330.0));
        let fullness = (prior.fullness + wider * prior.fullness_standard * dice.normal()).max(0.05);
        let share = (fullness * phi_rad * f64::from(rollers) / TAU).min(0.95);
        // The tube is off by up to 15 %.
        let revolution_ml = 0.5 * (1.0 + 0.15 * (2.0 * dice.uniform() - 1.0));
        let pitch_ml = revolution_ml / f64::from(rollers);
        Self { shape, rollers, revolution_ml, phi_rad, roller_ml: pitch_ml * share / (1.0 - share) }
    }

    /// Volume that the rollers have taken since angle 0, in mL, up to a constant. Every roller is summed alone.
    fn taken_ml(&self, angle_rad: f64) -> f64 {
        let pitch_rad = TAU / f64::from(self.rollers);
        let first = (angle_rad / pitch_rad).floor();
        // Rollers that began to leave more than a turn ago have left.
        let back = i32::try_from(self.rollers).unwrap();
        (0..=back)
            .map(|n| {
                let away_rad = angle_rad - (first - f64::from(n)) * pitch_rad;
                let left_ml = self.roller_ml * self.shape.at((self.phi_rad - away_rad) / self.phi_rad);
                self.roller_ml - left_ml
            })
            .sum::<f64>()
            + self.roller_ml * (first - f64::from(back))
    }

    fn volume_ml(&self, from_rad: f64, turn_rad: f64) -> f64 {
        let nominal_ml_rad = (self.revolution_ml + f64::from(self.rollers) * self.roller_ml) / TAU;
        nominal_ml_rad * turn_rad - (self.taken_ml(from_rad + turn_rad) - self.taken_ml(from_rad))
    }

    fn delivers_ml(&self, from_rad: f64, turn_rad: f64, dice: &mut Dice) -> f64 {
        self.volume_ml(from_rad, turn_rad) * (1.0 + REPEATABILITY * dice.normal())
    }
}

/// Returns the pump file of a head of 0.5 mL per revolution. Its doses scatter by the same part at every volume, as the
/// heads here do.
fn pump_file(rollers: u32) -> PumpFile {
    let head = HeadTable::new(0.5);
    let mut file = BoughtPump { id: "bought".to_owned(), head, rollers }.pump_file();
    file.motor.steps_per_rev = 3200;
    file.uncertainty.repeatability_at_ml = Some(0.1);
    file
}

fn weighed(file: &PumpFile, head: &Head<'_>, dice: &mut Dice) -> Stored {
    let runs = vec![CalibrationRun {
        speed_rpm: 20.0,
        start_angle_deg: None,
        turned_deg: 7200.0,
        reading: Reading::VolumeMl(head.delivers_ml(0.3, radians(7200.0), dice) + READING_ML * dice.normal()),
        temperature_degc: None,
        time: None,
    }];
    let expected = Expected::new(REPEATABILITY, READING_ML);
    let calibration = Calibration::of_runs(file, Source::File, runs, Fit::Line, &expected, None).unwrap();
    Stored { version: 1, calibration }
}

/// Returns the part of the doses within the interval that was stated, and that without the share of the default pulse.
/// One dose of 0.1 to 10 mL is made of each head, from any angle.
fn covered(rollers: u32, wider: f64) -> [f64; 2] {
    let file = pump_file(rollers);
    let pump = SpeedDependentPump::constant(file.model().unwrap());
    let (shape, limits, mut dice) = (Shape::published(), file.limits(), Dice::new(2031));
    let mut inside = [0; 2];
    for _ in 0..HEADS {
        let head = Head::drawn(&shape, rollers, wider, &mut dice);
        let stored = weighed(&file, &head, &mut dice);
        let planner = Planner { file: &file, pump: &pump, stored: Some(&stored), limits: &limits };
        let volume_ml = 0.1 * 100_f64.powf(dice.uniform());
        let start_rad = TAU * dice.uniform();
        let request =
            Request::new(volume_ml, Cruise::Speed { rad_s: rad_s(20.0) }).with_ramps(Ramps::Fastest);
        let found = planner.plan(Phase::known(start_rad), &request).unwrap();
        let swept = Swept::whole(&found.model, &found.plan);
        let budget = Budget::new(&found.model, &swept, &file.uncertainty, found.applied.as_ref())
            .with_default_pulse(&file, &found.model, &swept, found.applied.as_ref());
        let mut beside = budget.clone();
        beside.shares.retain(|share| share.source != ShareSource::Pulse);
        let turn_rad =
            found.plan.end_angle_rad() - start_rad + found.plan.step_rad() * (dice.uniform() - 0.5);
        let error_ml = head.delivers_ml(start_rad, turn_rad, &mut dice) - found.plan.planned_ml();
        for (inside, budget) in inside.iter_mut().zip([&budget, &beside]) {
            *inside += u32::from(error_ml.abs() <= budget.expanded_ml());
        }
    }
    inside.map(|inside| f64::from(inside) / f64::from(HEADS))
}

#[test]
fn doses_of_bought_heads_lie_within_their_bounds_after_one_weighed_run() {
    for rollers in [3, 4, 6] {
        for wider in [1.0, 1.5] {
            let [with, without] = covered(rollers, wider);
            assert!(with >= 0.93, "{rollers} rollers, a law {wider} times as wide: {with}");
            assert!(without < with - 0.05, "{rollers} rollers: the pulse makes no difference: {without}");
        }
    }
}

#[test]
fn heads_that_nobody_weighed_state_more_than_the_papers_2_4_percent() {
    let file = pump_file(4);
    let pump = file.model().unwrap();
    let request = Request::new(5.0, Cruise::Speed { rad_s: rad_s(20.0) });
    let plan =
        pump_ctl::plan::Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.0), &request).unwrap();
    let budget = Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None);
    let of = |source| budget.shares.iter().find(|share| share.source == source).unwrap().standard_ml;
    // sqrt(25² + 20²)/sqrt(3) % between pumps and tubes of the bore with the widest limits, 9.02/sqrt(3) % at a speed.
    assert!((of(ShareSource::Model) - 0.185 * plan.planned_ml()).abs() < 1e-4);
    assert!((of(ShareSource::Speed) - 0.052 * plan.planned_ml()).abs() < 1e-4);
    // A bore of 1/8 in: sqrt(10² + 5²)/sqrt(3) %.
    let mut known = BoughtPump { id: "b".to_owned(), head: HeadTable::new(0.5), rollers: 4 };
    known.head.tube_bore_mm = Some(3.175);
    assert!((known.pump_file().uncertainty.model_percent - 6.5).abs() < 1e-9);
}
