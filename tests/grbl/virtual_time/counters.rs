//! Claims about counters that jump.

use std::time::Duration;

use pump_bench::drives::{Drive, DriveFault, GrblError, Leave};

use crate::rig::{dose, grbl_error, open, start};
use crate::simulated::options::{Defects, Options, Sensor};

/// Runs a dose on a board whose counter jumps by so many steps at a place. Returns the result, the steps of the
/// dose and the steps made.
fn dose_with_jump(volume_ml: f64, place: u64, by: i64) -> (Result<u64, DriveFault>, i64, i64) {
    let defects = Defects { miscounts: Some((place, by)), ..Defects::default() };
    let board = start(Options { defects, ..Options::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, volume_ml, 5.0);
    let result = grbl.run(&plan, &mut |_, _| Leave::Go);
    let made = board.truth().steps;
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

/// The counter jumps just before a jog is sent. The motor turns back to where the jog leads by the counter, and the
/// drive does not get to run meanwhile.
#[test]
fn bounds_hold_the_truth_although_the_drive_does_not_get_to_run_after_a_jump() {
    let mut turned_back = 0;
    for place in (800..1_200).step_by(20) {
        let defects = Defects { miscounts: Some((place, 5_000)), ..Defects::default() };
        let board = start(Options { defects, ..Options::default() });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 6.0, 5.0);
        let mut stalls = [50, 1_500].map(Duration::from_millis);
        let mut sent = 0;
        let mut gate = |_: u64, last: u64| {
            if last > sent && board.truth().steps + 130 >= place as i64 {
                board.meddle(|events| events.stalls = std::mem::take(&mut stalls));
            }
            sent = last;
            Leave::Go
        };
        let fault = grbl.run(&plan, &mut gate).expect_err(&format!("at {place}"));
        let made = board.truth().steps;
        let within = (fault.made_least..=fault.made_most).contains(&made);
        assert!(fault.lost && within, "at {place}: {made} made, {fault:?}");
        turned_back += u32::from(made < 0);
    }
    assert!(turned_back > 0);
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

/// Has the counter jump while the gate is first asked, and the board report it at once. The second look comes before
/// the motor moves.
#[test]
fn a_jump_before_the_first_line_is_looked_into_before_anything_moves() {
    for seeks in [false, true] {
        let sensor = Some(Sensor { at: 4_000, width: 60, every: 12_800 });
        let board = start(Options { sensor, ..Options::default() });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 6.0, 4.0);
        let mut asked = 0;
        let mut gate = |_: u64, _: u64| {
            asked += 1;
            if asked == 1 {
                board.meddle(|events| (events.astray_mm, events.pressed) = (40.0, Some(b'?')));
            }
            Leave::Go
        };
        let fault = if seeks {
            grbl.seek(&plan, &mut gate).map(drop).unwrap_err()
        } else {
            grbl.run(&plan, &mut gate).map(drop).unwrap_err()
        };
        assert!(matches!(grbl_error(fault.error), GrblError::Count { .. }));
        assert_eq!(board.truth().steps, 0, "seeks: {seeks}");
    }
}
