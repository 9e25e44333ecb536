//! Claims about changes of a dose, stops, pressures and back flow.

use pump_ctl::plan::{Cruise, Doser, Phase, PlanError, Request, Retarget};

use crate::heads::Head;
use crate::{Dice, limits, planned, request};

#[test]
fn a_change_to_the_volume_that_was_offered_is_not_refused() {
    let mut dice = Dice(33);
    for head in Head::twenty() {
        let pump = head.pump();
        let limits = limits(12_800.0);
        let doser = Doser::new(&pump, limits).unwrap();
        let volume_ml = 2.5 * head.pitch_ml();
        let whole = planned(&pump, Phase::known(0.3), &request(volume_ml), 12_800.0).unwrap();
        for _ in 0..12 {
            let made = (whole.steps() as f64 * (0.05 + 0.8 * dice.roll())) as u64;
            let change = |ml: f64| Retarget::new(made, ml, Cruise::Speed { rad_s: 1.0 });
            let rest = match doser.retarget(&whole, &change(whole.delivered_ml(&pump, made) - 0.01)) {
                Err(PlanError::CannotStopThere { nearest_ml, .. }) => {
                    let rest = doser.retarget(&whole, &change(nearest_ml)).unwrap();
                    let total_ml = whole.delivered_ml(&pump, made) + rest.planned_ml();
                    assert!((total_ml - nearest_ml).abs() < 2e-3, "{total_ml} {nearest_ml}");
                    rest
                }
                other => panic!("{other:?}"),
            };
            assert!(rest.steps() > 0);
            // The first plan's own volume is still to be had, and at the same angle.
            let again = doser.retarget(&whole, &change(volume_ml)).unwrap();
            assert_eq!(made as i64 + again.steps(), whole.steps());
        }
    }
}

#[test]
fn a_limit_of_the_pressure_holds_where_the_flow_reverses() {
    let head = Head::reference();
    let pump = head.pump();
    let fastest = Request::new(20.0, Cruise::Fastest);
    let mut limited = limits(12_800.0);
    limited.pressures.max_outlet_kpa = Some(95.0);
    let plan = Doser::new(&pump, limited).unwrap().plan(Phase::known(0.3), &fastest).unwrap();
    let prediction = plan.predict(&pump).unwrap();
    assert!(prediction.outlet.max_kpa <= 95.0 && prediction.outlet.max_kpa > 94.0, "{prediction:?}");
    // Where the rollers take back, the outlet's pressure falls below that of the vessel.
    assert!(prediction.outlet.min_kpa < pump.outlet().reservoir_kpa, "{prediction:?}");
}

#[test]
fn slow_doses_report_what_the_rollers_take_back() {
    // At a slow speed the line follows the rollers, so each whole pitch takes back what the rollers do.
    let head = Head::reference();
    let pump = head.pump();
    let slow = Request::new(10.0 * head.pitch_ml(), Cruise::Flow { ml_s: 0.05 });
    let plan = planned(&pump, Phase::known(0.0), &slow, 12_800.0).unwrap();
    let back_flow = plan.back_flow(&pump).unwrap();
    assert!((back_flow.reverse_flow_ml - 10.0 * 0.054_705_9).abs() < 5e-3, "{back_flow:?}");
    assert!(back_flow.backflow_ml < 2e-3, "{back_flow:?}");
}
