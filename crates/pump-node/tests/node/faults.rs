//! Faults: a silent host, a dry queue, a late interrupt, a driver, the emergency stop, and a motor that rests.

use pump_link::message::{Answer, AxisConfig, AxisState, End, FaultCounts, FaultOutput, Refusal, Request};

use super::direct::{Direct, EVEN, Edge, config_with, order};

#[test]
fn a_silent_host_makes_the_motor_stop_within_its_move_after_the_dead_man_time() {
    let mut direct = Direct::configured(1);
    assert_eq!(direct.ask(&Request::Adopt { dead_man_ms: 200 }), Answer::Adopted);
    let at = direct.go(0, 1, 30);
    let fed = direct.now();
    direct.run_to(at + 400_000);
    let status = direct.status(0);
    assert_eq!(status.state, AxisState::Ended(End::DeadMan));
    assert_eq!(status.unread, FaultCounts { link: 1, ..FaultCounts::default() });
    // The motor decelerates from 200 ms after the last frame on, and still holds.
    let decelerates = (fed + 200_000 - at) / 1000;
    assert!((decelerates as i64..300).contains(&status.position), "{}", status.position);
    assert!(status.energised && !status.angle_lost);
    // A move that was prepared before is not begun later.
    assert_eq!(direct.segments(0, 1, 30, &[EVEN]), Answer::Refused(Refusal::NoSuchMove { newest: 1 }));
    // A foreign session does not feed the timer, and neither does noise.
    let at = direct.go(0, 2, 30);
    for _ in 0..8 {
        direct.run_to(direct.now() + 50_000);
        direct.ask_as(77, &Request::Status { axis: 0 });
        direct.bytes(&[0, 1, 2, 3, 0]);
    }
    assert_eq!(direct.status(0).state, AxisState::Ended(End::DeadMan));
    assert!(direct.now() < at + 500_000);
}

#[test]
fn faults_are_kept_until_they_are_read_and_confirmed_once() {
    let mut direct = Direct::configured(1);
    for move_number in 1..=2 {
        let from = direct.status(0).position;
        direct.ask(&Request::Prepare { axis: 0, move_number, order: order(from, from + 1000) });
        direct.segments(0, move_number, 0, &[EVEN]);
        let at = direct.now() + 3_000;
        direct.ask(&Request::Begin { at, moves: [move_number, 0, 0, 0] });
        direct.run_with_host(300_000);
        assert_eq!(direct.status(0).state, AxisState::Ended(End::Starved));
    }
    let two = FaultCounts { starved: 2, ..FaultCounts::default() };
    assert_eq!(direct.status(0).unread, two);
    // Another session reads them too.
    assert_eq!(direct.ask_as(43, &Request::Adopt { dead_man_ms: 500 }), Answer::Adopted);
    let one = FaultCounts { starved: 1, ..FaultCounts::default() };
    for _ in 0..2 {
        assert_eq!(
            direct.ask_as(43, &Request::FaultsRead { axis: 0, read: one }),
            Answer::Faults { unread: one }
        );
    }
    let read = FaultCounts { starved: 9, late: 9, ..FaultCounts::default() };
    let none = FaultCounts::default();
    assert_eq!(direct.ask_as(43, &Request::FaultsRead { axis: 0, read }), Answer::Faults { unread: none });
    assert_eq!(direct.status(0).faults, two);
}

#[test]
fn an_interrupt_that_is_too_late_stops_the_motor_and_is_told() {
    let mut direct = Direct::configured(1);
    let at = direct.go(0, 1, 30);
    direct.run_to(at + 20_500);
    direct.with(|hardware| hardware.now += 5_000);
    direct.run_with_host(300_000);
    let status = direct.status(0);
    assert_eq!((status.state, status.faults.late), (AxisState::Ended(End::Late), 1));
    assert_eq!(direct.rises(0).len() as i64, status.position);
}

