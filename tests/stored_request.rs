//! Claims about what crosses a wire: a request plans again to the last bit, and a torque curve is checked.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_ctl::plan::{
    Cruise, Doser, Finish, Limits, Lowest, Motor, Phase, PressureLimits, Request, SetBy, Torque, TorqueCurve,
    Turned,
};
use pump_model::Pump;
use serde_json::{Value, json};

fn curve() -> TorqueCurve {
    TorqueCurve::new(&[(0.0, 5.0), (9.3, 4.1), (17.8, 2.9)]).unwrap()
}

fn limits() -> Limits {
    Limits::new(Motor::new(12_800.0, 17.8, 500.0))
        .with_pressures(PressureLimits { max_outlet_kpa: Some(150.1), min_inlet_kpa: None })
        .with_lowest(Lowest { kpa: 20.7, set_by: SetBy::Vapour })
        .with_torque(Torque::new(101.3, curve()).with_occlusion_n_m(0.4).with_inertia_kg_m2(2e-4))
}

#[test]
fn a_request_that_crosses_a_wire_gives_the_plan_to_the_last_bit() {
    let pump = Pump::three_roller();
    let start = Phase::within(0.3, 0.01);
    let turned = Turned::at(start).by(0.1, 0.1);
    let requests = [
        Request::new(25.1, Cruise::Flow { ml_s: 5.3 }).with_carry_in_ml(-0.017),
        Request::new(-60.7, Cruise::Fastest).with_turned(Some(turned)),
        Request::new(25.3, Cruise::Speed { rad_s: 3.1 }).with_smooth(true).with_finish(Finish::LowFlow),
    ];
    for request in requests {
        let sent = serde_json::to_string(&(start, request, limits())).unwrap();
        let received: (Phase, Request, Limits) = serde_json::from_str(&sent).unwrap();
        let here = Doser::new(&pump, limits()).unwrap().plan(start, &request).unwrap();
        let there = Doser::new(&pump, received.2).unwrap().plan(received.0, &received.1).unwrap();
        // Debug writes every f64 so that it reads back to the same bits.
        assert_eq!(format!("{here:?}"), format!("{there:?}"));
        assert!(here.steps() != 0);
    }
}

/// Returns the refusal of a stored torque curve with this change.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut stored = serde_json::to_value(curve()).unwrap();
    change(&mut stored["points"]);
    serde_json::from_value::<TorqueCurve>(stored).unwrap_err().to_string()
}

#[test]
fn a_stored_torque_curve_is_read_as_it_was() {
    assert_eq!(
        serde_json::from_value::<TorqueCurve>(serde_json::to_value(curve()).unwrap()).unwrap(),
        curve()
    );
}

#[test]
fn a_stored_torque_curve_that_no_motor_has_is_refused() {
    for (place, point) in [(0, [1.0, 5.0]), (1, [18.0, 4.1]), (1, [9.3, -1.0]), (5, [17.9, 2.9])] {
        let message = refused(|points| points[place] = json!(point));
        assert!(message.contains("begin at speed 0, rise in speed"), "{message}");
    }
}
