//! Stepper drivers that lose their motor's current in the middle of a dose, while the board goes on counting.

use std::process::Child;
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use pump_bench::drives::{Disturbance, Drive};

use crate::rig::{Rig, command, dose, ended, run, said, with_driver};
use crate::simulated_klipper::Character;

/// Waits until the motor has made so many steps, and returns how many it has made then.
fn until_made(rig: &Rig, steps: i64) -> i64 {
    let until = Instant::now() + Duration::from_secs(20);
    while rig.board.truth().steps[0] < steps && Instant::now() < until {
        sleep(Duration::from_millis(2));
    }
    rig.board.truth().steps[0]
}

/// Starts a dose of 20 mL at 4 mL/s, and waits until it is under way.
fn begun(rig: &Rig) -> Child {
    let (code, said) = rig.runs(&["home", "--set", "30deg", "--tolerance", "0deg"]);
    assert_eq!(code, Some(0), "{said}");
    let dose = rig.starts(&["20mL", "--rate", "4mL/s", "--confirm-pump"]);
    assert!(until_made(rig, 3000) >= 3000);
    dose
}

#[test]
fn a_driver_that_switches_its_motor_off_in_motion_ends_it_with_the_steps_that_are_sure() {
    for (fault, words) in [("ot", "it is too hot"), ("s2ga", "coil A is shorted to ground")] {
        let rig = Rig::of(Character::default(), with_driver("X", 0));
        let plan = dose(20.0, 5.0, true);
        let mut drive = rig.open();
        drive.disturbed();
        let (fault, at) = scope(|scope| {
            let hand = scope.spawn(|| {
                let at = until_made(&rig, 6000);
                rig.board.touch(&format!("fault X {fault}")).unwrap();
                at
            });
            (run(&mut drive, &plan).unwrap_err(), hand.join().unwrap())
        });
        let made = rig.board.truth().steps[0];
        assert!(fault.lost && said(&fault).contains(words), "{}", said(&fault));
        assert!(fault.made_least > 0 && fault.made_least <= at, "{at}: {fault:?}");
        assert_eq!(fault.made_most, made, "{fault:?}");
        // The driver is asked some times a second, and the motor comes to rest by its ramp.
        assert!(made < at + 8000, "{at}, {made}");
    }
}

#[test]
fn a_driver_without_fault_is_asked_through_a_whole_dose_and_no_step_is_late() {
    let rig = Rig::of(Character::default(), with_driver("X", 0));
    let plan = dose(10.0, 5.0, true);
    let mut drive = rig.open();
    let before = rig.board.truth().asked;
    assert_eq!(run(&mut drive, &plan).unwrap(), plan.steps().unsigned_abs());
    let truth = rig.board.truth();
    assert_eq!((truth.steps[0], truth.shutdown, truth.stray), (plan.steps(), None, 0));
    // Two questions each 250 ms of some 2 s, and as many at the begin and the end.
    assert!(truth.asked - before >= 12, "{} questions", truth.asked - before);
    rig.board.touch("fault X otpw").unwrap();
    run(&mut drive, &dose(1.0, 5.0, true)).unwrap();
    assert!(drive.notes().iter().any(|note| note.to_string().contains("it is hot")));
}

#[test]
fn a_dose_whose_driver_fails_is_no_full_dose_and_its_bounds_are_on_record() {
    let rig = Rig::of(Character::default(), with_driver("X", 0));
    let dose = begun(&rig);
    rig.board.touch("fault X ot").unwrap();
    let (code, said) = ended(dose);
    assert!(code != Some(0) && said.contains("too hot"), "{code:?}: {said}");
    let state = rig.state().unwrap();
    let part = state.unfinished.unwrap();
    assert_eq!(part.made_most, rig.board.truth().steps[0], "{said}");
    assert!(part.made_least < part.made_most - 200 && part.made_most < part.intent.steps, "{said}");
    let (code, said) = rig.runs(&["resume"]);
    assert!(code != Some(0) && said.contains("too hot"), "the fault is still there: {said}");
    assert_eq!(rig.board.truth().steps[0], part.made_most);
    rig.board.touch("mend X ot").unwrap();
    let (code, said) = rig.runs(&["home", "--unfinished", "--set", "10deg", "--tolerance", "1deg"]);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = rig.runs(&["resume"]);
    assert!(code == Some(0) && said.contains("were delivered before"), "{code:?}: {said}");
}

