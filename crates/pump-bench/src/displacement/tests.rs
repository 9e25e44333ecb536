//! Tests of a pump whose displacement depends on its speed.

use pump_model::units::rad_s;
use pump_model::{Pump, SpeedLaw};

use super::*;

fn pump() -> SpeedDependentPump {
    let law = DisplacementLaw::new(SpeedLaw::PUBLISHED, [10.0, 170.0]);
    SpeedDependentPump::new(Pump::three_roller(), Some(law))
}

#[test]
fn a_flow_gives_a_speed_and_the_speed_that_flow() {
    let pump = pump();
    for flow_ml_s in [4.0, 5.0, 20.0, 35.0, 59.0, -5.0, -40.0] {
        let speed_rad_s = pump.speed_for_flow(flow_ml_s).unwrap();
        let back_ml_s = pump.average_flow_ml_s(speed_rad_s).unwrap();
        assert!((back_ml_s - flow_ml_s).abs() < 1e-9, "{flow_ml_s} {back_ml_s}");
        let at = pump.at(speed_rad_s).unwrap();
        assert!((at.average_flow_ml_s(speed_rad_s) - flow_ml_s).abs() < 1e-9);
    }
}

#[test]
fn what_the_law_does_not_say_is_refused_with_what_it_says() {
    let pump = pump();
    for speed_rpm in [9.9, 170.1, -171.0] {
        let error = pump.at(rad_s(speed_rpm)).unwrap_err().to_string();
        assert!(error.contains("from 10 to 170 r/min"), "{error}");
    }
    assert!(pump.at(rad_s(170.0)).is_ok() && pump.at(rad_s(10.0)).is_ok());
    for asked_ml_s in [70.0, 1.0, -70.0] {
        let DisplacementError::OutsideFlows { least_ml_s, most_ml_s, .. } =
            pump.speed_for_flow(asked_ml_s).unwrap_err()
        else {
            panic!("another error")
        };
        for flow_ml_s in [least_ml_s, most_ml_s] {
            assert!(pump.speed_for_flow(flow_ml_s).is_ok(), "{flow_ml_s} is offered");
        }
        assert!(pump.speed_for_flow(most_ml_s + 2e-4).is_err());
    }
}

#[test]
fn without_a_law_a_pump_is_the_same_at_every_speed() {
    let base = Pump::three_roller();
    let pump = SpeedDependentPump::constant(base);
    for speed_rad_s in [-30.0, 0.0, 1e-3, 30.0] {
        assert_eq!(pump.at(speed_rad_s).unwrap(), base);
        assert_eq!(pump.average_flow_ml_s(speed_rad_s).unwrap(), base.average_flow_ml_s(speed_rad_s));
    }
}

#[test]
fn the_steady_state_is_that_of_the_volume_at_its_speed() {
    let (pump, base) = (pump(), Pump::three_roller());
    for speed_rpm in [20.0, 90.0, 165.0] {
        let speed_rad_s = rad_s(speed_rpm);
        let (plain, with) = (
            base.steady_state(speed_rad_s).unwrap(),
            pump.at(speed_rad_s).unwrap().steady_state(speed_rad_s).unwrap(),
        );
        let kappa = SpeedLaw::PUBLISHED.factor(&base, speed_rad_s).unwrap();
        let rest_kpa = base.outlet().reservoir_kpa;
        for (one, other) in [
            (plain.mean_flow_ml_s, with.mean_flow_ml_s),
            (plain.outlet.max_kpa - rest_kpa, with.outlet.max_kpa - rest_kpa),
            (plain.inlet.min_kpa - rest_kpa, with.inlet.min_kpa - rest_kpa),
        ] {
            // The model is linear in the flow.
            assert!((kappa * one - other).abs() < 1e-6, "{speed_rpm}: {one} {other}");
        }
        assert!((kappa - 1.0).abs() > 1e-3, "{kappa}");
    }
}
