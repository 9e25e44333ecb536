//! Links that break, boards that are reset, and emergency stops.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use pump_bench::drives::{CommonBegin, Disturbance, Drive, Node, NodeBoard, NodeError};
use pump_bench::pump_file::{DriverFault, PinsTable};

use crate::rig::{Rig, dose, go, node_error, run, worst};
use crate::several::{PATIENT, Shared, counts, pour};
use crate::world::{Event, SharedWorld};

#[test]
fn a_reset_in_mid_dose_leaves_a_bracket_that_holds_the_truth() {
    for in_ms in [50, 300, 900, 1500] {
        let rig = Rig::new();
        let plan = dose(10.0, 4.0, true);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        rig.world.plan(in_ms, Event::Reset);
        let fault = drive.run(&plan, &mut go).unwrap_err();
        let count = rig.world.count();
        assert!(matches!(node_error(&fault.error), NodeError::Reset), "{:?}", fault.error);
        assert!((fault.made_least..=fault.made_most).contains(&count), "{count} {fault:?}");
        assert!(fault.made_most <= plan.steps());
        assert_eq!(drive.count(), None);
        rig.world.pass(1000);
        assert_eq!(rig.world.count(), count, "nothing moves after a reset");
        drop(drive);
        assert_eq!(rig.open().disturbed(), Some(Disturbance::Reset));
    }
}

#[test]
fn a_link_that_is_cut_for_a_second_costs_the_dose_and_no_step_of_the_count() {
    let rig = Rig::new();
    let plan = dose(20.0, 4.0, true);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    rig.world.plan(800, Event::Cut);
    rig.world.plan(1800, Event::Mend);
    let fault = drive.run(&plan, &mut go).unwrap_err();
    assert!(matches!(node_error(&fault.error), NodeError::DeadMan { .. }), "{:?}", fault.error);
    assert_eq!((fault.made_least, fault.made_most), (rig.world.count(), rig.world.count()));
    assert!(fault.made_least > 0 && fault.made_most < plan.steps());
    // The session and the count live on.
    drive.connect().unwrap();
    assert_eq!(drive.count(), Some(rig.world.count()));
    assert_eq!(drive.disturbed(), None);
    run(&mut drive, &dose(1.0, 4.0, true));
}

#[test]
fn a_link_that_is_cut_for_a_fifth_of_a_second_is_unseen() {
    let rig = Rig::new();
    let plan = dose(10.0, 4.0, true);
    let mut drive = rig.open();
    rig.world.plan(1000, Event::Cut);
    rig.world.plan(1200, Event::Mend);
    assert_eq!(run(&mut drive, &plan), plan.steps().unsigned_abs());
    assert!(worst(&rig.world.rises(), &plan) <= 1.0);
}