#[test]
fn a_driver_that_failed_behind_a_killed_program_leaves_all_its_steps_unsure() {
    for fault in ["ot", "s2vsb"] {
        let rig = Rig::of(Character::default(), with_driver("X", 0));
        let mut dose = begun(&rig);
        dose.kill().unwrap();
        ended(dose);
        rig.comes_to_rest();
        let made = rig.board.truth().steps[0];
        // A fault that has passed is told all the same.
        rig.board.touch(&format!("fault X {fault}")).unwrap();
        rig.board.touch(&format!("mend X {fault}")).unwrap();
        let (code, said) = rig.runs(&["accept"]);
        assert!(code == Some(0) && said.contains("nobody knows which steps the motor has made"), "{said}");
        assert!(said.contains("between 0.0000 and"), "{said}");
        let state = rig.state().unwrap();
        assert!(state.unfinished.is_none() && state.half_width_rad > 1.0, "{made} steps: {state:?}");
    }
}

#[test]
fn a_driver_that_has_failed_at_rest_moves_nothing_until_it_is_mended() {
    let rig = Rig::of(Character::default(), with_driver("X", 0));
    let plan = dose(1.0, 2.0, false);
    let mut drive = rig.open();
    run(&mut drive, &plan).unwrap();
    rig.board.touch("fault X s2gb").unwrap();
    let words = said(&drive.check(&plan).unwrap_err());
    assert!(words.contains("coil B is shorted to ground"), "{words}");
    assert_eq!(drive.disturbed(), Some(Disturbance::CurrentLost));
    drive.connect().unwrap_err();
    rig.board.touch("mend X s2gb").unwrap();
    drive.connect().unwrap();
    assert_eq!(drive.count(), Some(plan.steps()));
    run(&mut drive, &plan).unwrap();
}

#[test]
fn a_supply_that_is_cut_at_rest_is_told_by_the_driver_and_the_motor_is_set_anew() {
    let rig = Rig::of(Character::default(), with_driver("X", 0));
    let mut drive = rig.open();
    run(&mut drive, &dose(1.0, 2.0, false)).unwrap();
    rig.board.touch("cut").unwrap();
    let words = said(&drive.check(&dose(1.0, 2.0, false)).unwrap_err());
    assert!(words.contains("no TMC2209 answers at address 0"), "{words}");
    rig.board.touch("restore").unwrap();
    drop(drive);
    let mut drive = rig.open();
    assert_eq!(drive.disturbed(), Some(Disturbance::CurrentLost));
    run(&mut drive, &dose(1.0, 2.0, false)).unwrap();
    assert_eq!(rig.board.truth().stray, 0);
}

#[test]
fn an_enable_pin_that_does_not_switch_the_driver_is_refused_before_anything_moves() {
    let (off, on) = ("that its enable input is off", "that its enable input is on while");
    // A pin that leads nowhere, that of another socket, and the right one with the wrong level, which holds the chip on
    // whatever pin is named next, until the right one takes its current away.
    for (first, next) in [(("!PA4", off), ("!PB11", off)), (("PB14", on), ("!PC3", on))] {
        let with = |enable: &str| {
            let mut pins = with_driver("X", 0);
            pins.enable = Some(enable.parse().unwrap());
            pins
        };
        let rig = Rig::of(Character::default(), with_driver("X", 0));
        let runs = |enable: &str, words: &[&str]| {
            let pump = rig.pump_at("red", with(enable));
            ended(command(rig.folder.path(), &pump, rig.board.path(), words).spawn().unwrap())
        };
        for (enable, words) in [first, next, next] {
            let (code, said) = runs(enable, &["1mL", "--confirm-pump"]);
            assert!(
                code == Some(2) && said.contains(words) && !said.contains(" delivered"),
                "{enable}: {said}"
            );
            let (code, said) = runs(enable, &["release"]);
            assert!(code != Some(0) && !said.contains("without current"), "{enable}: {said}");
            assert_eq!((rig.board.truth().steps, rig.board.truth().stray), ([0; 4], 0));
        }
        let (code, said) = runs("!PB14", &["1mL", "--confirm-pump"]);
        assert!(code == Some(0) && said.contains(" delivered"), "{said}");
        assert_eq!(rig.board.truth().stray, 0);
    }
}
