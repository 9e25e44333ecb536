//! Doses that nothing disturbs, and doses that are stopped or wait for the disk.

use std::time::{Duration, Instant};

use pump_bench::built_in;
use pump_bench::drives::{Drive, Leave};
use pump_ctl::plan::Plan;

use crate::rig::{Rig, dose, run, said, socket, turn};
use crate::simulated_klipper::{Character, IndexSensor, pin_of};

/// Largest distance of a step from the plan, in us.
const MOST_US: f64 = 2.0;

/// Returns the times of steps in s since the begin from which they are nearest to the plan's, and their largest
/// distance from it in us.
fn held(steps: &[(u64, i64)], plan: &Plan, hz: f64) -> (Vec<f64>, f64) {
    assert_eq!(steps.len() as u64, plan.steps().unsigned_abs());
    assert!(steps.iter().all(|(_, way)| *way == plan.steps().signum()));
    let first = steps[0].0;
    let times: Vec<f64> = steps.iter().map(|(tick, _)| (tick - first) as f64 / hz).collect();
    let off = |(time, step): (&f64, pump_ctl::plan::Step)| time - step.time_s;
    let offs: Vec<f64> = times.iter().zip(plan.each_step()).map(off).collect();
    let (least, most) =
        offs.iter().fold((f64::MAX, f64::MIN), |(least, most), off| (least.min(*off), most.max(*off)));
    let middle = f64::midpoint(least, most);
    (times.iter().map(|time| time - middle).collect(), 0.5e6 * (most - least))
}

/// Returns the flow of each stretch of so many steps by their times, in mL/s.
fn flows(plan: &Plan, times: &[f64], stretch: usize) -> Vec<f64> {
    let pump = built_in("three-roller").unwrap().model().unwrap();
    let volume = |count: usize| plan.delivered_ml(&pump, count as u64);
    let places: Vec<usize> = (stretch..times.len()).step_by(stretch).collect();
    let flow =
        |pair: &[usize]| (volume(pair[1] + 1) - volume(pair[0] + 1)) / (times[pair[1]] - times[pair[0]]);
    places.windows(2).map(flow).collect()
}

#[test]
fn every_step_is_within_2_us_of_the_plan_and_the_ripple_is_the_plans() {
    for (volume_ml, ml_s, smooth, hz, drift_ppm) in [
        (3.0, 4.0, false, 72_000_000, 100.0),
        (4.0, 4.0, true, 72_000_000, -100.0),
        (-3.0, 4.0, true, 180_000_000, 50.0),
        (2.0, 2.0, true, 16_000_000, -100.0),
    ] {
        let first_tick = (1 << 32) - u64::from(hz);
        let rig = Rig::new(Character { hz, drift_ppm, first_tick, baud: 0, ..Character::default() });
        let plan = dose(volume_ml, ml_s, smooth);
        let mut drive = rig.open();
        assert_eq!(run(&mut drive, &plan).unwrap(), plan.steps().unsigned_abs());
        let truth = rig.board.truth();
        assert_eq!((truth.steps[0], drive.count()), (plan.steps(), Some(plan.steps())));
        assert_eq!((truth.stray, truth.shutdown), (0, None));
        // The clock turns over 32 bits during the dose.
        let (times, worst_us) = held(&rig.steps_of("X"), &plan, f64::from(hz));
        assert!(worst_us <= MOST_US, "{volume_ml} mL at {ml_s} mL/s, {hz} Hz: {worst_us} us");
        let planned: Vec<f64> = plan.each_step().map(|step| step.time_s).collect();
        let (made, planned) = (flows(&plan, &times, 100), flows(&plan, &planned, 100));
        let worst = made.iter().zip(&planned).map(|(made, planned)| ((made - planned) / planned).abs());
        let worst = worst.fold(0.0, f64::max);
        assert!(worst <= 1e-3, "{volume_ml} mL at {ml_s} mL/s, {hz} Hz: the flow is {worst} off");
    }
}

#[test]
fn doses_follow_each_other_at_any_socket_and_the_queue_of_a_small_board_is_never_overrun() {
    let rig = Rig::new(Character { slots: 256, ..Character::default() });
    let table = rig.table().with_klipper(socket("E")).with_invert(true);
    let mut drive = rig.open_by(&table).unwrap();
    let (forth, back) = (dose(2.0, 6.0, true), dose(-1.0, 4.0, false));
    run(&mut drive, &forth).unwrap();
    run(&mut drive, &back).unwrap();
    let truth = rig.board.truth();
    assert_eq!(truth.steps, [0, 0, 0, -(forth.steps() + back.steps())]);
    assert!(truth.most_used <= 256 && truth.stray == 0, "{truth:?}");
    assert_eq!(drive.count(), Some(forth.steps() + back.steps()));
}

