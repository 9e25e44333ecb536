//! Coverage of doses after one to three weighed doses, whose scatter rests on a stated prior.
//!
//! The pumps here are drawn from what the prior states, and from pumps that scatter otherwise. Every pitch errs on its
//! own, a balance of 10 mg shows the vessel before and after, a drop hangs at the nozzle before and after, and the
//! angle is known to a degree.

use pump_ctl::plan::{Cruise, Phase, Ramps, Request};
use pump_model::Pump;
use pump_model::units::{rad_s, radians};

use super::share::ShareSource;
use crate::calibration::{CalibrationError, Earlier, Expected, LastWeighing, Stored, WeighedDose};
use crate::displacement::{Correction, SpeedDependentPump};
use crate::dosing::planner::Planner;
use crate::dosing::{Budget, Swept, drop_ml};
use crate::pump_file::{OutletEnd, PumpFile};
use crate::record::LastDose;
use crate::sampling::Dice;
use crate::units::stated_reading;

/// Returns the number of random pumps of a case, and the part by which chance may lower what they show. `make long`
/// draws 2000 (`PRIOR_PUMPS`).
fn pumps() -> (u32, f64) {
    let number = std::env::var("PRIOR_PUMPS").map_or(400, |text| text.parse().unwrap());
    // Some two standard deviations of 400 draws.
    (number, if number < 2000 { 0.02 } else { 0.0 })
}

/// Speed of all doses, in r/min.
const SPEED_RPM: f64 = 20.0;

/// mL of water of 25 °C for a gram that a balance shows in air of 85.7 kPa: Z of ISO 8655-6 with the density of Kell
/// (1975), 997.047 kg/m³, and air of 1.001 kg/m³.
const Z_ML_G: f64 = 1.003_84;

/// Volume of a drop of water that falls from a nozzle of 1 mm, in mL (Harkins and Brown's table).
const FALLS_ML: f64 = 0.019_17;

/// Scatter of the pumps over that of the pump file.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// The prior: 1.3² times 3 over a chi-square number of 3 degrees of freedom is the variance.
    Prior,
    Times(f64),
}

