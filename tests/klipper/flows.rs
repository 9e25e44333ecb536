//! Flows over time: with slopes, a step, and a pause in which the motor rests.

use std::time::{Duration, Instant};

use pump_bench::drives::{Drive, Leave};

use crate::flow::Flow;
use crate::rig::Rig;
use crate::simulated_klipper::Character;

/// Times in s, and flows in mL/s.
const ROWS: [(f64, f64); 8] =
    [(0.0, 0.0), (0.5, 2.0), (1.0, 1.5), (1.0, 1.4), (1.3, 0.0), (3.0, 0.0), (3.5, 2.0), (4.0, 0.0)];

#[test]
fn every_step_of_a_flow_is_within_2_us_of_its_time_over_a_pause_too() {
    for sign in [1.0, -1.0] {
        let rig = Rig::new(Character { drift_ppm: 100.0, ..Character::default() });
        let flow = Flow::new(&ROWS, sign);
        let motion = flow.motion();
        let mut drive = rig.open();
        drive.check_flow(&motion).unwrap();
        let made = drive.run_flow(&motion, &mut |_, _| Leave::Go).unwrap();
        assert_eq!(made, motion.steps().unsigned_abs());
        let truth = rig.board.truth();
        assert_eq!((truth.steps[0], truth.stray, truth.shutdown), (motion.steps(), 0, None));
        assert_eq!(drive.count(), Some(motion.steps()));
        let steps = rig.steps_of("X");
        let first = steps[0].0;
        // The begin is that from which the steps are nearest to their times.
        let offs: Vec<f64> = steps
            .iter()
            .zip(motion.each_step())
            .map(|((tick, _), step)| (tick - first) as f64 / 72e6 - step.time_s)
            .collect();
        let most = offs.iter().copied().fold(f64::MIN, f64::max);
        let least = offs.iter().copied().fold(f64::MAX, f64::min);
        assert!(0.5e6 * (most - least) <= 2.0, "{sign}: {} us", 0.5e6 * (most - least));
    }
}

#[test]
fn a_flow_that_is_stopped_comes_to_rest_with_an_exact_count() {
    // In a slope, in the pause, and after it.
    for stop_ms in [800, 2200, 3400] {
        let rig = Rig::new(Character::default());
        let flow = Flow::new(&ROWS, 1.0);
        let motion = flow.motion();
        let mut drive = rig.open();
        drive.check_flow(&motion).unwrap();
        let began = Instant::now();
        let stops =
            |_, _| if began.elapsed() < Duration::from_millis(stop_ms) { Leave::Go } else { Leave::Stop };
        let made = drive.run_flow(&motion, &mut { stops }).unwrap();
        assert!(made > 0 && made < motion.steps().unsigned_abs(), "{stop_ms} ms: {made}");
        let truth = rig.board.truth();
        assert_eq!(
            (truth.steps[0], truth.moving, truth.shutdown),
            (made as i64, false, None),
            "{stop_ms} ms"
        );
        assert_eq!(drive.count(), Some(made as i64));
    }
}