#[test]
fn a_live_board_that_is_silent_or_slow_leaves_the_exact_count_of_each_axis_though_a_fault_of_one_stops_all() {
    let cut = |mends_in_ms: u64| vec![(0, Event::Cut), (mends_in_ms, Event::Mend)];
    for befalls in [cut(700), cut(1_500), vec![(0, Event::Slow)]] {
        let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
        let board = NodeBoard::over(Box::new(world.clone()));
        let mut places = CommonBegin::places(4, PATIENT);
        let [has_befallen, is_over] = [false; 2].map(AtomicBool::new);
        let all: Vec<Shared> = thread::scope(|scope| {
            let doses = [(12.0, 4.0), (12.0, 2.0), (-12.0, 3.0), (12.0, 1.0)];
            let threads: Vec<_> = (0..)
                .zip(doses)
                .map(|dose| {
                    let (board, state, place) = (&board, state.path(), places.pop());
                    let (world, befalls, has_befallen, is_over) = (&world, &befalls, &has_befallen, &is_over);
                    scope.spawn(move || {
                        let one = pour(board, state, dose, place, |made| {
                            if dose.0 == 2 && made > 300 && !has_befallen.swap(true, Ordering::Relaxed) {
                                befalls.iter().for_each(|(in_ms, event)| world.plan(3 + in_ms, *event));
                            }
                            match is_over.load(Ordering::Relaxed) {
                                true => ControlFlow::Break(()),
                                false => ControlFlow::Continue(()),
                            }
                        });
                        is_over.store(true, Ordering::Relaxed);
                        one
                    })
                })
                .collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        for (axis, (one, count)) in all.iter().zip(counts(&world)).enumerate() {
            let exact = (Some((count.abs(), count.abs())), Some(count));
            assert_eq!((one.part, one.count), exact, "{befalls:?}, axis {axis}: {one:?}");
        }
    }
}

#[test]
fn a_board_that_stays_silent_leaves_a_bracket_and_its_count_is_read_later() {
    let rig = Rig::new();
    let plan = dose(20.0, 4.0, true);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    rig.world.plan(800, Event::Cut);
    let fault = drive.run(&plan, &mut go).unwrap_err();
    assert!(matches!(node_error(&fault.error), NodeError::Quiet { .. }), "{:?}", fault.error);
    let count = rig.world.count();
    assert!((fault.made_least..=fault.made_most).contains(&count), "{count} {fault:?}");
    assert!(drive.connect().is_err());
    rig.world.plan(0, Event::Mend);
    drop(drive);
    let mut drive = rig.open();
    assert_eq!((drive.count(), drive.disturbed()), (Some(count), None));
}

#[test]
fn an_emergency_stop_loses_the_angle() {
    let rig = Rig::new();
    let plan = dose(10.0, 4.0, true);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    rig.world.plan(700, Event::Estop);
    let fault = drive.run(&plan, &mut go).unwrap_err();
    assert!(fault.lost && matches!(node_error(&fault.error), NodeError::Estop), "{:?}", fault.error);
    let refused = drive.connect().unwrap_err();
    assert!(matches!(node_error(&refused), NodeError::Estop), "{refused:?}");
    rig.world.hardware(|hardware| hardware.estop = false);
    drive.connect().unwrap();
    assert_eq!(drive.disturbed(), Some(Disturbance::EmergencyStop));
    run(&mut drive, &dose(1.0, 4.0, false));
}

#[test]
fn an_emergency_stop_at_rest_is_told_too_while_the_board_is_met_and_before() {
    let rig = Rig::new();
    let plan = dose(1.0, 4.0, false);
    let mut drive = rig.open();
    run(&mut drive, &plan);
    assert_eq!(drive.disturbed(), Some(Disturbance::Reset));
    let press = |is_pressed| {
        rig.world.hardware(|hardware| hardware.estop = is_pressed);
        rig.world.pass(10);
    };
    press(true);
    press(false);
    let refused = drive.check(&plan).unwrap_err();
    assert!(matches!(node_error(&refused), NodeError::Estop), "{refused:?}");
    assert_eq!((drive.disturbed(), drive.is_without_current()), (Some(Disturbance::EmergencyStop), true));
    drop(drive);
    let mut drive = rig.open();
    assert_eq!((drive.disturbed(), drive.is_without_current()), (Some(Disturbance::EmergencyStop), false));
    drive.check(&plan).unwrap();
}

#[test]
fn a_fault_of_the_stepper_driver_that_stays_is_named_and_is_one_disturbance() {
    let rig = Rig::new();
    let mut pins = PinsTable::default();
    pins.driver_fault = Some(DriverFault::Low);
    let table = Rig::table().with_pins(pins);
    let open = || rig.open_by(&table, &rig.opening()).unwrap();
    let plan = dose(1.0, 4.0, false);
    let mut drive = open();
    run(&mut drive, &plan);
    assert_eq!(drive.disturbed(), Some(Disturbance::Reset));
    let fault = |reports| {
        rig.world.hardware(|hardware| hardware.has_driver_fault = reports);
        rig.world.pass(10);
    };
    let refused = |drive: &mut Node| {
        rig.world.pass(10);
        let refused = drive.check(&plan).unwrap_err();
        assert!(matches!(node_error(&refused), NodeError::Driver), "{refused:?}");
        assert!(drive.is_without_current());
    };
    // The fault comes while the drive is open, and stays.
    fault(true);
    refused(&mut drive);
    assert_eq!(drive.disturbed(), Some(Disturbance::Disabled));
    drive.connect().unwrap();
    assert_eq!(drive.disturbed(), Some(Disturbance::Disabled));
    // The motor cannot be given current, so nothing more has disturbed it.
    refused(&mut drive);
    assert_eq!(drive.disturbed(), None);
    fault(false);
    drive.connect().unwrap();
    run(&mut drive, &plan);
    assert!(!drive.is_without_current());
}

#[test]
fn a_released_motor_is_met_anew() {
    let rig = Rig::new();
    let mut drive = rig.open();
    assert_eq!(drive.disturbed(), Some(Disturbance::Reset));
    drive.release().unwrap();
    drive.connect().unwrap();
    assert_eq!(drive.disturbed(), Some(Disturbance::Disabled));
    run(&mut drive, &dose(1.0, 4.0, false));
}

#[test]
fn a_board_that_is_held_up_at_rest_is_asked_again_for_three_seconds() {
    let rig = Rig::new();
    let mut drive = rig.open();
    rig.world.plan(0, Event::Cut);
    rig.world.plan(2500, Event::Mend);
    drive.release().unwrap();
    drive.connect().unwrap();
    run(&mut drive, &dose(1.0, 4.0, false));

    rig.world.pass(10_000);
    rig.world.plan(0, Event::Cut);
    let silent = drive.release().unwrap_err();
    let NodeError::Quiet { waited_s } = *node_error(&silent) else { panic!("{silent:?}") };
    assert!((3.0..3.3).contains(&waited_s), "{waited_s}");
}
