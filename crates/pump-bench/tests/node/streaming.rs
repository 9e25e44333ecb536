//! A computer that is held up while it streams, and users who do not wait.

use std::time::Duration;

use pump_bench::drives::{Drive, Leave, NodeError, Opening, StopRequest};

use crate::rig::{Rig, dose, node_error, run, worst};
use crate::world::Event;

/// Shortest time that the board's queue may have left, us.
const RESERVE_US: u64 = 200_000;

#[test]
fn a_second_in_which_nobody_asks_for_leave_is_unseen_at_any_speed() {
    for (volume_ml, ml_s, smooth) in
        [(40.0, 9.0, true), (40.0, 10.0, false), (20.0, 4.0, true), (4.0, 1.0, true)]
    {
        let rig = Rig::new();
        let plan = dose(volume_ml, ml_s, smooth);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        let begin_us = rig.world.now_us();
        let (mut held_up, mut left) = (0, 0);
        let made = drive.run(&plan, &mut |made, about_to| {
            // The board makes no step without leave, however long this takes.
            assert!(made <= about_to && rig.world.count() as u64 <= left.max(made));
            left = left.max(about_to);
            let now_us = rig.world.now_us() - begin_us;
            if now_us > 1_500_000 * (held_up + 1) && held_up < 2 {
                held_up += 1;
                assert!(rig.world.hold_up(Duration::from_secs(1)));
            }
            Leave::Go
        });
        assert_eq!(made.unwrap(), plan.steps().unsigned_abs());
        assert!(held_up > 0);
        let least_us = rig.world.0.lock().unwrap().onlooker.queues[0].least;
        assert!((RESERVE_US..1_000_000).contains(&least_us), "{ml_s} mL/s: {least_us} us");
        let worst = worst(&rig.world.rises(), &plan);
        assert!(worst <= 1.0, "{ml_s} mL/s: {worst} us");
    }
}

#[test]
fn a_motor_that_makes_few_steps_a_second_never_rests() {
    // Steps come 0.34 to 1.7 s apart.
    for ml_s in [0.005, 0.003, 0.002, 0.001] {
        let rig = Rig::new();
        let plan = dose(0.008, ml_s, false);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        let (mut begin_us, mut left) = (rig.world.now_us(), 0);
        let made = drive.run(&plan, &mut |made, about_to| {
            assert!(made <= about_to && rig.world.count() as u64 <= left.max(made));
            left = left.max(about_to);
            // The thread that asks is held up for a second of every three.
            if rig.world.now_us() > begin_us + 3_000_000 {
                assert!(rig.world.hold_up(Duration::from_secs(1)));
                begin_us = rig.world.now_us();
            }
            Leave::Go
        });
        assert_eq!(made.unwrap(), plan.steps().unsigned_abs());
        let least_us = rig.world.0.lock().unwrap().onlooker.queues[0].least;
        assert!(least_us >= RESERVE_US, "{ml_s} mL/s: {least_us} us");
        let worst = worst(&rig.world.rises(), &plan);
        assert!(worst <= 1.0, "{ml_s} mL/s: {worst} us");
    }
}

#[test]
fn a_computer_that_is_held_up_for_longer_ends_within_its_leave_and_goes_on() {
    let rig = Rig::new();
    let plan = dose(20.0, 4.0, true);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    let begin_us = rig.world.now_us();
    let (mut held_up, mut left) = (false, 0);
    let made = drive.run(&plan, &mut |_, about_to| {
        left = left.max(about_to);
        if rig.world.now_us() > begin_us + 1_500_000 && !held_up {
            held_up = true;
            assert!(rig.world.hold_up(Duration::from_secs(10)));
            assert!(rig.world.count() as u64 <= left, "{} {left}", rig.world.count());
        }
        Leave::Go
    });
    assert_eq!(made.unwrap() as i64, rig.world.count());
    assert_eq!(rig.world.count(), plan.steps());
    assert!(held_up);
}

