//! The command `dose` with a pump file whose driver is `klipper`.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::rig::{Rig, command, ended, socket};
use crate::simulated_klipper::Character;

#[test]
fn a_dose_is_poured_stopped_and_resumed() {
    let rig = Rig::new(Character::default());
    let (code, said) = rig.runs(&["2mL", "--confirm-pump"]);
    assert_eq!(code, Some(0), "{said}");
    let first = rig.board.truth().steps[0];
    assert!(said.contains("2.0 mL ±") && first > 500, "{first} steps: {said}");
    let dose = rig.starts(&["20mL", "--rate", "4mL/s"]);
    let until = Instant::now() + Duration::from_secs(20);
    while rig.board.truth().steps[0] < first + 1500 && Instant::now() < until {
        sleep(Duration::from_millis(5));
    }
    kill_process(Pid::from_child(&dose), Signal::INT).unwrap();
    let (code, said) = ended(dose);
    assert!(code != Some(0) && said.contains("stopped"), "{code:?}: {said}");
    assert_eq!((rig.board.truth().moving, rig.board.truth().shutdown), (false, None));
    let (code, said) = rig.runs(&["resume"]);
    assert_eq!(code, Some(0), "{said}");
    let steps = rig.board.truth().steps[0] - first;
    assert!(said.contains("of the 20 mL") || said.contains("delivered"), "{said}");
    let (code, said) = rig.runs(&["-2mL", "--smooth", "--start-angle", "0deg"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(rig.board.truth().steps[0] < first + steps && rig.board.truth().stray == 0);
}

#[test]
fn a_program_that_stands_still_has_its_motor_stopped_and_knows_each_step() {
    let rig = Rig::new(Character::default());
    let dose = rig.starts(&["5mL", "--rate", "1.5mL/s", "--confirm-pump"]);
    let until = Instant::now() + Duration::from_secs(20);
    while rig.board.truth().steps[0] < 900 && Instant::now() < until {
        sleep(Duration::from_millis(5));
    }
    kill_process(Pid::from_child(&dose), Signal::STOP).unwrap();
    rig.comes_to_rest();
    let made = rig.board.truth().steps[0];
    // Longer than the dead-man time, and than the board is waited for in motion.
    sleep(Duration::from_millis(1500));
    assert_eq!(rig.board.truth().steps[0], made, "it moves without its program");
    kill_process(Pid::from_child(&dose), Signal::CONT).unwrap();
    let (code, said) = ended(dose);
    assert!(code != Some(0), "{code:?}: {said}");
    let truth = rig.board.truth();
    assert_eq!((truth.moving, truth.shutdown), (false, None), "{said}");
    let cut = rig.state().unwrap().unfinished.expect("the dose is unfinished");
    assert_eq!([cut.made_least, cut.made_most], [made, made], "{said}");
    let (code, resumed) = rig.runs(&["resume"]);
    assert_eq!(code, Some(0), "{said}; {resumed}");
    assert_eq!(rig.board.truth().steps[0], cut.intent.steps, "{resumed}");
}

#[test]
fn a_pump_file_that_turns_the_motor_otherwise_is_refused_until_a_person_confirms_it() {
    let rig = Rig::new(Character::default());
    let path = rig.pump();
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(rig.runs(&["2mL", "--confirm-pump"]).0, Some(0));
    // The angle was just said, so that no motion on record tells the old way.
    assert_eq!(rig.runs(&["home", "--set", "0deg"]).0, Some(0));
    let steps = rig.board.truth().steps;
    let types =
        |words: &[&str]| ended(command(rig.folder.path(), &path, rig.board.path(), words).spawn().unwrap());
    for (from, to, now) in [
        ("dir = \"PB12\"", "dir = \"!PB12\"", "pins PB13 (step), !PB12 (direction) and !PB14 (enable)"),
        ("step = \"PB13\"", "step = \"PB10\"", "pins PB10 (step), PB12 (direction)"),
        ("invert = false", "invert = true", "and !PB14 (enable), inverted"),
        ("steps_per_rev = 12800", "steps_per_rev = 6400", "drives it with 6400 steps per revolution"),
    ] {
        let changed = text.replace(from, to);
        assert_ne!(changed, text, "{from} stands in the file");
        fs::write(&path, changed).unwrap();
        let (code, said) = types(&["1mL"]);
        assert_eq!(code, Some(2), "{said}");
        let then =
            "it was driven with 12800 steps per revolution, gear 1, pins PB13 (step), PB12 (direction) and";
        assert!(said.contains(now) && said.contains(then) && said.contains("--confirm-pump"), "{said}");
        assert_eq!(rig.board.truth().steps, steps, "{said}");
    }
    fs::write(&path, text.replace("dir = \"PB12\"", "dir = \"!PB12\"")).unwrap();
    let (code, said) = types(&["1mL", "--confirm-pump"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(rig.board.truth().steps[0] < steps[0], "it turns the other way now");
    assert_eq!(types(&["1mL"]).0, Some(0), "it is asked once");
}

#[test]
fn each_bad_input_is_one_message_and_nothing_moves() {
    let rig = Rig::new(Character::default());
    let (code, said) = rig.runs(&["2mL", "--confirm-pump", "--configure"]);
    assert!(code == Some(2) && said.contains("a Klipper board keeps none"), "{code:?}: {said}");
    let path = rig.pump();
    let text = fs::read_to_string(&path).unwrap();
    for (from, to, words) in [
        ("step = \"PB13\"", "step = \"PB 13\"", "`PB 13` is no pin of a board"),
        ("step = \"PB13\"", "step = \"^PB13\"", "without `^` and `~`, which are for inputs"),
        ("step = \"PB13\"", "step = \"PB12\"", "a pin that no other key of the table names"),
        ("step = \"PB13\"", "stepp = \"PB13\"", "unknown field `stepp`"),
        ("driver = \"klipper\"", "driver = \"node\"", "beside driver = \"klipper\" only"),
    ] {
        let changed = text.replace(from, to);
        assert_ne!(changed, text, "{from} stands in the file");
        fs::write(rig.folder.path().join("bad.toml"), changed).unwrap();
        let bad = rig.folder.path().join("bad.toml");
        let command = command(rig.folder.path(), &bad, rig.board.path(), &["2mL", "--confirm-pump"]).spawn();
        let (code, said) = ended(command.unwrap());
        assert!(code != Some(0) && said.contains(words), "{code:?}: {said}");
        assert_eq!(said.matches("error:").count(), 1, "{said}");
    }
    assert_eq!((rig.board.truth().steps, rig.board.truth().configured), ([0; 4], false));
}

#[test]
fn a_shutdown_in_motion_is_one_disturbance_and_on_record_with_its_fault() {
    // 6 mL/s is above the start-stop speed, and 1 mL/s below.
    for (volume, rate, slips) in [("20mL", "6mL/s", true), ("5mL", "1mL/s", false)] {
        let rig = Rig::new(Character::default());
        let dose = rig.starts(&[volume, "--rate", rate, "--confirm-pump", "--start-angle", "0deg"]);
        let until = Instant::now() + Duration::from_secs(20);
        while rig.board.truth().steps[0] < 900 && Instant::now() < until {
            sleep(Duration::from_millis(5));
        }
        rig.board.touch("shutdown").unwrap();
        let (code, said) = ended(dose);
        assert!(code != Some(0) && said.contains("has shut itself down"), "{code:?}: {said}");
        let cut = rig.state().unwrap();
        let left = cut.unfinished.expect("the dose is unfinished");
        let fall_rad = 2.0 * std::f64::consts::TAU / 200.0;
        assert!(cut.half_width_rad >= fall_rad && cut.half_width_rad < 0.5, "{}", cut.half_width_rad);
        assert_eq!((cut.disturbances, cut.released, cut.lost_by), (1, true, None), "{said}");
        assert_eq!(left.made_least < left.made_most, slips, "{said}");
        let made = rig.board.truth().steps[0];
        assert!((left.made_least..=left.made_most).contains(&made), "{made}: {said}");
        let (code, resumed) = rig.runs(&["resume"]);
        assert_eq!(code, Some(0), "{said}; {resumed}");
        let whole = rig.state().unwrap();
        assert_eq!((whole.disturbances, whole.released, whole.lost_by), (1, false, None), "{resumed}");
        assert!((whole.half_width_rad - cut.half_width_rad).abs() < 1e-9, "{resumed}");
        assert!(!resumed.contains("angle is unknown"), "{resumed}");
    }
}

#[test]
fn a_reset_in_motion_is_one_disturbance_and_on_record_with_its_fault() {
    let rig = Rig::new(Character::default());
    let blue = rig.pump_at("blue", socket("Y"));
    let runs_blue =
        |words: &[&str]| ended(command(rig.folder.path(), &blue, rig.board.path(), words).spawn().unwrap());
    assert_eq!(rig.runs(&["0.1mL", "--confirm-pump"]).0, Some(0));
    let (code, said) = runs_blue(&["0.1mL", "--confirm-pump", "--start-angle", "0deg"]);
    assert_eq!(code, Some(0), "{said}");
    let unseen = "may have moved unseen once";
    assert!(!runs_blue(&["status"]).1.contains(unseen));
    let dose = rig.starts(&["5mL", "--rate", "1mL/s", "--confirm-pump", "--start-angle", "0deg"]);
    let until = Instant::now() + Duration::from_secs(20);
    while rig.board.truth().steps[0] < 900 && Instant::now() < until {
        sleep(Duration::from_millis(5));
    }
    rig.board.touch("reset").unwrap();
    let (code, said) = ended(dose);
    assert!(code != Some(0) && said.contains("the board was reset"), "{code:?}: {said}");
    // The reset has taken the current of the other pump's motor too.
    assert!(runs_blue(&["status"]).1.contains(unseen));
    let cut = rig.state().unwrap();
    let bracket = cut.unfinished.expect("the dose is unfinished");
    let steps_rad = 0.5 * (bracket.made_most - bracket.made_least) as f64 * std::f64::consts::TAU / 12_800.0;
    let fall_rad = 2.0 * std::f64::consts::TAU / 200.0;
    assert!(cut.half_width_rad >= steps_rad + fall_rad - 1e-9, "{} {steps_rad}", cut.half_width_rad);
    assert_eq!((cut.disturbances, cut.released, cut.count), (1, true, None), "{said}");
    let (code, accepted) = rig.runs(&["accept"]);
    assert_eq!(code, Some(0), "{said}; {accepted}");
    let met = rig.state().unwrap();
    assert_eq!((met.disturbances, met.half_width_rad), (1, cut.half_width_rad), "{accepted}");
    let (code, dosed) = rig.runs(&["0.5mL"]);
    assert_eq!(code, Some(0), "{accepted}; {dosed}");
    assert_eq!(rig.state().unwrap().disturbances, 1, "{dosed}");
}
