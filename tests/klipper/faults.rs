//! Lines that lose bytes, boards that are reset, shut down or out of reach in motion, and computers that are held up.

use std::thread::{scope, sleep};
use std::time::Duration;

use pump_bench::drives::{Disturbance, Drive, DriveFault};

use crate::rig::{Rig, dose, ended, run, said};
use crate::simulated_klipper::Character;

/// Runs a dose of 12 mL and does something to the board on its way. Returns the fault.
fn fault(rig: &Rig, act: impl Fn() + Sync) -> (DriveFault, u64) {
    let plan = dose(12.0, 6.0, true);
    let mut drive = rig.open();
    drive.disturbed();
    drive.recorded();
    let fault = scope(|scope| {
        scope.spawn(|| {
            while rig.board.truth().steps[0] < 1500 && rig.board.truth().shutdown.is_none() {
                sleep(Duration::from_millis(2));
            }
            act();
        });
        run(&mut drive, &plan).unwrap_err()
    });
    (fault, plan.steps().unsigned_abs())
}

#[test]
fn a_line_that_loses_doubles_and_damages_bytes_delays_no_step() {
    for seed in 1..=3 {
        let mut character = Character::default();
        (character.noise.lost, character.noise.doubled, character.noise.damaged) = (5e-4, 5e-4, 5e-4);
        character.noise.seed = seed;
        let rig = Rig::new(character);
        let plan = dose(4.0, 4.0, true);
        let mut drive = rig.open();
        assert_eq!(run(&mut drive, &plan).unwrap(), plan.steps().unsigned_abs());
        let truth = rig.board.truth();
        assert_eq!((truth.steps[0], truth.shutdown), (plan.steps(), None), "seed {seed}");
    }
}

#[test]
fn a_board_that_is_reset_in_motion_leaves_the_bracket_of_what_it_was_sent() {
    let rig = Rig::new(Character::default());
    let (fault, _) = fault(&rig, || rig.board.touch("reset").unwrap());
    let made = rig.board.truth().steps[0];
    assert!((fault.made_least..=fault.made_most).contains(&made) && !fault.lost, "{made}: {fault:?}");
    assert!(said(&fault).contains("the board was reset"), "{}", said(&fault));
    assert!(fault.made_most - fault.made_least < 5000, "{fault:?}");
    // It is configured anew, without current meanwhile.
    let mut drive = rig.open();
    assert_eq!((drive.disturbed(), drive.count()), (Some(Disturbance::Reset), Some(0)));
}

#[test]
fn a_cable_that_is_pulled_for_a_moment_costs_no_count() {
    let rig = Rig::new(Character::default());
    let (fault, all) = fault(&rig, || {
        rig.board.touch("pull").unwrap();
        sleep(Duration::from_millis(1500));
        rig.board.touch("plug").unwrap();
    });
    let made = rig.board.truth().steps[0];
    assert_eq!((fault.made_least, fault.made_most, fault.lost), (made, made, false), "{}", said(&fault));
    assert!(made > 1500 && (made as u64) < all);
    let mut drive = rig.open();
    // The motor was stopped without a ramp.
    assert!(matches!(
        drive.disturbed(),
        Some(Disturbance::Halted { slip_steps: 1.., without_current: false })
    ));
    assert_eq!(drive.count(), Some(made));
    let plan = dose(1.0, 2.0, false);
    run(&mut drive, &plan).unwrap();
    assert_eq!(rig.board.truth().steps[0], made + plan.steps());
}

#[test]
fn a_motor_that_was_stopped_without_a_ramp_has_its_slip_in_the_bounds_at_once() {
    let rig = Rig::new(Character::default());
    let (code, said) = rig.runs(&["home", "--set", "30deg", "--tolerance", "0deg"]);
    assert_eq!(code, Some(0), "{said}");
    let dose = rig.starts(&["20mL", "--rate", "6mL/s", "--confirm-pump"]);
    while rig.board.truth().steps[0] < 2000 {
        sleep(Duration::from_millis(2));
    }
    rig.board.touch("pull").unwrap();
    sleep(Duration::from_millis(1500));
    rig.board.touch("plug").unwrap();
    let (code, said) = ended(dose);
    let made = rig.board.truth().steps[0];
    let state = rig.state().unwrap();
    let part = state.unfinished.unwrap();
    let slip = made - part.made_least;
    assert!(code == Some(1) && said.contains("may have slipped"), "{code:?}: {said}");
    assert!(slip >= 256 && part.made_most == made + slip, "{made} steps, {part:?}: {said}");
    // The next command adds nothing to it.
    let (code, said) = rig.runs(&["accept"]);
    assert!(code == Some(0) && !said.contains("may have slipped"), "{code:?}: {said}");
    assert_eq!(rig.state().unwrap().half_width_rad, state.half_width_rad, "{said}");
}

