//! Flows over time.

use pump_bench::drives::{Drive, Leave};

use crate::flow::Flow;
use crate::rig::{Rig, go, worst_of};
use crate::world::TICK_HZ;

/// A flow with slopes, a small step, a pause of 3 s, and a start after it that begins with a step.
const ROWS: [(f64, f64); 9] = [
    (0.0, 0.0),
    (1.0, 2.0),
    (2.0, 1.5),
    (2.0, 1.4),
    (2.5, 0.0),
    (5.5, 0.0),
    (5.5, 0.3),
    (7.0, 2.0),
    (8.0, 0.0),
];

#[test]
fn every_step_of_a_flow_comes_within_a_microsecond_of_its_time() {
    for sign in [1.0, -1.0] {
        let (rig, flow) = (Rig::new(), Flow::new(&ROWS, sign));
        let motion = flow.motion();
        let mut drive = rig.open();
        drive.check_flow(&motion).unwrap();
        assert_eq!(drive.run_flow(&motion, &mut go).unwrap(), motion.steps().unsigned_abs());
        assert_eq!(rig.world.count(), motion.steps());
        assert_eq!(drive.count(), Some(motion.steps()));
        let times: Vec<f64> = motion.each_step().map(|step| f64::from(TICK_HZ) * step.time_s).collect();
        let worst = worst_of(&rig.world.rises(), &times);
        assert!(worst <= 1.0, "{sign}: {worst} us");
    }
}

#[test]
fn a_flow_that_is_stopped_decelerates_and_its_count_is_exact() {
    for stop_ms in [300, 1500, 4000, 6500] {
        let (rig, flow) = (Rig::new(), Flow::new(&ROWS, 1.0));
        let motion = flow.motion();
        let mut drive = rig.open();
        drive.check_flow(&motion).unwrap();
        let begin_us = rig.world.now_us();
        let stops = |now_us: u64| if now_us < begin_us + stop_ms * 1000 { Leave::Go } else { Leave::Stop };
        let made = drive.run_flow(&motion, &mut |_, _| stops(rig.world.now_us())).unwrap();
        assert!(made < motion.steps().unsigned_abs());
        assert_eq!(made as i64, rig.world.count());
        assert!(rig.world.now_us() < begin_us + (stop_ms + 200) * 1000);
    }
}

#[test]
fn a_flow_that_ran_out_of_leave_ends_where_it_came_to_rest() {
    let (rig, flow) = (Rig::new(), Flow::new(&ROWS, 1.0));
    let motion = flow.motion();
    let mut drive = rig.open();
    drive.check_flow(&motion).unwrap();
    let begin_us = rig.world.now_us();
    let fault = drive.run_flow(&motion, &mut |_, _| {
        if rig.world.now_us() < begin_us + 500_000 { Leave::Go } else { Leave::Wait }
    });
    let fault = fault.unwrap_err();
    assert_eq!(
        (fault.made_least, fault.made_most, fault.lost),
        (rig.world.count(), rig.world.count(), false)
    );
    let told = crate::rig::node_error(&fault.error).to_string();
    assert!(told.contains("ran out of steps of the flow over time"), "{told}");
}
