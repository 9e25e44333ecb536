//! The index sensor.

use pump_ctl::drive::{OnFault, StepDir, StepMotor, Timing};
use pump_ctl::step::Segment;

use super::wires::Bench;
use super::{OnPins, on_pins, start, turn_on_time};

const AHEAD: Segment = Segment { count: 40, interval: 500, add: 0, frac: 0 };
const BACK: Segment = Segment { count: -40, ..AHEAD };

fn moved(actuator: &mut OnPins<8>, bench: &Bench, segments: &[Segment]) -> Option<i64> {
    let due = start(actuator, bench, segments.iter().copied()).unwrap();
    turn_on_time(actuator, bench, due).unwrap();
    actuator.index_at()
}

#[test]
fn the_position_at_which_the_sensor_becomes_active_is_noted() {
    for index_active_low in [false, true] {
        let bench = Bench::default();
        let timing = Timing::new().with_index_active_low(index_active_low);
        // The pin is high inside the sensor, or everywhere outside, where "outside" is active.
        bench.state().sensor = Some(12..20);
        let mut actuator = on_pins::<8>(&bench, timing, OnFault::Hold);
        assert_eq!(moved(&mut actuator, &bench, &[AHEAD, BACK]), None, "not watched");
        actuator.watch_index().unwrap();
        let (ahead, back) = if index_active_low { (20, 11) } else { (12, 19) };
        assert_eq!(moved(&mut actuator, &bench, &[AHEAD]), Some(ahead));
        assert_eq!(moved(&mut actuator, &bench, &[BACK]), Some(back));
        actuator.watch_index().unwrap();
        assert_eq!(actuator.index_at(), None, "anew");
    }
}

#[test]
fn a_rotor_that_stands_in_the_sensor_must_leave_it_first() {
    let bench = Bench::default();
    bench.state().sensor = Some(-5..30);
    let mut actuator = on_pins::<8>(&bench, Timing::default(), OnFault::Hold);
    actuator.watch_index().unwrap();
    assert_eq!(moved(&mut actuator, &bench, &[AHEAD]), None);
    assert_eq!(moved(&mut actuator, &bench, &[BACK]), Some(29));
}

#[test]
fn a_new_zero_at_the_index_counts_on() {
    let bench = Bench::default();
    bench.state().sensor = Some(12..20);
    let mut actuator = on_pins::<8>(&bench, Timing::default(), OnFault::Hold);
    actuator.watch_index().unwrap();
    let index = moved(&mut actuator, &bench, &[AHEAD]).unwrap();
    let beyond = actuator.stepper().position() - index;
    assert!(actuator.stepper().set_position(beyond));
    assert_eq!(moved(&mut actuator, &bench, &[BACK]), Some(7));
    assert_eq!(actuator.stepper().position(), -12);
}

#[test]
fn a_motor_without_a_sensor_has_no_index() {
    let bench = Bench::default();
    let [step, direction, enable, _] = bench.wires();
    let mut driver = StepDir::new(step, direction, enable, bench.clone(), Timing::default());
    assert_eq!(driver.index(), Ok(None));
}
