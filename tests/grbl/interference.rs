//! Claims about doses that somebody else stops or moves, and about counts that disagree.

use std::sync::atomic::{AtomicU32, Ordering};

use pump_bench::drives::{Drive, GrblError};

use crate::rig::{defective, dose, each, grbl_error, open, run, run_unwatched};
use crate::simulated::options::Defects;

/// Byte of a jog cancel.
const CANCEL: u8 = 0x85;

#[test]
fn a_hold_or_a_cancel_by_somebody_else_stops_the_dose_at_a_known_step() {
    // A board with the next jog in its buffer obeys it after the stop, and tells no rest: a busy machine may be late.
    let places = [60, 150, 333, 480, 700, 905, 1_111, 1_250];
    let (exact, unnoticed) = (AtomicU32::new(0), AtomicU32::new(0));
    each(places.into_iter().flat_map(|place| [(place, b'!'), (place, CANCEL)]), |pressed| {
        let defects = Defects { pressed: Some(pressed), ..Defects::default() };
        let board = defective(defects);
        let mut grbl = open(&board);
        let plan = dose(&grbl, 3.0, 5.0);
        let result = run(&mut grbl, &board, &plan).0;
        let made = board.rest().steps;
        let fault = match result {
            Ok(told) => {
                assert!(told as i64 == made && made == plan.steps(), "{pressed:?}: {told} told, {made} made");
                unnoticed.fetch_add(1, Ordering::Relaxed);
                return;
            }
            Err(fault) => fault,
        };
        let bounds = fault.made_least == made && made <= fault.made_most && made < plan.steps();
        assert!(bounds, "{pressed:?}: {made} made, {fault:?}");
        // On a busy machine a report may be too late to tell a stop from the end of the jogs.
        assert!(fault.made_most == made || fault.lost, "{pressed:?}: {fault:?}");
        exact.fetch_add(u32::from(fault.made_most == made && !fault.lost), Ordering::Relaxed);
        let why = grbl_error(fault.error);
        assert!(matches!(why, GrblError::StoppedElsewhere { .. }), "{pressed:?}: {why}");
        // The rest can be made.
        let rest = dose(&grbl, 0.5, 5.0);
        assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps() as u64, "{pressed:?}");
        assert_eq!((board.truth().steps, grbl.count()), (made + rest.steps(), Some(made + rest.steps())));
    });
    assert!(exact.into_inner() >= 8 && unnoticed.into_inner() <= 4);
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
