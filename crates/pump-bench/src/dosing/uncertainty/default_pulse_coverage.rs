//! Coverage of doses of bought heads, of which only the volume per revolution is known, after one weighed run.
//!
//! The heads here are computed apart from the model: a volume is the bore's less what the rollers give back. V(x) is
//! the measured shape of McIntyre et al., a raised cosine or steeper, and none is the shape of the default pulse.

use std::f64::consts::{PI, TAU};

use pump_ctl::plan::{Cruise, Phase, Ramps, Request};
use pump_model::units::{degrees, rad_s, radians};

use super::pulse_coverage::Shape as Measured;
use super::share::ShareSource;
use crate::calibration::{Calibration, CalibrationRun, Expected, Fit, Reading, Source, Stored};
use crate::catalogue::BoughtPump;
use crate::displacement::{PulsePrior, SpeedDependentPump};
use crate::dosing::planner::Planner;
use crate::dosing::{Budget, Swept, drop_ml};
use crate::pump_file::{HeadTable, OutletEnd, PumpFile};
use crate::sampling::Dice;

/// Heads of a statement about coverage. `COVERAGE_HEADS` is another number.
fn heads() -> u32 {
    std::env::var("COVERAGE_HEADS").map_or(500, |heads| heads.parse().unwrap())
}

/// Standard deviation of a dose, as a part of it.
const REPEATABILITY: f64 = 0.0047;

/// Last digit of the balance, in mL of water.
const DIGIT_ML: f64 = 0.01;

/// V(x)/V_r of a head's pulse over x/phi.
enum Shape<'a> {
    Measured(&'a Measured),
    /// (1 - cos(pi u^power))/2.
    Cosine {
        power: f64,
    },
    /// 1 - (1 - u^first)^second (Kumaraswamy, Journal of Hydrology 46, 1980). 2 and 5 are near the mean of the
    /// drawings.
    Steep {
        first: f64,
        second: f64,
    },
}

impl<'a> Shape<'a> {
    fn drawn(measured: &'a Measured, dice: &mut Dice) -> Self {
        let [one, other] = [(); 2].map(|()| dice.uniform());
        match dice.uniform() {
            0.0..0.33 => Self::Measured(measured),
            0.33..0.67 => Self::Cosine { power: 0.6 + 0.5 * one },
            _ => Self::Steep { first: 1.6 + one, second: 3.0 + 5.0 * other },
        }
    }

    fn at(&self, part: f64) -> f64 {
        match self {
            Self::Measured(shape) => shape.at(part),
            Self::Cosine { power } => 0.5 - 0.5 * (PI * part.clamp(0.0, 1.0).powf(*power)).cos(),
            Self::Steep { first, second } => 1.0 - (1.0 - part.clamp(0.0, 1.0).powf(*first)).powf(*second),
        }
    }
}

/// A head as it is.
struct Head<'a> {
    shape: Shape<'a>,
    rollers: u32,
    revolution_ml: f64,
    phi_rad: f64,
    roller_ml: f64,
}

