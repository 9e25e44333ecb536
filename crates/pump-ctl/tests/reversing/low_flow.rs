//! Claims about doses that end at low flow, which is positive.

use pump_ctl::plan::{Finish, Phase, PlanError};

use crate::heads::Head;
use crate::{Dice, planned, request};

#[test]
fn the_end_is_the_one_with_a_low_positive_flow_whose_volume_is_nearest() {
    const STEPS: f64 = 3200.0;
    let step_rad = core::f64::consts::TAU / STEPS;
    let mut dice = Dice(21);
    for (number, head) in Head::twenty().iter().enumerate() {
        let pump = head.pump();
        let limit_ml_rad = 0.5 * pump.nominal_ml_rad();
        let is_low = |angle_rad: f64| {
            let flow_ml_rad = head.flow_ml_rad(angle_rad);
            flow_ml_rad > -1e-9 && flow_ml_rad <= limit_ml_rad * (1.0 + 1e-9)
        };
        for _ in 0..10 {
            let owed_ml = (0.3 + 3.0 * dice.roll()) * head.pitch_ml() * (dice.roll() - 0.5).signum();
            let start_rad = 6.0 * dice.roll();
            let volume_ml = |angle_rad: f64| head.volume_ml(angle_rad) - head.volume_ml(start_rad);
            let ends = (1..(6.0 * head.pitch_rad() / step_rad) as u32)
                .map(|steps| start_rad + owed_ml.signum() * f64::from(steps) * step_rad);
            let off_ml = |angle_rad: f64| (volume_ml(angle_rad) - owed_ml).abs();
            let best_ml = ends.filter(|rad| is_low(*rad)).map(off_ml).fold(f64::INFINITY, f64::min);
            let low = request(owed_ml).with_finish(Finish::LowFlow);
            match planned(&pump, Phase::known(start_rad), &low, STEPS) {
                Ok(plan) => {
                    let case = format!("{number}: {owed_ml} from {start_rad}, {plan:?}");
                    assert!(is_low(plan.end_angle_rad()), "{case}");
                    assert!((off_ml(plan.end_angle_rad()) - best_ml).abs() < 1e-4, "{case} {best_ml}");
                    let offered = plan.low_flow_volumes_ml(&pump).unwrap();
                    let is_offered = |ml: &f64| (ml - plan.planned_ml()).abs() < 1e-12;
                    assert!(offered.iter().flatten().any(is_offered), "{case} {offered:?}");
                }
                Err(PlanError::NoLowFlowEnd { .. }) => assert!(best_ml > owed_ml.abs() - 1e-4, "{number}"),
                Err(other) => panic!("{number}: {other}"),
            }
        }
    }
}