#[test]
fn a_computer_that_stands_for_longer_than_the_queue_leaves_the_dose_unfinished_and_its_count_exact() {
    for dead_man_ms in [500, 5_000] {
        let rig = Rig::new();
        let plan = dose(20.0, 4.0, true);
        let mut drive = rig.open_by(&Rig::table().with_dead_man_ms(dead_man_ms), &rig.opening()).unwrap();
        drive.check(&plan).unwrap();
        let begin_us = rig.world.now_us();
        let mut has_stood = false;
        let fault = drive.run(&plan, &mut |_, _| {
            if rig.world.now_us() > begin_us + 1_500_000 && !has_stood {
                has_stood = true;
                // Both threads stand, as after SIGSTOP.
                rig.world.pass(1_500);
            }
            Leave::Go
        });
        let fault = fault.unwrap_err();
        match node_error(&fault.error) {
            NodeError::DeadMan { .. } if dead_man_ms == 500 => {}
            NodeError::HeldUp if dead_man_ms == 5_000 => {}
            error => panic!("{dead_man_ms} ms: {error:?}"),
        }
        let count = rig.world.count();
        assert_eq!((fault.made_least, fault.made_most, fault.lost), (count, count, false));
        assert!(count > 0 && count < plan.steps());
        drive.connect().unwrap();
        assert_eq!(drive.count(), Some(count));
        // An empty queue was told by the error.
        assert!(drive.notes().is_empty() || dead_man_ms == 500);
    }
}

#[test]
fn the_queue_lasts_200_ms_on_a_line_that_loses_frames() {
    let rig = Rig::new();
    let plan = dose(20.0, 8.0, true);
    let mut drive = rig.open();
    rig.world.0.lock().unwrap().lost = 0.02;
    assert_eq!(run(&mut drive, &plan), plan.steps().unsigned_abs());
    let least_us = rig.world.0.lock().unwrap().onlooker.queues[0].least;
    assert!(least_us >= RESERVE_US, "{least_us} us");
}

#[test]
fn a_user_who_asks_to_stop_while_a_lost_board_is_sought_waits_six_tenths_of_a_second_at_most() {
    let rig = Rig::new();
    let plan = dose(20.0, 4.0, true);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    rig.world.plan(800, Event::Cut);
    let begin_us = rig.world.now_us();
    let mut asked_us = None;
    let fault = drive.run(&plan, &mut |_, _| {
        let now_us = rig.world.now_us();
        if now_us < begin_us + 2_000_000 {
            return Leave::Go;
        }
        asked_us.get_or_insert(now_us);
        Leave::Stop
    });
    let fault = fault.unwrap_err();
    assert!(matches!(node_error(&fault.error), NodeError::Quiet { .. }), "{:?}", fault.error);
    let waited_us = rig.world.now_us() - asked_us.unwrap();
    assert!(waited_us <= 600_000, "{waited_us} us");
    // The board stops by itself, within the bounds that are told.
    rig.world.pass(2000);
    let count = rig.world.count();
    assert!((fault.made_least..=fault.made_most).contains(&count), "{count} {fault:?}");
}

#[test]
fn a_user_who_asks_to_stop_while_a_port_is_asked_waits_a_fifth_of_a_second_at_most() {
    for foreign in [b"".to_vec(), b"Grbl 1.1h ['$' for help]\r\n".to_vec()] {
        let rig = Rig::new();
        rig.world.0.lock().unwrap().foreign = Some(foreign);
        let (clock, begin_us) = (rig.world.clone(), rig.world.now_us());
        let stop = StopRequest::new(move || {
            // The request is asked for while the world is at rest.
            clock.0.try_lock().is_ok_and(|world| world.now_us > begin_us + 1_000_000)
        });
        let opening = Opening { stop, ..rig.opening() };
        let refused = rig.open_by(&Rig::table(), &opening).unwrap_err();
        assert!(matches!(refused, pump_bench::drives::DriveError::Interrupted), "{refused:?}");
        let waited_us = rig.world.now_us() - begin_us - 1_000_000;
        assert!(waited_us <= 200_000, "{waited_us} us");
        assert!(rig.world.rises().is_empty());
    }
}