#[test]
fn a_dose_whose_board_cannot_be_asked_is_accepted_only_if_a_person_says_so() {
    let rig = Rig::new(Character::default());
    let dose = rig.starts(&["20mL", "--rate", "6mL/s", "--confirm-pump"]);
    while rig.board.truth().steps[0] < 2000 {
        sleep(Duration::from_millis(2));
    }
    rig.board.touch("pull").unwrap();
    let (code, said) = ended(dose);
    assert_eq!(code, Some(1), "{said}");
    let part = rig.state().unwrap().unfinished.unwrap();
    assert!(part.made_least < part.made_most, "{part:?}");
    for words in [&["accept"][..], &["1mL", "--unfinished", "accept"]] {
        let (code, refused) = rig.runs(words);
        assert!(code == Some(2) && refused.contains("nothing was accepted"), "{code:?}: {refused}");
        assert_eq!(rig.state().unwrap().unfinished, Some(part), "{refused}");
    }
    let (code, told) = rig.runs(&["accept", "--anyway"]);
    assert!(code == Some(0) && told.contains("the device could not be asked"), "{code:?}: {told}");
    assert_eq!(rig.state().unwrap().unfinished, None, "{told}");
}

#[test]
fn a_board_out_of_reach_leaves_the_bracket_of_what_it_was_sent() {
    let rig = Rig::new(Character::default());
    let (fault, _) = fault(&rig, || rig.board.touch("pull").unwrap());
    let made = rig.board.truth().steps[0];
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {fault:?}");
    assert!(said(&fault).contains("check its cable"), "{}", said(&fault));
}

#[test]
fn a_shutdown_is_told_with_its_reason_and_keeps_the_count() {
    // The board makes fewer steps than it should, falls behind and gives up.
    let rig = Rig::new(Character { most_steps_s: 3_000.0, ..Character::default() });
    let (fault, _) = fault(&rig, || {});
    let made = rig.board.truth().steps[0];
    assert_eq!((fault.made_least, fault.made_most), (made, made), "{}", said(&fault));
    let words = said(&fault);
    assert!(words.contains("the board has shut itself down: Stepper too far in past"), "{words}");
    let mut drive = rig.open();
    assert!(matches!(
        drive.disturbed(),
        Some(Disturbance::Halted { slip_steps: 1.., without_current: true })
    ));
    assert_eq!(drive.count(), Some(made));
    run(&mut drive, &dose(1.0, 1.0, false)).unwrap();
    assert_eq!(rig.board.truth().stray, 0);
}

#[test]
fn a_clock_that_jumps_in_motion_ends_it_with_an_exact_count() {
    let rig = Rig::new(Character::default());
    let (fault, _) = fault(&rig, || rig.board.touch("jump 14400000").unwrap());
    let made = rig.board.truth().steps[0];
    assert_eq!((fault.made_least, fault.made_most), (made, made), "{}", said(&fault));
    assert!(said(&fault).contains("has jumped"), "{}", said(&fault));
}

#[test]
fn a_clock_that_jumps_by_more_than_the_dead_man_time_is_told_as_a_jump() {
    let rig = Rig::new(Character::default());
    let (fault, _) = fault(&rig, || rig.board.touch("jump 72000000").unwrap());
    let made = rig.board.truth().steps[0];
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made}: {}", said(&fault));
    assert!(said(&fault).contains("has jumped"), "{}", said(&fault));
    assert!(!said(&fault).contains("heard nothing of this program"), "{}", said(&fault));
}

#[test]
fn a_board_that_was_reset_or_whose_clock_has_jumped_at_rest_moves_nothing() {
    let rig = Rig::new(Character::default());
    let plan = dose(1.0, 2.0, false);
    let mut drive = rig.open();
    rig.board.touch("jump 7200000").unwrap();
    let words = said(&drive.check(&plan).unwrap_err());
    assert!(words.contains("has jumped"), "{words}");
    // It is met anew, and its clock with it.
    drive.connect().unwrap();
    run(&mut drive, &plan).unwrap();
    rig.board.touch("reset").unwrap();
    let words = said(&drive.check(&plan).unwrap_err());
    assert!(words.contains("was reset"), "{words}");
    assert_eq!(rig.board.truth().steps[0], plan.steps());
    drive.connect().unwrap();
    assert_eq!((drive.disturbed(), drive.count()), (Some(Disturbance::Reset), Some(0)));
}

#[test]
fn a_motor_that_was_let_go_is_told_to_the_next_program() {
    let rig = Rig::new(Character::default());
    let mut drive = rig.open();
    run(&mut drive, &dose(1.0, 2.0, false)).unwrap();
    drive.release().unwrap();
    assert_eq!(drive.disturbed(), Some(Disturbance::Disabled));
    drop(drive);
    let mut drive = rig.open();
    assert_eq!(drive.disturbed(), Some(Disturbance::Disabled));
    drop(drive);
    assert_eq!(rig.open().disturbed(), None);
}
