//! Claims about doses that somebody else stops or moves, and about counts that disagree.

use std::time::Duration;

use pump_bench::drives::{Drive, GrblError};

use crate::rig::{defective, dose, each, grbl_error, open, run, run_until, run_unwatched};
use crate::simulated::options::Defects;

/// Byte of a jog cancel.
const CANCEL: u8 = 0x85;

/// Places at which somebody presses, with the byte of a hold button and that of a jog cancel.
fn presses() -> impl Iterator<Item = (u64, u8)> {
    (60..1_300).step_by(31).flat_map(|place| [(place, b'!'), (place, CANCEL)])
}

#[test]
fn a_hold_or_a_cancel_by_somebody_else_stops_the_dose_at_a_known_step() {
    each(presses(), |pressed| {
        let board = defective(Defects { pressed: Some(pressed), ..Defects::default() });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 3.0, 5.0);
        let fault = run(&mut grbl, &board, &plan).0.unwrap_err();
        let made = board.rest().steps;
        assert!(made < plan.steps(), "{pressed:?}: {made} made");
        assert_eq!(
            (fault.made_least, fault.made_most, fault.lost),
            (made, made, false),
            "{pressed:?}: {fault:?}"
        );
        let why = grbl_error(fault.error);
        assert!(matches!(why, GrblError::StoppedElsewhere { .. }), "{pressed:?}: {why}");
        // The rest can be made.
        let rest = dose(&grbl, 0.5, 5.0);
        assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps() as u64, "{pressed:?}");
        assert_eq!((board.truth().steps, grbl.count()), (made + rest.steps(), Some(made + rest.steps())));
    });
}

/// A board that has the next jog in its buffer obeys it after the stop, and tells no rest. A report that comes late may
/// not tell a stop from the end of the jogs.
#[test]
fn bounds_hold_the_truth_if_the_drive_does_not_get_to_run_while_somebody_else_stops_the_dose() {
    let (mut exact, mut unsure) = (0, 0);
    let stalls = [0, 4, 30, 150, 400, 1_500].map(Duration::from_millis);
    let cases = presses().flat_map(|pressed| stalls.into_iter().map(move |stall| (pressed, stall)));
    for (pressed, stall) in cases {
        for which in [0, 1] {
            let board = defective(Defects { pressed: Some(pressed), ..Defects::default() });
            let mut grbl = open(&board);
            let plan = dose(&grbl, 3.0, 5.0);
            let mut is_due = true;
            let result = run_until(&mut grbl, &board, &plan, |_, _| {
                if is_due && board.truth().steps + 60 >= pressed.0 as i64 {
                    is_due = false;
                    board.meddle(|events| events.stalls[which] = stall);
                }
                false
            });
            let made = board.rest().steps;
            match result.0 {
                Ok(told) => {
                    assert_eq!((told as i64, made), (plan.steps(), plan.steps()), "{pressed:?} {stall:?}");
                }
                Err(fault) => {
                    let bounds = fault.made_least == made && made <= fault.made_most && made < plan.steps();
                    assert!(bounds, "{pressed:?} {stall:?}: {made} made, {fault:?}");
                    assert!(fault.made_most == made || fault.lost, "{pressed:?} {stall:?}: {fault:?}");
                    *(if fault.lost { &mut unsure } else { &mut exact }) += 1;
                    let why = grbl_error(fault.error);
                    assert!(
                        matches!(why, GrblError::StoppedElsewhere { .. }),
                        "{pressed:?} {stall:?}: {why}"
                    );
                }
            }
        }
    }
    assert!(exact > 4 * unsure && unsure > 0, "{exact} known exactly, {unsure} not");
}

#[test]
fn bounds_hold_the_truth_whatever_moved_the_motor() {
    let some = Defects::default();
    let cases = [
        ("a damaged jog back", Defects { garbles: Some((6, '0')), ..some.clone() }),
        ("a damaged jog on", Defects { garbles: Some((6, '7')), ..some.clone() }),
        ("a damaged last jog", Defects { garbles: Some((18, '0')), ..some.clone() }),
        ("a foreign jog on", Defects { foreign: Some((700, 8.0)), ..some.clone() }),
        ("a foreign jog back", Defects { foreign: Some((700, -8.0)), ..some.clone() }),
        ("a foreign jog far back", Defects { foreign: Some((100, -30.0)), ..some.clone() }),
        ("twice as far", Defects { stretches: Some(5), ..some.clone() }),
        ("missed steps", Defects { misses: Some((400, 300, 700)), ..some.clone() }),
        ("a few missed steps", Defects { misses: Some((400, 7, 1_000)), ..some.clone() }),
        ("a counter that jumps on", Defects { miscounts: Some((900, 5_000)), ..some.clone() }),
        ("a counter that jumps back", Defects { miscounts: Some((900, -400)), ..some }),
    ];
    each(cases, |(name, defects)| {
        let board = defective(defects);
        let mut grbl = open(&board);
        let plan = dose(&grbl, 3.0, 5.0);
        let result = run_unwatched(&mut grbl, &plan);
        let made = board.rest().steps;
        match result {
            Ok(told) => assert_eq!(told as i64, made, "{name}"),
            Err(fault) => {
                assert!((fault.made_least..=fault.made_most).contains(&made), "{name}: {made}, {fault:?}");
            }
        }
    });
}

#[test]
fn a_count_fault_is_told_by_the_boards_final_count() {
    // The motor goes back by 2,000 steps, which the board counts.
    let board = defective(Defects { foreign: Some((700, -8.0)), ..Defects::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 3.0, 5.0);
    let fault = run_unwatched(&mut grbl, &plan).unwrap_err();
    let made = board.rest().steps;
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {fault:?}");
    assert!(fault.lost && fault.made_least < fault.made_most, "{fault:?}");
    assert!(matches!(grbl_error(fault.error), GrblError::Count { .. }));
}
