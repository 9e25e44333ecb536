//! Claims about doses from a known angle.

use pump_ctl::plan::{Phase, PlanError};

use crate::heads::Head;
use crate::{Dice, planned, request};

/// Error of the grid's volumes, mL: the flow jumps by 0.5 mL/rad at most within 1e-4 rad, a few times in a dose.
const GRID_ML: f64 = 3e-5;

/// Doses that are drawn, unless REVERSING_DOSES says how many.
const DOSES: u32 = 1000;

#[test]
fn random_doses_end_where_an_independent_quadrature_first_finds_their_volume() {
    let doses = std::env::var("REVERSING_DOSES").map_or(DOSES, |number| number.parse().unwrap());
    let heads = Head::twenty();
    let pumps: Vec<_> = heads.iter().map(Head::pump).collect();
    assert_eq!(pumps.len(), 20);
    assert!(pumps.iter().all(|pump| pump.outlet_curve().reverses()));
    let mut dice = Dice(5);
    let mut short = 0;
    for dose in 0..doses {
        let number = dose as usize % heads.len();
        let (head, pump) = (&heads[number], &pumps[number]);
        let steps_per_rev = if dice.roll() < 0.5 { 12_800.0 } else { 3200.0 };
        let step_rad = core::f64::consts::TAU / steps_per_rev;
        // Small doses, and doses of some pitches.
        let size_ml = if dice.roll() < 0.5 {
            0.02 + 1.5 * head.pitch_ml() * dice.roll()
        } else {
            0.02 + (12.0 * head.pitch_ml()).min(20.0) * dice.roll()
        };
        let owed_ml = if dice.roll() < 0.5 { -size_ml } else { size_ml };
        let start_rad = 14.0 * dice.roll() - 7.0;
        let plan = planned(pump, Phase::known(start_rad), &request(owed_ml), steps_per_rev).unwrap();

        let case =
            format!("dose {dose}: {owed_ml} mL from {start_rad} of head {number}, {steps_per_rev} steps");
        let half_ml = 0.5 * head.pitch_ml() * step_rad / head.pitch_rad();
        let found_ml = head.volume_ml(plan.end_angle_rad()) - head.volume_ml(start_rad);
        // Half of a step where a step delivers most.
        let most_ml = 0.5 * pump.outlet_curve().largest_flow_ml_rad() * step_rad + GRID_ML;
        assert!((found_ml - owed_ml).abs() <= most_ml, "{case}: {found_ml}");
        assert!((plan.planned_ml() - found_ml).abs() <= GRID_ML, "{case}: {}", plan.planned_ml());
        // The grid may see a maximum reach the volume that the product sees fall short by a hair.
        let mut ends = [0.0, GRID_ML, -GRID_ML].into_iter().map(|ml| {
            let owed_ml = owed_ml + ml * owed_ml.signum();
            head.first_angle_rad(start_rad, owed_ml, half_ml)
        });
        let near = |end_rad: &f64| (plan.end_angle_rad() - end_rad).abs() <= step_rad + 2.0 * head.grid_rad();
        let at_top = |end_rad: &f64| {
            // Near a maximum the volume hardly changes, and a step more or less is of no account.
            let there_ml = head.volume_ml(*end_rad) - head.volume_ml(start_rad);
            (plan.end_angle_rad() - end_rad).abs() < 12.0 * step_rad && (there_ml - found_ml).abs() < half_ml
        };
        let ends_there = ends.any(|end_rad| near(&end_rad) || at_top(&end_rad));
        assert!(ends_there, "{case}: {} {:?}", plan.end_angle_rad(), ends.collect::<Vec<_>>());
        short += u32::from((found_ml - owed_ml).abs() > most_ml - GRID_ML);
    }
    assert!(short <= doses / 100, "{short}");
}

#[test]
fn a_dose_of_less_than_half_a_step_is_refused_with_the_smallest_that_can_be_had() {
    for head in Head::twenty() {
        let pump = head.pump();
        for place in 0..40 {
            let start = Phase::known(head.pitch_rad() * f64::from(place) / 40.0);
            for sign in [1.0, -1.0] {
                let Err(PlanError::LessThanHalfAStep { smallest_ml, .. }) =
                    planned(&pump, start, &request(sign * 1e-6), 12_800.0)
                else {
                    panic!("too small a dose was planned");
                };
                assert!(smallest_ml * sign > 0.0, "{smallest_ml}");
                let dose = |factor: f64| planned(&pump, start, &request(factor * smallest_ml), 12_800.0);
                let plan = dose(1.0 + 1e-9).unwrap();
                assert!(plan.steps() as f64 * sign > 0.0);
                let half_ml = 0.5 * pump.outlet_curve().largest_flow_ml_rad() * plan.step_rad();
                assert!(plan.carry_ml().abs() <= half_ml, "{plan:?}");
                assert!(dose(1.0 - 1e-9).is_err());
            }
        }
    }
}

#[test]
fn the_flow_at_the_end_of_a_dose_is_positive() {
    let head = Head::reference();
    let (pump, mut dice) = (head.pump(), Dice(11));
    let step_rad = core::f64::consts::TAU / 12_800.0;
    for _ in 0..500 {
        let owed_ml = 0.05 + 10.0 * dice.roll();
        let plan = planned(&pump, Phase::known(7.0 * dice.roll()), &request(owed_ml), 12_800.0).unwrap();
        // The nearest step may lie behind a maximum by half a step.
        let before_rad = plan.end_angle_rad() - step_rad;
        assert!(head.flow_ml_rad(before_rad) > 0.0, "{owed_ml}: {plan:?}");
    }
}

#[test]
fn a_head_that_delivers_next_to_nothing_is_planned_or_refused_soon() {
    let begun = std::time::Instant::now();
    for left in [1e-2, 1e-4, 1e-7] {
        // Three rollers of V_nom/3 would take all.
        let pump = Head::with_roller_ml(27.634_892 / 3.0 * (1.0 - left));
        for start in [Phase::known(0.3), Phase::within(0.3, 0.1), Phase::unknown(pump.pitch_rad())] {
            for volume_ml in [1e-5, 1e-3, 1.0, -30.0, 1e5] {
                // The motor is too slow for a plan, or the steps are too many.
                let _ = planned(&pump, start, &request(volume_ml), 12_800.0);
            }
        }
    }
    assert!(begun.elapsed().as_secs() < 60, "{:?}", begun.elapsed());
}
