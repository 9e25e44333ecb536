//! Claims about doses from an angle that is not known exactly.

use pump_ctl::plan::{Phase, PlanError, Turned};
use pump_model::Pump;

use crate::heads::Head;
use crate::{Dice, planned, request};

/// Few steps, so that every number of steps can be tried.
const STEPS: f64 = 800.0;
const STEP_RAD: f64 = core::f64::consts::TAU / STEPS;

/// Start angles that are tried.
const STARTS: i32 = 400;

/// Returns the smallest and largest volume of turns between two, over a grid of starts and turns, mL.
fn on_a_grid_ml(head: &Head, start: Phase, turns_rad: &[f64]) -> (f64, f64) {
    let half_rad = start.half_width_rad().min(0.5 * head.pitch_rad());
    let starts = (-STARTS..=STARTS).map(|n| start.angle_rad() + half_rad * f64::from(n) / f64::from(STARTS));
    let volumes = starts.flat_map(|start_rad| {
        let start_ml = head.volume_ml(start_rad);
        turns_rad.iter().map(move |turn_rad| head.volume_ml(start_rad + turn_rad) - start_ml)
    });
    volumes.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), ml| (low.min(ml), high.max(ml)))
}

/// Returns the largest error of the extremes on a grid whose points stand this far apart, mL: the flow bends by
/// about 100 mL/rad², and it jumps.
fn grid_ml(pump: &Pump, apart_rad: f64) -> f64 {
    50.0 * apart_rad * apart_rad
        + 0.3 * apart_rad
        + 1e-3 * pump.outlet_curve().largest_flow_ml_rad() * apart_rad
}

#[test]
fn no_other_number_of_steps_has_a_smaller_worst_case() {
    let mut dice = Dice(3);
    for (number, head) in Head::twenty().iter().enumerate() {
        let pump = head.pump();
        for half_width_rad in [0.04, 0.15, 9.0] {
            let owed_ml = (0.1 + 2.5 * dice.roll()) * head.pitch_ml() * (dice.roll() - 0.5).signum();
            let start = Phase::within(6.0 * dice.roll(), half_width_rad);
            let plan = match planned(&pump, start, &request(owed_ml), STEPS) {
                Ok(plan) => plan,
                Err(PlanError::LessThanHalfAStep { smallest_ml, .. }) => {
                    assert!(smallest_ml.abs() >= owed_ml.abs(), "{smallest_ml} {owed_ml}");
                    continue;
                }
                Err(other) => panic!("{other}"),
            };
            let off_ml = |steps: i64| {
                let (least_ml, most_ml) = start.range_ml(&pump, steps as f64 * STEP_RAD);
                (owed_ml - least_ml).max(most_ml - owed_ml)
            };
            let chosen_ml = off_ml(plan.steps());
            // The tried turns reach from none to four pitches and more.
            let most = (4.0 * head.pitch_rad() / STEP_RAD) as i64;
            let best_ml =
                (-most..=most).filter(|steps| *steps != 0).map(off_ml).fold(f64::INFINITY, f64::min);
            assert!(chosen_ml <= best_ml + 1e-12, "{number} {half_width_rad}: {chosen_ml} {best_ml}");
            let grid = on_a_grid_ml(head, start, &[plan.steps() as f64 * STEP_RAD]);
            let allowed_ml = grid_ml(&pump, half_width_rad.min(head.pitch_rad()) / f64::from(STARTS)) + 1e-4;
            assert!((grid.0 - plan.least_ml()).abs() < allowed_ml, "{number}: {grid:?} {plan:?}");
            assert!((grid.1 - plan.most_ml()).abs() < allowed_ml, "{number}: {grid:?} {plan:?}");
        }
    }
}

#[test]
fn turns_that_are_not_counted_exactly_have_the_extremes_of_all_turns_between() {
    let mut dice = Dice(9);
    for head in Head::twenty() {
        let pump = head.pump();
        for half_width_rad in [0.0, 0.1, 9.0] {
            let start = Phase::within(6.0 * dice.roll(), half_width_rad);
            let least_rad = 4.0 * head.pitch_rad() * (dice.roll() - 0.5);
            let most_rad = least_rad + 1.5 * head.pitch_rad() * dice.roll();
            let (least_ml, most_ml) = Turned::at(start).by(least_rad, most_rad).range_ml(&pump);
            let turns: Vec<f64> =
                (0..=600).map(|n| least_rad + (most_rad - least_rad) * f64::from(n) / 600.0).collect();
            let grid = on_a_grid_ml(&head, start, &turns);
            let apart_rad = (most_rad - least_rad) / 600.0;
            let starts_rad = half_width_rad.min(head.pitch_rad()) / f64::from(STARTS);
            let allowed_ml = grid_ml(&pump, apart_rad) + grid_ml(&pump, starts_rad) + 1e-4;
            assert!(least_ml <= grid.0 + 1e-4 && least_ml > grid.0 - allowed_ml, "{least_ml} {grid:?}");
            assert!(most_ml >= grid.1 - 1e-4 && most_ml < grid.1 + allowed_ml, "{most_ml} {grid:?}");
        }
    }
}

#[test]
fn the_smallest_dose_from_an_unknown_angle_is_planned_and_a_smaller_one_is_not() {
    for number in [1, 6, 12] {
        let head = &Head::twenty()[number];
        let pump = head.pump();
        let unknown = Phase::unknown(head.pitch_rad());
        let Err(PlanError::LessThanHalfAStep { smallest_ml, .. }) =
            planned(&pump, unknown, &request(1e-5), STEPS)
        else {
            panic!("too small a dose was planned");
        };
        assert!(planned(&pump, unknown, &request(smallest_ml * (1.0 + 1e-6)), STEPS).is_ok());
        assert!(planned(&pump, unknown, &request(smallest_ml * (1.0 - 1e-6)), STEPS).is_err());
    }
}
