//! Claims about boards that fail in motion. The steps made are known between bounds that hold.

use std::time::Duration;

use pump_bench::drives::GrblError;
use pump_bench::drives::{Disturbance, Drive, DriveFault};

use crate::rig::{defective, dose, each, fault, grbl_error, open, run, run_until};
use crate::simulated::options::{Defects, Random};

fn why(fault: DriveFault) -> GrblError {
    grbl_error(fault.error)
}

#[test]
fn a_refused_jog_stops_the_dose_at_a_known_step() {
    each([2, 9, 15], |code| {
        let fault = fault(Defects { refuses: Some((5, code)), ..Defects::default() });
        assert_eq!(fault.made_least, fault.made_most);
        assert!(!fault.lost && fault.made_least > 0);
        assert!(matches!(why(fault), GrblError::Refused { code: told, .. } if told == code));
    });
}

#[test]
fn an_alarm_that_stops_at_once_loses_the_rotor_and_one_that_decelerates_does_not() {
    each([(1, true), (2, false), (3, true)], |(code, lost)| {
        let fault = fault(Defects { alarm: Some((700, code)), ..Defects::default() });
        assert_eq!(fault.lost, lost);
        assert!(matches!(why(fault), GrblError::Alarm { code: told } if told == code));
    });
}

#[test]
fn a_reset_in_motion_leaves_bounds_and_is_told() {
    each([1, 500, 1_200], |place| {
        let board = defective(Defects { resets: Some(place), ..Defects::default() });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 2.0, 5.0);
        let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
        let made = board.rest().steps;
        assert!((fault.made_least..=fault.made_most).contains(&made) && !fault.lost, "{made}: {fault:?}");
        assert!(matches!(why(fault), GrblError::Reset));
        assert_eq!(grbl.disturbed(), Some(Disturbance::Reset));
        assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64);
    });
}

#[test]
fn a_pulled_cable_leaves_bounds_that_hold_what_the_board_still_makes() {
    each([1, 400, 900, 1_300], |place| {
        let board = defective(Defects { unplugged: Some(place), ..Defects::default() });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 2.0, 5.0);
        let (result, announced) = run(&mut grbl, &board, &plan);
        let (fault, made) = (result.unwrap_err(), board.rest().steps);
        assert!(
            fault.made_least <= made && made <= fault.made_most && fault.made_most <= announced as i64,
            "{made}: {fault:?}"
        );
        assert!(!fault.lost);
        assert!(matches!(why(fault), GrblError::Gone(_)));
        assert_eq!(grbl.disturbed(), Some(Disturbance::LinkLost));
        let again = run(&mut grbl, &board, &plan).0.unwrap_err();
        assert_eq!((again.made_least, again.made_most), (0, 0));
    });
}

#[test]
fn a_board_that_falls_silent_is_told_to_stop_all_the_same() {
    let board = defective(Defects { silent: Some(800), ..Defects::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 12.0, 2.0);
    let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
    let made = board.rest().steps;
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {fault:?}");
    assert!(matches!(why(fault), GrblError::Quiet { .. }));
    assert_eq!(grbl.disturbed(), Some(Disturbance::LinkLost));
}

#[test]
fn a_board_that_does_not_move_is_stopped_by_the_watchdog() {
    let fault = fault(Defects { stalls: Some(600), ..Defects::default() });
    assert!(fault.made_least >= 600, "{fault:?}");
    assert!(matches!(why(fault), GrblError::Stalled { .. }));
}

#[test]
fn a_count_that_jumps_loses_the_rotor() {
    each([-250, 40_000, 3], |by| {
        let fault = fault(Defects { miscounts: Some((900, by)), ..Defects::default() });
        assert!(fault.lost, "by {by}: {fault:?}");
        assert!(matches!(why(fault), GrblError::Count { .. }));
    });
}

#[test]
fn an_answer_that_never_comes_stops_the_dose() {
    let fault = fault(Defects { seed: 3, late_ok: Duration::from_secs(40), ..Defects::default() });
    assert!(matches!(why(fault), GrblError::NoOk { .. }));
}

/// Several defects strike at once, at places that look random.
#[test]
fn whatever_goes_wrong_what_was_made_lies_within_the_bounds() {
    each(0..12, |seed| {
        let mut random = Random::new(seed + 100);
        let place = 1 + random.below(1_500);
        let mut defects = Defects {
            seed,
            late_ok: Duration::from_millis(random.below(80)),
            lost_cancels: random.below(3) as u32,
            noise: random.below(2) == 0,
            chopped: random.below(2) == 0,
            ..Defects::default()
        };
        match seed % 6 {
            0 => defects.alarm = Some((place, 2)),
            1 => defects.refuses = Some((1 + random.below(10) as u32, 9)),
            2 => defects.resets = Some(place),
            3 => defects.unplugged = Some(place),
            4 => defects.silent = Some(place),
            _ => defects.lost_cancels = 6,
        }
        let board = defective(defects.clone());
        let mut grbl = open(&board);
        let plan = dose(&grbl, 3.0, 5.0);
        let stop_after = if seed % 2 == 0 { u64::MAX } else { 1_700 };
        let (result, announced) = run_until(&mut grbl, &board, &plan, |made, _| made > stop_after);
        let made = board.rest().steps;
        match result {
            Ok(told) => assert_eq!(told as i64, made, "{defects:?}"),
            // A line on its way to a board that was reset may have moved it. The fault then says so.
            Err(fault) if fault.lost => assert!(defects.resets.is_some(), "{fault:?} {defects:?}"),
            Err(fault) => {
                assert!(
                    (fault.made_least..=fault.made_most).contains(&made),
                    "{made} made: {fault:?} {defects:?}"
                );
                assert!(fault.made_most <= announced as i64, "{fault:?}: {announced} announced");
            }
        }
    });
}