#[test]
fn a_stop_ends_by_a_ramp_and_its_count_is_exact() {
    for (ml_s, stop_ms) in [(2.0, 500), (8.0, 400), (8.0, 60)] {
        let rig = Rig::new(Character::default());
        let plan = dose(12.0, ml_s, true);
        let mut drive = rig.open();
        drive.check(&plan).unwrap();
        let (began, mut announced) = (Instant::now(), 0);
        let made = drive.run(&plan, &mut |_, about_to| {
            if began.elapsed() > Duration::from_millis(stop_ms) {
                return Leave::Stop;
            }
            announced = announced.max(about_to);
            Leave::Go
        });
        let made = made.unwrap();
        assert!(made > 0 && made < plan.steps().unsigned_abs() && made <= announced);
        assert_eq!((made as i64, drive.count()), (rig.board.truth().steps[0], Some(made as i64)));
        // No stop is later than what was queued, and the way to rest.
        let steps = rig.steps_of("X");
        assert_eq!(rig.board.truth().shutdown, None);
        // The last interval is that of a motor which comes to rest within a step.
        let acceleration = plan.profile().acceleration_rad_s2() / plan.step_rad();
        let last = (steps[steps.len() - 1].0 - steps[steps.len() - 2].0) as f64 / 72e6;
        assert!(1.0 / last <= 2.0 * (2.0 * acceleration).sqrt(), "{last} s before the last step");
    }
}

#[test]
fn a_motor_without_leave_comes_to_rest_within_it_and_goes_on() {
    let rig = Rig::new(Character::default());
    let plan = dose(6.0, 6.0, false);
    let mut drive = rig.open();
    drive.check(&plan).unwrap();
    let (all, mut most, mut waits_until) = (plan.steps().unsigned_abs(), 0, None);
    let made = drive.run(&plan, &mut |made, about_to| {
        assert!(made <= all);
        if about_to > all / 2
            && *waits_until.get_or_insert(Instant::now() + Duration::from_millis(1500)) > Instant::now()
        {
            assert!(rig.board.truth().steps[0] as u64 <= most, "beyond its leave");
            return Leave::Wait;
        }
        most = most.max(about_to);
        Leave::Go
    });
    assert_eq!(made.unwrap(), all);
    let truth = rig.board.truth();
    assert_eq!((truth.steps[0], truth.shutdown), (plan.steps(), None));
    let steps = rig.steps_of("X");
    let longest = steps.windows(2).map(|pair| pair[1].0 - pair[0].0).max().unwrap();
    assert!(longest > 7_200_000, "it has rested");
}

#[test]
fn an_index_sensor_is_found_by_the_boards_trigger() {
    let pin = pin_of("PC0").unwrap();
    let index = Some(IndexSensor { pin, socket: 0, steps: 12_800 });
    let rig = Rig::new(Character { index, ..Character::default() });
    let table =
        rig.table().with_index_angle_deg(10.0).with_klipper(socket("X").with_index("PC0".parse().unwrap()));
    let mut drive = rig.open_by(&table).unwrap();
    let plan = dose(20.0, 2.0, false);
    drive.check(&plan).unwrap();
    let found = drive.seek(&plan, &mut |_, _| Leave::Go).unwrap();
    let at = found.made - found.beyond.expect("the mark was not found");
    // The mark comes half a way after the start.
    assert!(at.abs_diff(6_400) <= 2, "{found:?}");
    assert_eq!(rig.board.truth().steps[0], found.made as i64);
}

#[test]
fn a_search_that_begins_on_the_mark_leaves_it_and_finds_it_a_turn_later() {
    let pin = pin_of("PC0").unwrap();
    // The mark comes half a way after the start, and is a hundredth of the way wide: 32 steps.
    for into in [0, 1, 16, 31] {
        let index = Some(IndexSensor { pin, socket: 0, steps: 3200 });
        let rig = Rig::new(Character { index, ..Character::default() });
        let pins = socket("X").with_index("PC0".parse().unwrap());
        let mut drive = rig.open_by(&rig.table().with_index_angle_deg(10.0).with_klipper(pins)).unwrap();
        run(&mut drive, &turn(1600 + into)).unwrap();
        let plan = turn(3200);
        drive.check(&plan).unwrap();
        let found = drive.seek(&plan, &mut |_, _| Leave::Go).unwrap();
        let beyond =
            found.beyond.unwrap_or_else(|| panic!("the mark was not found from {into} on: {found:?}"));
        let at = found.made as i64 - beyond as i64 + into;
        assert!((at - 3200).abs() <= 2, "{into}: {found:?}");
    }
}

#[test]
fn a_sensor_that_is_missing_or_never_leaves_its_mark_has_one_message() {
    let rig = Rig::new(Character::default());
    let table = |pin: &str| {
        let pins = socket("X").with_index(pin.parse().unwrap());
        rig.table().with_index_angle_deg(10.0).with_klipper(pins)
    };
    let plan = turn(3200);
    // Nothing is at the pin, which the board pulls up.
    let mut drive = rig.open_by(&table("^!PC0")).unwrap();
    drive.check(&plan).unwrap();
    let found = drive.seek(&plan, &mut |_, _| Leave::Go).unwrap();
    assert_eq!((found.made, found.beyond), (3200, None));
    drop(drive);
    let mut drive = rig.open_by(&table("^PC0")).unwrap();
    drive.check(&plan).unwrap();
    let fault = drive.seek(&plan, &mut |_, _| Leave::Go).unwrap_err();
    assert_eq!((fault.made_least, fault.made_most, fault.lost), (3200, 3200, false));
    assert!(said(&fault).contains("the index sensor answered all the way"), "{}", said(&fault));
}
