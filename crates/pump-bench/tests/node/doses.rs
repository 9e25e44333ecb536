//! Doses that nothing disturbs, and doses that are stopped or wait for the disk.

use pump_bench::drives::{Drive, Leave};
use pump_bench::pump_file::Axis;

use crate::rig::{Rig, dose, run, worst};
use crate::world::TICK_HZ;

#[test]
fn every_step_comes_within_a_microsecond_of_its_time() {
    for (volume_ml, ml_s, smooth) in [
        (2.0, 1.0, false),
        (2.0, 1.0, true),
        (4.0, 4.0, true),
        (6.0, 8.0, true),
        (-3.0, 4.0, true),
        (5.0, 8.0, false),
    ] {
        let rig = Rig::new();
        let plan = dose(volume_ml, ml_s, smooth);
        let mut drive = rig.open();
        assert_eq!(run(&mut drive, &plan), plan.steps().unsigned_abs());
        assert_eq!(rig.world.count(), plan.steps());
        assert_eq!(drive.count(), Some(plan.steps()));
        let worst = worst(&rig.world.rises(), &plan);
        assert!(worst <= 1.0, "{volume_ml} mL at {ml_s} mL/s: {worst} us");
        assert_eq!(rig.world.hardware(|hardware| hardware.motors[0].stray), 0);
    }
}

#[test]
fn a_line_that_loses_frames_delays_no_step() {
    let rig = Rig::new();
    let plan = dose(6.0, 4.0, true);
    let mut drive = rig.open();
    rig.world.0.lock().unwrap().lost = 0.05;
    assert_eq!(run(&mut drive, &plan), plan.steps().unsigned_abs());
    assert!(worst(&rig.world.rises(), &plan) <= 1.0);
}

#[test]
fn bytes_that_change_on_their_way_change_no_count_and_delay_no_step() {
    for seed in 1..=8 {
        let rig = Rig::new();
        let (whole, part) = (dose(4.0, 4.0, true), dose(-3.0, 4.0, false));
        let mut drive = rig.open();
        {
            let mut world = rig.world.0.lock().unwrap();
            (world.corrupted, world.random) = (0.05, 0x9e37_79b9_7f4a_7c15 ^ seed);
        }
        assert_eq!(run(&mut drive, &whole), whole.steps().unsigned_abs());
        assert!(worst(&rig.world.rises(), &whole) <= 1.0, "seed {seed}");
        drive.check(&part).unwrap();
        let world = rig.world.clone();
        let stop_us = world.now_us() + 60_000 * seed;
        let made = drive
            .run(&part, &mut |_, _| if world.now_us() >= stop_us { Leave::Stop } else { Leave::Go })
            .unwrap();
        let counts = whole.steps() - made as i64;
        assert!(made < part.steps().unsigned_abs(), "seed {seed}");
        assert_eq!((rig.world.count(), drive.count()), (counts, Some(counts)), "seed {seed}");
        drop(drive);
        // A drive that meets the board over this line counts on from there.
        let mut drive = rig.open();
        assert_eq!((drive.disturbed(), drive.count()), (None, Some(counts)), "seed {seed}");
    }
}

#[test]
fn doses_follow_each_other_on_any_axis_and_back() {
    let rig = Rig::new();
    let mut drive = rig.open_by(&Rig::table().with_axis(Axis::A).with_invert(true), &rig.opening()).unwrap();
    let (forth, back) = (dose(1.0, 4.0, true), dose(-1.0, 4.0, false));
    run(&mut drive, &forth);
    run(&mut drive, &back);
    let counts = rig.world.hardware(|hardware| [0, 1, 2, 3].map(|axis| hardware.motors[axis].count));
    assert_eq!(counts, [0, 0, 0, -(forth.steps() + back.steps())]);
    assert_eq!(drive.count(), Some(forth.steps() + back.steps()));
}