impl<'a> Head<'a> {
    /// Draws a head that is sold with `ml_per_rev`. `wider` is its law over the default pulse's: ln phi and the
    /// fullness are normal. A law draws again what geometry rules out: a roller seals over a pitch between two
    /// engagements, all in one turn, and takes two thirds of the bore over its own width, a pitch at most.
    fn drawn(
        measured: &'a Measured,
        ml_per_rev: f64,
        prior: &PulsePrior,
        wider: f64,
        dice: &mut Dice,
    ) -> Self {
        let rollers = prior.rollers;
        let pitch_deg = 360.0 / f64::from(rollers);
        let (phi_deg, share) = loop {
            let phi_deg = prior.engagement_deg * (wider * prior.engagement_spread * dice.normal()).exp();
            let fullness = prior.fullness + wider * prior.fullness_standard * dice.normal();
            let share = fullness * phi_deg / pitch_deg;
            if 2.0 * phi_deg + pitch_deg <= 360.0
                && (0.0..2.0 / 3.0).contains(&fullness)
                && share <= 2.0 / 3.0
            {
                break (phi_deg, share);
            }
        };
        let shape = Shape::drawn(measured, dice);
        // The tube is off by up to 15 %.
        let revolution_ml = ml_per_rev * (1.0 + 0.15 * (2.0 * dice.uniform() - 1.0));
        let pitch_ml = revolution_ml / f64::from(rollers);
        let roller_ml = pitch_ml * share / (1.0 - share);
        Self { shape, rollers, revolution_ml, phi_rad: radians(phi_deg), roller_ml }
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

    /// Volume that arrives in the vessel, in mL. A drop of 20 to 50 µL hangs at a nozzle in air before and after, each
    /// time as large as it may be.
    fn delivers_ml(&self, from_rad: f64, turn_rad: f64, end: OutletEnd, dice: &mut Dice) -> f64 {
        let drop_ml = if end == OutletEnd::Air { 0.02 + 0.03 * dice.uniform() } else { 0.0 };
        let kept_ml = drop_ml * (dice.uniform() - dice.uniform());
        self.volume_ml(from_rad, turn_rad) * (1.0 + REPEATABILITY * dice.normal()) + kept_ml
    }
}

/// Returns the pump file of a head. Its doses scatter by the same part at every volume, as the heads here do. Nobody
/// has described a nozzle in air.
fn pump_file(ml_per_rev: f64, rollers: u32, end: OutletEnd) -> PumpFile {
    let head = HeadTable::new(ml_per_rev);
    let mut file = BoughtPump { id: "bought".to_owned(), head, rollers }.pump_file();
    file.motor.steps_per_rev = 3200;
    file.uncertainty.repeatability_at_ml = Some(0.001);
    file.outlet.end = (end == OutletEnd::Immersed).then_some(end);
    file
}

/// Knowledge of the angle of the rollers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Angle {
    /// Read by eye, to a degree.
    ByEye,
    Unknown,
}

/// Doses of heads with one number of rollers.
struct Case {
    rollers: u32,
    /// Volumes per revolution between which the heads lie, in mL.
    ml_per_rev: (f64, f64),
    /// Volume that is weighed, in mL, and volumes between which the doses lie.
    weighed_ml: f64,
    doses_ml: (f64, f64),
    heads: u32,
    angle: Angle,
    end: OutletEnd,
    /// Law that draws the heads, over that of the prior.
    wider: f64,
    seed: u64,
}

impl Case {
    fn of(rollers: u32, wider: f64) -> Self {
        Self {
            rollers,
            ml_per_rev: (0.5, 0.5),
            weighed_ml: 10.0,
            doses_ml: (0.06, 25.0),
            heads: heads(),
            angle: Angle::ByEye,
            end: OutletEnd::Air,
            wider,
            seed: 2031,
        }
    }
}

/// Doses of a case.
struct Found {
    /// Part of the doses within the interval that was stated.
    covered: f64,
    /// Part of the doses within the interval without the default pulse's share.
    without_pulse: f64,
    /// Median of the stated half widths over the volume.
    half_width: f64,
}

