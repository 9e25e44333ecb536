//! Several motors at one board, each with a drive of its own in a thread of its own, and pumps that take turns at a
//! board.

use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use pump_bench::drives::{Disturbance, Drive, DriveFault, Klipper, Leave, Opening};
use pump_bench::pump_file::DriveTable;

use crate::rig::{Rig, dose, motor, run, said, with_driver};
use crate::simulated_klipper::Character;

/// Two sockets of a board, with their stepper drivers at one line.
const SOCKETS: [(&str, u8); 2] = [("X", 0), ("Y", 2)];

fn table(rig: &Rig, number: usize) -> DriveTable {
    let (socket, address) = SOCKETS[number];
    rig.table().with_klipper(with_driver(socket, address))
}

/// Returns the terms of a pump at a socket. Beside it is the pump at the other socket, unless it is alone.
fn opening(rig: &Rig, number: usize, is_alone: bool) -> Opening {
    let folder = rig.folder.path().join("state");
    let id = |number: usize| format!("pump{number}");
    let record = folder.join(id(number)).join("klipper/board-settings.json");
    std::fs::create_dir_all(record.parent().unwrap()).unwrap();
    let other = 1 - number;
    Opening {
        pump: Some(id(number)),
        settings_record: Some(record),
        boards: Some(folder.join("boards")),
        beside: if is_alone { Vec::new() } else { vec![(id(other), table(rig, other))] },
        ..Opening::default()
    }
}

fn open(rig: &Rig, number: usize, is_alone: bool) -> Klipper {
    Klipper::open(&table(rig, number), &motor(), &opening(rig, number, is_alone)).unwrap()
}

/// Doses with both motors at once, and does something to the board once the first has made 1500 steps. Returns what
/// became of each.
fn doses(rig: &Rig, act: impl Fn() + Sync) -> [Result<u64, DriveFault>; 2] {
    let plans = [dose(9.0, 4.0, true), dose(9.0, 3.5, false)];
    let mut drives = [0, 1].map(|number| open(rig, number, false));
    drives.iter_mut().for_each(|drive| _ = drive.disturbed());
    let before = rig.board.truth().steps[0];
    let [one, other] = &mut drives;
    scope(|scope| {
        scope.spawn(|| {
            let until = Instant::now() + Duration::from_secs(20);
            while rig.board.truth().steps[0] - before < 1500 && Instant::now() < until {
                sleep(Duration::from_millis(2));
            }
            act();
        });
        let one = scope.spawn(|| run(one, &plans[0]));
        let other = scope.spawn(|| run(other, &plans[1]));
        [one.join().unwrap(), other.join().unwrap()]
    })
}

#[test]
fn motors_at_one_board_dose_at_once_over_a_line_that_loses_bytes_and_their_drivers_are_asked() {
    let mut character = Character::default();
    (character.noise.lost, character.noise.damaged, character.noise.seed) = (3e-4, 3e-4, 5);
    let rig = Rig::new(character);
    let made = doses(&rig, || ()).map(|made| i64::try_from(made.unwrap()).unwrap());
    let truth = rig.board.truth();
    assert_eq!((truth.steps[..2].to_vec(), truth.stray, truth.shutdown), (made.to_vec(), 0, None));
    // Some 2.5 s of motion, 4 inquiries a second of 2 questions each for both, and those at rest.
    assert!(truth.asked > 40, "{}", truth.asked);
}

#[test]
fn a_fault_of_one_motors_driver_leaves_the_other_alone() {
    let rig = Rig::new(Character::default());
    let [one, other] = doses(&rig, || rig.board.touch("fault Y ot").unwrap());
    let fault = other.unwrap_err();
    assert!(fault.lost && said(&fault).contains("it is too hot"), "{}", said(&fault));
    assert_eq!(i64::try_from(one.unwrap()).unwrap(), rig.board.truth().steps[0]);
}

#[test]
fn a_reset_a_shutdown_and_a_pulled_cable_end_all_motions_of_the_board_within_their_bounds() {
    for (act, words) in [("reset", "was reset"), ("jump 7200000", "clock"), ("pull", "")] {
        let rig = Rig::new(Character::default());
        let ended = doses(&rig, || {
            rig.board.touch(act).unwrap();
            if act == "pull" {
                sleep(Duration::from_millis(1500));
                rig.board.touch("plug").unwrap();
            }
        });
        let made = rig.board.truth().steps;
        for (fault, made) in ended.into_iter().zip(made) {
            let fault = fault.unwrap_err();
            assert!((fault.made_least..=fault.made_most).contains(&made), "{act}: {made} {fault:?}");
            let text = said(&fault);
            assert!(text.contains(words), "{act}: {text}");
            if act == "pull" {
                assert_eq!((fault.made_least, fault.made_most), (made, made), "{text}");
            }
        }
        // Both are met again, and told what may have happened to their rotors.
        for number in [0, 1] {
            let mut drive = open(&rig, number, true);
            let disturbed = drive.disturbed();
            assert!(disturbed.is_some(), "{act} {number}");
            run(&mut drive, &dose(0.5, 2.0, false)).unwrap();
        }
        assert_eq!(rig.board.truth().stray, 0, "{act}");
    }
}

#[test]
fn pumps_that_take_turns_at_a_board_find_it_as_they_left_it() {
    let rig = Rig::new(Character::default());
    let plan = dose(0.5, 2.0, false);
    let mut counts = [0, 0];
    for round in 0..3 {
        for number in [0, 1] {
            let mut drive = open(&rig, number, true);
            // The second pump changes the configuration once, which the first hears of once.
            let is_new = round == 0 || round == 1 && number == 0;
            // The second pump adds a motor to a board that is configured.
            let event = if round + number == 0 { Disturbance::Reset } else { Disturbance::Reconfigured };
            let reset = is_new.then_some(event);
            assert_eq!(drive.disturbed(), reset, "round {round}, pump {number}");
            counts[number] = if is_new { 0 } else { counts[number] };
            assert_eq!(drive.count(), Some(counts[number]), "round {round}, pump {number}");
            drive.check(&plan).unwrap();
            drive.run(&plan, &mut |_, _| Leave::Go).unwrap();
            counts[number] += plan.steps();
        }
    }
    assert_eq!(rig.board.truth().stray, 0);
}

#[test]
fn a_shutdown_that_another_pump_has_ended_is_told_to_each_whose_motor_lost_its_current() {
    // A board that is too slow for the plan falls behind and shuts down.
    let rig = Rig::new(Character { most_steps_s: 3000.0, ..Character::default() });
    for number in [0, 1, 0] {
        run(&mut open(&rig, number, true), &dose(0.2, 1.0, false)).unwrap();
    }
    let mut first = open(&rig, 0, true);
    assert_eq!(first.disturbed(), None);
    run(&mut first, &dose(12.0, 6.0, false)).unwrap_err();
    // The first pump ends the shutdown when it is met again, or has ended it.
    first.connect().unwrap();
    assert_ne!(first.disturbed(), None);
    run(&mut first, &dose(0.2, 1.0, false)).unwrap();
    drop(first);
    assert_eq!(rig.board.truth().shutdown, None);
    let mut second = open(&rig, 1, true);
    assert_eq!(second.disturbed(), Some(Disturbance::Disabled));
    run(&mut second, &dose(0.2, 1.0, false)).unwrap();
    drop(second);
    assert_eq!(open(&rig, 1, true).disturbed(), None, "it is told once");
    assert_eq!(rig.board.truth().stray, 0);
}
