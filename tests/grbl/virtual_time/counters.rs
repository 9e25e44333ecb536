//! Claims about counters that jump.

use pump_bench::drives::{Drive, DriveFault, Leave};

use super::board::open;
use crate::rig::dose;
use crate::simulated::options::{Defects, Options};

/// Runs a dose on a board whose counter jumps by so many steps at a place. Returns the result, the steps of the
/// dose and the steps made.
fn dose_with_jump(volume_ml: f64, place: u64, by: i64) -> (Result<u64, DriveFault>, i64, i64) {
    let defects = Defects { miscounts: Some((place, by)), ..Defects::default() };
    let (mut grbl, truth) = open(&Options { defects, ..Options::default() });
    let plan = dose(&grbl, volume_ml, 5.0);
    let result = grbl.run(&plan, &mut |_, _| Leave::Go);
    let made = truth.lock().unwrap().steps;
    (result, plan.steps(), made)
}

#[test]
fn a_jump_after_the_last_jog_was_sent_is_noticed_and_the_bounds_hold_the_truth() {
    for by in [3, 40, -3, -40, -200, -600] {
        // Half a second of steps is sent ahead, some 1,500.
        for place in [2_200, 2_600, 3_000, 3_300] {
            let (result, steps, made) = dose_with_jump(6.0, place, by);
            assert!(place < steps as u64 && steps < 2_200 + 1_500, "{steps}");
            let fault = result.expect_err(&format!("by {by} at {place}"));
            assert!(fault.lost, "by {by} at {place}: {fault:?}");
            assert!(
                (fault.made_least..=fault.made_most).contains(&made),
                "by {by} at {place}: {made} made, {fault:?}"
            );
        }
    }
}

#[test]
fn a_jump_beyond_what_was_sent_or_back_behind_the_last_report_is_noticed_wherever_it_comes() {
    for by in [1_800, 5_000, -400] {
        for place in [500, 1_000, 1_500, 2_000] {
            let (result, _, made) = dose_with_jump(6.0, place, by);
            let fault = result.expect_err(&format!("by {by} at {place}"));
            assert!(fault.lost, "by {by} at {place}: {fault:?}");
            assert!(
                (fault.made_least..=fault.made_most).contains(&made),
                "by {by} at {place}: {made} made, {fault:?}"
            );
        }
    }
}

/// The reports are those of a motor whose feed is overridden for a moment, and the next jogs end where the counter
/// says. DESIGN.md has this limit.
#[test]
fn a_small_jump_before_the_next_jogs_cannot_be_told_from_a_motion() {
    for by in [40, -40] {
        let (result, steps, made) = dose_with_jump(6.0, 1_000, by);
        assert_eq!((result.unwrap() as i64, made), (steps, steps - by), "by {by}");
    }
}