/// Weighs a dose of the default pulse's `weighed_ml`. From an unknown angle it is made of whole pitches.
fn weighed(case: &Case, file: &PumpFile, head: &Head<'_>, dice: &mut Dice) -> Stored {
    let (model, pitch_rad) = (file.model().unwrap(), TAU / f64::from(head.rollers));
    let (start_rad, stated_rad, turn_rad) = match case.angle {
        Angle::ByEye => {
            let stated_rad = TAU * dice.uniform();
            let curve = model.outlet_curve();
            let turn_rad = curve.angle_rad(curve.volume_ml(stated_rad) + case.weighed_ml) - stated_rad;
            (stated_rad + radians(2.0 * dice.uniform() - 1.0), Some(stated_rad), turn_rad)
        }
        Angle::Unknown => {
            let pitches = (case.weighed_ml / model.outlet_curve().pitch_ml()).round().max(1.0);
            (TAU * dice.uniform(), None, pitches * pitch_rad)
        }
    };
    let delivered_ml = head.delivers_ml(start_rad, turn_rad, case.end, dice);
    // The balance shows the vessel before and after.
    let rounded = |ml: f64| (ml / DIGIT_ML).round() * DIGIT_ML;
    let tare_ml = 30.0 + dice.uniform();
    let runs = vec![CalibrationRun {
        digit: None,
        speed_rpm: 20.0,
        start_angle_deg: stated_rad.map(degrees),
        start_half_width_deg: None,
        turned_deg: degrees(turn_rad),
        reading: Reading::VolumeMl(rounded(tare_ml + delivered_ml) - rounded(tare_ml)),
        temperature_degc: None,
        time: None,
    }];
    let expected = Expected::of(file, DIGIT_ML * (2.0_f64 / 12.0).sqrt())
        .with_drop_ml(drop_ml(file).unwrap() / 6_f64.sqrt());
    let calibration = Calibration::of_runs(file, Source::Last, runs, Fit::Factor, &expected, None).unwrap();
    Stored { version: 1, calibration }
}

/// Makes one dose of each head.
fn found(case: &Case) -> Found {
    let (measured, mut dice) = (Measured::published(), Dice::new(case.seed));
    let between = |(least, most): (f64, f64), part: f64| least * (most / least).powf(part);
    let prior = PulsePrior::of(case.rollers);
    let (mut inside, mut half_widths) = ([0; 2], Vec::new());
    for _ in 0..case.heads {
        let ml_per_rev = between(case.ml_per_rev, dice.uniform());
        let file = pump_file(ml_per_rev, case.rollers, case.end);
        let (pump, limits) = (SpeedDependentPump::constant(file.model().unwrap()), file.limits());
        let head = Head::drawn(&measured, ml_per_rev, &prior, case.wider, &mut dice);
        let stored = weighed(case, &file, &head, &mut dice);
        let planner = Planner { file: &file, pump: &pump, stored: Some(&stored), limits: &limits };
        let volume_ml = between(case.doses_ml, dice.uniform());
        let true_rad = TAU * dice.uniform();
        let start = match case.angle {
            Angle::ByEye => Phase::within(true_rad + radians(2.0 * dice.uniform() - 1.0), radians(1.0)),
            Angle::Unknown => Phase::unknown(TAU / f64::from(case.rollers)),
        };
        let request =
            Request::new(volume_ml, Cruise::Speed { rad_s: rad_s(20.0) }).with_ramps(Ramps::Fastest);
        let found = planner.plan(start, &request).unwrap();
        let swept = Swept::whole(&found.model, &found.plan);
        let budget = Budget::new(&found.model, &swept, &file.uncertainty, found.applied.as_ref())
            .with_default_pulse(&file, &found.model, &swept, found.applied.as_ref())
            .with_outlet(&file, drop_ml(&file).unwrap(), 0.0);
        let pulse_ml =
            budget.shares.iter().find(|share| share.source == ShareSource::Pulse).unwrap().standard_ml;
        let turn_rad = found.plan.end_angle_rad() - found.plan.start().angle_rad()
            + found.plan.step_rad() * (dice.uniform() - 0.5);
        let error_ml = head.delivers_ml(true_rad, turn_rad, case.end, &mut dice) - found.plan.planned_ml();
        let rest_ml = 2.0 * (budget.standard_ml().powi(2) - pulse_ml.powi(2)).max(0.0).sqrt();
        for (inside, within_ml) in inside.iter_mut().zip([budget.expanded_ml(), rest_ml]) {
            *inside += u32::from(error_ml.abs() <= within_ml);
        }
        half_widths.push(budget.expanded_ml() / volume_ml);
    }
    half_widths.sort_unstable_by(f64::total_cmp);
    let part = |inside| f64::from(inside) / f64::from(case.heads);
    Found {
        covered: part(inside[0]),
        without_pulse: part(inside[1]),
        half_width: half_widths[half_widths.len() / 2],
    }
}