#[test]
fn a_stop_acts_at_once_and_its_count_is_exact() {
    for (ml_s, stop_ms) in [(1.0, 300), (4.0, 700), (8.0, 400), (8.0, 30)] {
        let rig = Rig::new();
        let plan = dose(10.0, ml_s, true);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        let begin_us = rig.world.now_us();
        let mut stopped_us = None;
        let made = drive.run(&plan, &mut |_, _| {
            let now_us = rig.world.now_us();
            if now_us < begin_us + stop_ms * 1000 {
                return Leave::Go;
            }
            stopped_us.get_or_insert(now_us);
            Leave::Stop
        });
        let made = made.unwrap();
        assert!(made < plan.steps().unsigned_abs());
        assert_eq!(made as i64, rig.world.count(), "{ml_s} mL/s");
        let took_us = rig.world.now_us() - stopped_us.unwrap();
        assert!(took_us < 200_000, "{ml_s} mL/s: {took_us} us to rest");
    }
}

#[test]
fn a_motor_that_waits_for_the_disk_rests_within_its_leave_and_goes_on() {
    for pause_ms in [200, 1000, 3000] {
        let rig = Rig::new();
        let plan = dose(12.0, 4.0, true);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        let begin_us = rig.world.now_us();
        let (mut left, mut waited) = (0, 0);
        let made = drive.run(&plan, &mut |made, about_to| {
            let now_ms = (rig.world.now_us() - begin_us) / 1000;
            assert!(made <= about_to && rig.world.count() as u64 <= left.max(made), "{now_ms} ms");
            if about_to > left && (1000..1000 + pause_ms).contains(&now_ms) {
                waited += 1;
                return Leave::Wait;
            }
            left = left.max(about_to);
            Leave::Go
        });
        assert_eq!(made.unwrap() as i64, rig.world.count());
        assert_eq!(rig.world.count(), plan.steps());
        assert!(waited > 0);
        let rises = rig.world.rises();
        let longest_us = rises.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap();
        // A pause of 1 s is unseen. A longer one has the motor rest.
        assert_eq!(longest_us > u64::from(TICK_HZ) / 20, pause_ms > 1000, "{pause_ms} ms: {longest_us} us");
        if pause_ms <= 1000 {
            assert!(worst(&rises, &plan) <= 1.0);
        }
        // Nowhere is the motor faster than the plan.
        let shortest = |times: &[u64]| times.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap();
        let planned: Vec<u64> = crate::rig::times(&plan).iter().map(|time| *time as u64).collect();
        assert!(shortest(&rises) + 3 >= shortest(&planned), "{} {}", shortest(&rises), shortest(&planned));
    }
}

#[test]
fn a_slow_motor_that_rests_for_want_of_leave_goes_on_no_faster_than_its_plan() {
    let rig = Rig::new();
    let plan = dose(0.01, 0.005, false);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    let begin_us = rig.world.now_us();
    let made = drive.run(&plan, &mut |_, _| {
        let now_ms = (rig.world.now_us() - begin_us) / 1000;
        if (1000..6000).contains(&now_ms) { Leave::Wait } else { Leave::Go }
    });
    assert_eq!(made.unwrap() as i64, plan.steps());
    assert_eq!(rig.world.count(), plan.steps());
    let between = |times: &[u64]| -> Vec<u64> { times.windows(2).map(|pair| pair[1] - pair[0]).collect() };
    let planned: Vec<u64> = crate::rig::times(&plan).iter().map(|time| *time as u64).collect();
    let (made, planned) = (between(&rig.world.rises()), between(&planned));
    assert!(made.iter().any(|time| *time > 2_000_000), "the motor has not rested");
    assert!(made.iter().zip(&planned).all(|(made, planned)| made + 3 >= *planned), "{made:?}");
}

#[test]
fn the_index_mark_ends_a_search() {
    let rig = Rig::new();
    rig.world.hardware(|hardware| hardware.index_at = Some(400));
    let table = Rig::table().with_index_angle_deg(10.0);
    let mut drive = rig.open_by(&table, &rig.opening()).unwrap();
    let plan = dose(5.0, 1.0, false);
    let found = drive.seek(&plan, &mut crate::rig::go).unwrap();
    assert_eq!(found.made as i64, rig.world.count());
    // The sensor is read as the step begins. A real rotor arrives later, and the simulated one is there at once.
    assert!((399..=400).contains(&(found.made - found.beyond.unwrap())), "{found:?}");
}