impl Law {
    fn drawn(self, dice: &mut Dice) -> f64 {
        match self {
            Self::Times(scatter) => scatter,
            Self::Prior => {
                let chi_square: f64 = (0..3).map(|_| dice.normal().powi(2)).sum();
                1.3 * (3.0 / chi_square).sqrt()
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Case {
    law: Law,
    /// Number of weighed doses, and their volume in mL.
    weighed: u32,
    weighed_ml: f64,
    /// Volume of the dose that follows, in mL.
    volume_ml: f64,
    end: OutletEnd,
}

/// A random pump: the model's volume times a factor, with a scatter of its own.
struct Plant<'a> {
    model: &'a Pump,
    factor: f64,
    /// Standard deviation over the root of the volume, in mL to the power 1/2.
    root_ml: f64,
    end: OutletEnd,
}

impl Plant<'_> {
    fn delivers_ml(&self, from_rad: f64, turn_rad: f64, dice: &mut Dice) -> f64 {
        let curve = self.model.outlet_curve();
        let turned_ml = curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad);
        let kept_ml =
            if self.end == OutletEnd::Air { FALLS_ML * (dice.uniform() - dice.uniform()) } else { 0.0 };
        self.factor * turned_ml + self.root_ml * turned_ml.sqrt() * dice.normal() + kept_ml
    }
}

/// Doses of a case: the part within the interval that was stated, and the median half width over the volume.
struct Found {
    covered: f64,
    half_width: f64,
}

fn found(case: Case) -> Found {
    let mut file = crate::catalogue::built_in("three-roller").unwrap();
    file.outlet.end = Some(case.end);
    file.outlet.nozzle_bore_mm = Some(1.0);
    let model = file.model().unwrap();
    let mut dice = Dice::new(2041);
    let (mut inside, mut half_widths) = (0, Vec::new());
    let (number, _) = pumps();
    for _ in 0..number {
        // 0.47 % of ten revolutions of independent pitches.
        let of_file = 0.0047 * (10.0 * model.revolution_ml()).sqrt();
        let plant = Plant {
            model: &model,
            factor: 1.0 + 0.024 * dice.normal(),
            root_ml: case.law.drawn(&mut dice) * of_file,
            end: case.end,
        };
        let mut stored = None;
        for n in 0..case.weighed {
            let calibration =
                weigh(&case, &file, &plant, stored.as_ref(), u64::from(n), &mut dice).calibration;
            stored = Some(Stored { version: n + 1, calibration });
        }
        let (error_ml, expanded_ml) = dose(&case, &file, &plant, stored.as_ref(), &mut dice);
        inside += u32::from(error_ml.abs() <= expanded_ml);
        half_widths.push(expanded_ml / case.volume_ml);
    }
    half_widths.sort_unstable_by(f64::total_cmp);
    Found { covered: f64::from(inside) / f64::from(number), half_width: half_widths[half_widths.len() / 2] }
}

/// Doses and weighs what arrives, from an angle anywhere that is read to a degree. A reading that is refused as a
/// mistake is left, and the dose made again.
fn weigh(
    case: &Case,
    file: &PumpFile,
    plant: &Plant<'_>,
    active: Option<&Stored>,
    unix_s: u64,
    dice: &mut Dice,
) -> WeighedDose {
    loop {
        match weighed_once(case, file, plant, active, unix_s, dice) {
            None | Some(Err(CalibrationError::ImplausibleReading { .. })) => {}
            Some(weighed) => return weighed.unwrap(),
        }
    }
}

/// Returns the calibration by one dose, or `None` if nothing arrived.
fn weighed_once(
    case: &Case,
    file: &PumpFile,
    plant: &Plant<'_>,
    active: Option<&Stored>,
    unix_s: u64,
    dice: &mut Dice,
) -> Option<Result<WeighedDose, CalibrationError>> {
    let (curve, half_width_rad) = (plant.model.outlet_curve(), radians(1.0));
    let start_rad = plant.model.pitch_rad() * dice.uniform();
    let turned_rad = curve.angle_rad(curve.volume_ml(start_rad) + case.weighed_ml) - start_rad;
    let true_rad = start_rad + half_width_rad * (2.0 * dice.uniform() - 1.0);
    let arrived_g = plant.delivers_ml(true_rad, turned_rad, dice) / Z_ML_G;
    let rounded = |grams: f64| (100.0 * grams).round() / 100.0;
    let tare_g = 20.0 + dice.uniform();
    let reading = stated_reading(&format!("{:.2}g", rounded(tare_g + arrived_g) - rounded(tare_g))).ok()?;
    let last = LastDose {
        unix_s,
        speed_rad_s: rad_s(SPEED_RPM),
        start_angle_rad: start_rad,
        half_width_rad,
        turned_rad,
        turned_half_width_rad: 0.0,
        retracted_rad: 0.0,
        retracted_half_width_rad: 0.0,
        fluid: None,
        correction: Correction::NONE,
        by_weight: None,
    };
    let drop_ml = drop_ml(file).unwrap() / 6_f64.sqrt();
    let expected = Expected::of_digits(file, &reading).with_drop_ml(drop_ml);
    let weighing =
        LastWeighing { in_use: None, reading: &reading, earlier: Earlier::Joined, expected: &expected };
    Some(WeighedDose::of(file, Some(last), active, &weighing))
}

/// Returns the error of a dose, and the half width of the interval that was stated, in mL.
fn dose(
    case: &Case,
    file: &PumpFile,
    plant: &Plant<'_>,
    stored: Option<&Stored>,
    dice: &mut Dice,
) -> (f64, f64) {
    let (pump, limits) = (SpeedDependentPump::constant(*plant.model), file.limits());
    let planner = Planner { file, pump: &pump, stored, limits: &limits };
    let start = Phase::within(plant.model.pitch_rad() * dice.uniform(), radians(1.0));
    let request =
        Request::new(case.volume_ml, Cruise::Speed { rad_s: rad_s(SPEED_RPM) }).with_ramps(Ramps::Fastest);
    let found = planner.plan(start, &request).unwrap();
    let swept = Swept::whole(&found.model, &found.plan);
    let budget = Budget::new(&found.model, &swept, &file.uncertainty, found.applied.as_ref()).with_outlet(
        file,
        drop_ml(file).unwrap(),
        0.0,
    );
    for share in &budget.shares {
        let rests = matches!(share.source, ShareSource::Repeatability | ShareSource::Calibration);
        assert_eq!(share.prior.map(|prior| prior.weighed), rests.then_some(case.weighed), "{share:?}");
    }
    let from_rad = start.angle_rad() + start.half_width_rad() * (2.0 * dice.uniform() - 1.0);
    let turn_rad =
        found.plan.end_angle_rad() - start.angle_rad() + found.plan.step_rad() * (dice.uniform() - 0.5);
    (plant.delivers_ml(from_rad, turn_rad, dice) - found.plan.planned_ml(), budget.expanded_ml())
}

fn cases(law: Law) -> Vec<Case> {
    let doses = [
        (OutletEnd::Immersed, 10.0, 10.0),
        (OutletEnd::Air, 10.0, 10.0),
        (OutletEnd::Air, 43.0, 10.0),
        (OutletEnd::Air, 10.0, 2.0),
    ];
    let of =
        |weighed| doses.map(|(end, weighed_ml, volume_ml)| Case { law, weighed, weighed_ml, volume_ml, end });
    (1..=3).flat_map(of).collect()
}

#[test]
fn doses_of_pumps_that_scatter_as_the_prior_states_lie_in_their_intervals() {
    let (_, chance) = pumps();
    for case in cases(Law::Prior) {
        let part = found(case).covered;
        assert!((0.93 - chance..=0.98 + chance).contains(&part), "{case:?}: {part}");
    }
}

#[test]
fn doses_of_pumps_that_scatter_up_to_twice_as_their_file_says_lie_in_their_intervals() {
    let [as_file, twice] = [1.0, 2.0].map(|times| cases(Law::Times(times)));
    let (_, chance) = pumps();
    // One that scatters as its file says is covered more often than it must be.
    for case in as_file.into_iter().skip(4).step_by(5).chain(twice) {
        let part = found(case).covered;
        assert!(part >= 0.93 - chance, "{case:?}: {part}");
    }
}

#[test]
fn each_weighed_dose_narrows_the_interval() {
    for law in [Law::Prior, Law::Times(1.0), Law::Times(2.0)] {
        let width = |weighed| {
            let case = Case { law, weighed, weighed_ml: 10.0, volume_ml: 10.0, end: OutletEnd::Air };
            found(case).half_width
        };
        let widths = [1, 2, 3].map(width);
        assert!(widths[1] < 0.85 * widths[0] && widths[2] < widths[1], "{law:?}: {widths:?}");
    }
}