#[test]
fn a_head_of_half_a_millilitre_and_four_rollers_doses_within_its_bounds_after_one_weighed_dose() {
    for doses_ml in [(5.0, 5.0), (0.06, 25.0)] {
        for angle in [Angle::ByEye, Angle::Unknown] {
            let part = found(&Case { doses_ml, angle, ..Case::of(4, 1.5) }).covered;
            assert!(part >= 0.93, "{doses_ml:?} mL, {angle:?}: {part}");
        }
    }
}

#[test]
fn doses_of_heads_of_all_sizes_lie_within_their_bounds_after_one_weighed_dose() {
    for (rollers, wider) in
        [2, 3, 4, 6, 8, 12].into_iter().flat_map(|rollers| [(rollers, 1.0), (rollers, 1.5)])
    {
        let mut parts = Vec::new();
        for ml_per_rev in [(0.05, 1.0), (1.0, 20.0)] {
            for angle in [Angle::ByEye, Angle::Unknown] {
                let case = Case { ml_per_rev, angle, heads: heads() / 4, ..Case::of(rollers, wider) };
                parts.push(found(&case).covered);
            }
        }
        let part = parts.iter().sum::<f64>() / 4.0;
        assert!(part >= 0.93, "{rollers} rollers, a law {wider} times as wide: {parts:?}");
    }
}

/// Without a drop the pulse decides the doses of large heads.
#[test]
fn doses_of_a_few_pitches_lie_within_bounds_that_are_no_wider_than_they_must_be() {
    for rollers in [2, 3, 4, 6, 8, 12] {
        let ml_per_rev = (4.0, 20.0);
        let case = |wider| Case { ml_per_rev, end: OutletEnd::Immersed, ..Case::of(rollers, wider) };
        // The law of the interval lies between the two: Student's t of five drawings makes the prior 1.435 times as
        // wide.
        for (wider, most) in [(1.0, 0.995), (1.5, 0.99)] {
            let found = found(&Case { doses_ml: (0.5, 25.0), ..case(wider) });
            assert!((0.93..most).contains(&found.covered), "{rollers} rollers: {}", found.covered);
            assert!(found.without_pulse < found.covered - 0.1, "{rollers} rollers: {}", found.without_pulse);
        }
    }
}

#[test]
fn bounds_within_a_pitch_are_narrower_than_the_pitch_holds() {
    let width = |doses_ml| found(&Case { doses_ml: (doses_ml, doses_ml), ..Case::of(4, 1.0) }).half_width;
    let widths = [0.06, 0.125, 1.0, 5.0, 10.0].map(width);
    // A drop of 60 µL makes 49 of these.
    assert!(0.06 * widths[0] < 0.07, "{widths:?}");
    assert!(widths.is_sorted_by(|one, next| one > next), "{widths:?}");
    assert!(widths[3] < 0.02, "{widths:?}");
}

#[test]
fn heads_that_nobody_weighed_state_more_than_the_papers_2_4_percent() {
    let file = pump_file(0.5, 4, OutletEnd::Air);
    let pump = file.model().unwrap();
    let request = Request::new(5.0, Cruise::Speed { rad_s: rad_s(20.0) });
    let plan =
        pump_ctl::plan::Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.0), &request).unwrap();
    let budget = Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None);
    let of = |source| budget.shares.iter().find(|share| share.source == source).unwrap().standard_ml;
    // sqrt(25² + 20²)/sqrt(3) % between pumps and tubes of the bore with the widest limits, 15/sqrt(3) % at a speed.
    assert!((of(ShareSource::Model) - 0.185 * plan.planned_ml()).abs() < 1e-4);
    assert!((of(ShareSource::Speed) - 0.087 * plan.planned_ml()).abs() < 1e-4);
    // A bore of 1/8 in: sqrt(10² + 5²)/sqrt(3) %.
    let mut known = BoughtPump { id: "b".to_owned(), head: HeadTable::new(0.5), rollers: 4 };
    known.head.tube_bore_mm = Some(3.175);
    assert!((known.pump_file().uncertainty.model_percent - 6.5).abs() < 1e-9);
}