#[test]
fn a_fault_output_is_read_at_the_level_that_its_driver_has_in_a_fault() {
    // The pins of the test are low in a fault, so that a driver with DIAG has one while they report none.
    for (output, reports) in [
        (FaultOutput::None, [false, false]),
        (FaultOutput::ActiveLow, [false, true]),
        (FaultOutput::ActiveHigh, [true, false]),
    ] {
        for (is_low, has_fault) in [(false, reports[0]), (true, reports[1])] {
            let mut direct = Direct::configured(0);
            direct.configure(0, config_with(|config| config.driver_fault = output));
            direct.with(|hardware| hardware.driver_fault[0] = is_low);
            let prepare = Request::Prepare { axis: 0, move_number: 1, order: order(0, 10) };
            let answer = direct.ask(&prepare);
            let is_refused = answer == Answer::Refused(Refusal::Driver);
            assert_eq!(is_refused, has_fault, "{output:?}, low: {is_low}: {answer:?}");
        }
    }
}

#[test]
fn the_emergency_stop_stops_dead_and_loses_the_angle() {
    let mut direct = Direct::configured(2);
    let at = direct.go(0, 1, 30);
    direct.run_to(at + 10_500);
    direct.with(|hardware| hardware.estop = true);
    direct.run_to(at + 11_500);
    let status = direct.status(0);
    assert_eq!((status.position, status.state), (10, AxisState::Ended(End::Estop)));
    assert!(status.angle_lost && !status.energised && status.faults.estop == 1);
    assert_eq!(direct.status(1).faults.estop, 1);
    // People may have turned the rotor of an axis too that no host has configured.
    let unconfigured = direct.status(3);
    assert_eq!((unconfigured.state, unconfigured.unread.estop), (AxisState::Unconfigured, 1));
    assert!(!unconfigured.angle_lost && !unconfigured.energised);
    let prepare =
        |move_number, from: i64| Request::Prepare { axis: 0, move_number, order: order(from, from + 10) };
    assert_eq!(direct.refused(&prepare(2, 10)), Refusal::AngleLost);
    direct.with(|hardware| hardware.estop = false);
    direct.run_with_host(10_000);
    assert_eq!(direct.refused(&prepare(2, 10)), Refusal::AngleLost);
    direct.configure(0, AxisConfig::new(0));
    assert_eq!(direct.ask(&prepare(2, 10)), Answer::Accepted { next: 0, room: 32 });
    assert_eq!(direct.status(0).faults.estop, 1);
    // Nothing is prepared, begun or configured while it is pressed.
    direct.segments(0, 2, 0, &[EVEN]);
    direct.with(|hardware| hardware.estop = true);
    let at = direct.now() + 5_000;
    assert_eq!(direct.refused(&Request::Begin { at, moves: [2, 0, 0, 0] }), Refusal::Estop);
    assert_eq!(direct.status(0).state, AxisState::Ended(End::Estop));
}

#[test]
fn a_drivers_fault_lets_go_of_the_motor() {
    let mut direct = Direct::configured(0);
    direct.configure(0, config_with(|config| config.driver_fault = FaultOutput::ActiveLow));
    direct.with(|hardware| hardware.driver_fault[0] = true);
    let prepare = Request::Prepare { axis: 0, move_number: 1, order: order(0, 10) };
    assert_eq!(direct.refused(&prepare), Refusal::Driver);
    direct.with(|hardware| hardware.driver_fault[0] = false);
    let at = direct.go(0, 1, 30);
    direct.run_to(at + 10_500);
    direct.with(|hardware| hardware.driver_fault[0] = true);
    direct.run_to(at + 15_000);
    let status = direct.status(0);
    assert_eq!((status.state, status.faults.driver), (AxisState::Ended(End::Driver), 1));
    assert!(status.angle_lost && !status.energised);
    assert_eq!(direct.rises(0).len() as i64, status.position);
}

#[test]
fn a_motor_that_has_rested_long_enough_is_let_go() {
    let mut direct = Direct::configured(0);
    direct.configure(0, config_with(|config| (config.idle_release_ms, config.energised) = (100, true)));
    direct.run_with_host(99_000);
    assert!(direct.status(0).energised);
    direct.run_with_host(3_000);
    let status = direct.status(0);
    assert!(!status.energised && status.angle_lost && status.faults.is_empty());
    let last = direct.with(|hardware| hardware.edges.last().copied());
    assert!(matches!(last, Some((100_000..=101_000, 0, Edge::Enable(true)))), "{last:?}");
}
