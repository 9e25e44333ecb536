//! Claims about values that nobody has confirmed: a real motor does not move by them.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};

use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::{Bench, DoseError, DoseRequest, PumpFile, Rehearsal, built_in};
use pump_ctl::plan::{Cruise, Phase};

use crate::rig::plug;
use crate::simulated::Simulated;
use crate::simulated::options::Options;

/// Runs the command on a board that a person names beside a pump.
fn types(folder: &Path, board: &Simulated, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    command.args(words).args(["--driver", "grbl", "--port"]).arg(board.path());
    command.env("DOSE_STATE_DIR", folder.join("state")).env("XDG_CONFIG_HOME", folder);
    command.env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG").output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Makes a bench of the built-in pump with these changes, on a board.
fn bench(folder: &Path, board: &Simulated, change: impl FnOnce(&mut PumpFile)) -> Bench {
    let mut file = built_in("three-roller").unwrap();
    change(&mut file);
    Bench::new(file, Some(DriverName::Grbl), folder).unwrap().at_port(Some(board.path().to_owned()))
}

fn dose(bench: &Bench) -> Result<(), DoseError> {
    let mut session = bench.session()?;
    let prepared = session.prepare(DoseRequest::dose(0.2))?;
    session.run(&prepared, |_| ControlFlow::Continue(())).map(drop)
}

#[test]
fn a_built_in_pump_moves_no_motor_until_somebody_has_confirmed_it_once() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    for words in [&["0.2mL"][..], &["prime", "0.2mL"], &["0.2mL", "--repeat", "2", "--every", "1s"]] {
        let refused = types(folder.path(), &board, words);
        assert_eq!(refused.status.code(), Some(2), "{words:?}: {refused:?}");
        let message = said(&refused);
        for part in ["12800 steps per revolution", "gear 1", "axis X counts up", "3 rollers and 21.32 mL"] {
            assert!(message.contains(part), "{words:?}: {part}: {message}");
        }
        assert!(message.contains("--confirm-pump") && message.lines().count() == 1, "{message}");
    }
    assert_eq!(board.rest().steps, 0);
    let rehearsed = types(folder.path(), &board, &["0.2mL", "--dry-run"]);
    assert_eq!(rehearsed.status.code(), Some(0), "{rehearsed:?}");
    let printed = String::from_utf8(rehearsed.stdout.clone()).unwrap();
    assert!(printed.contains("nobody has confirmed these values"), "{rehearsed:?}");
    let confirmed = types(folder.path(), &board, &["0.2mL", "--confirm-pump"]);
    assert_eq!(confirmed.status.code(), Some(0), "{confirmed:?}");
    let steps = board.rest().steps;
    assert!(steps > 100, "{steps}");
    // The record keeps the word.
    let again = types(folder.path(), &board, &["0.2mL"]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    assert!(board.rest().steps > steps);
    // A simulated motor needs none, and takes none.
    let mut simulated = Command::new(env!("CARGO_BIN_EXE_dose"));
    simulated.args(["0.2mL", "--confirm-pump"]).env("DOSE_STATE_DIR", folder.path().join("state"));
    let refused = simulated.env("XDG_CONFIG_HOME", folder.path()).env_remove("DOSE_PUMP").output().unwrap();
    assert!(said(&refused).contains("--confirm-pump means nothing to a simulated motor"), "{refused:?}");
}

#[test]
fn steps_that_are_said_leave_the_direction_to_be_said() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let pump = folder.path().join("bought.toml");
    let mut new = Command::new(env!("CARGO_BIN_EXE_dose"));
    new.args(["pumps", "new", "--head", "masterflex-ls-16", "--rollers", "3", "--microsteps", "64"])
        .arg(&pump);
    assert!(new.env("XDG_CONFIG_HOME", folder.path()).output().unwrap().status.success());
    let pump = pump.to_str().unwrap();
    let refused = types(folder.path(), &board, &["0.2mL", "--pump", pump]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let message = said(&refused);
    assert!(
        message.contains("the program filled in the direction (forward as axis X counts up), and nobody"),
        "{message}"
    );
    assert!(!message.contains("steps per revolution"), "{message}");
    assert_eq!(board.rest().steps, 0);
    let text = fs::read_to_string(pump).unwrap();
    fs::write(pump, text.replace("direction_confirmed = false\n", "")).unwrap();
    let dosed = types(folder.path(), &board, &["0.2mL", "--pump", pump]);
    assert_eq!(dosed.status.code(), Some(0), "{dosed:?}");
}

#[test]
fn the_word_is_asked_for_again_when_a_value_changes_and_not_for_any_other_change() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let refused = dose(&bench(folder.path(), &board, |_| ())).unwrap_err();
    assert!(matches!(refused, DoseError::Unconfirmed { changed: false, .. }), "{refused}");
    dose(&bench(folder.path(), &board, |_| ()).confirming_pump(true)).unwrap();
    dose(&bench(folder.path(), &board, |_| ())).unwrap();
    // Nothing of this says how far a step turns, or what a turn delivers.
    let other_fluid = |file: &mut PumpFile| {
        file.fluid.density_kg_m3 = 1100.0;
        file.pump.default_rate_ml_s = 4.0;
        file.motor.max_speed_rpm = 60.0;
        file.uncertainty.model_percent = 5.0;
        file.tube.life_ml = Some(40_000.0);
        (file.tube.modulus_mpa, file.tube.poisson_ratio) = (Some(3.5), Some(0.49));
    };
    dose(&bench(folder.path(), &board, other_fluid)).unwrap();
    let changes: [fn(&mut PumpFile); 5] = [
        |file| file.motor.steps_per_rev = 3200,
        |file| file.tube.bore_radius_mm = file.tube.bore_radius_mm.map(|radius_mm| radius_mm - 0.1),
        |file| file.motor.gear = 2.0,
        |file| file.drive = Some(DriveTable::of(DriverName::Grbl).with_invert(true)),
        |file| {
            let two = built_in("two-roller").unwrap();
            (file.rollers, file.tube, file.backplate) = (two.rollers, two.tube, two.backplate);
        },
    ];
    for change in changes {
        let refused = dose(&bench(folder.path(), &board, change)).unwrap_err();
        let is_asked = matches!(
            refused,
            DoseError::Unconfirmed { changed: true, .. } | DoseError::TurnedOtherwise { .. }
        );
        assert!(is_asked, "{refused}");
    }
    dose(&bench(folder.path(), &board, |_| ())).unwrap();
}

#[test]
fn a_value_that_stands_in_a_file_is_confirmed_unless_the_file_says_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let text =
        built_in("three-roller").unwrap().to_toml().replace("steps_per_rev = 12800", "steps_per_rev = 3200");
    let pump = folder.path().join("mine.toml");
    let words = |more: &'static str| ["0.2mL", "--pump", pump.to_str().unwrap(), "--format", more];
    fs::write(&pump, &text).unwrap();
    let refused = types(folder.path(), &board, &words("text"));
    assert_eq!(refused.status.code(), Some(2), "`confirmed = false` stands in it: {refused:?}");
    assert!(said(&refused).contains("3200 steps per revolution"), "{refused:?}");
    for confirmed in ["", "confirmed = true\n"] {
        fs::write(&pump, text.replace("confirmed = false\n", confirmed)).unwrap();
        let delivered = types(folder.path(), &board, &words("text"));
        assert_eq!(delivered.status.code(), Some(0), "{confirmed}: {delivered:?}");
    }
    let refused = {
        fs::write(&pump, text.replace("steps_per_rev = 3200", "steps_per_rev = 1600")).unwrap();
        types(folder.path(), &board, &words("json"))
    };
    let told = String::from_utf8(refused.stderr).unwrap();
    let error: serde_json::Value = serde_json::from_str(told.lines().last().unwrap()).unwrap();
    assert_eq!((&error["kind"], &error["moved"]), (&"pump_file".into(), &false.into()));
    assert!(error["value"].as_str().unwrap().starts_with("1600 steps per revolution"), "{error}");
}

#[test]
fn a_trial_refuses_a_pump_that_nobody_has_confirmed_and_takes_the_word_and_the_board_on_record() {
    let folder = tempfile::tempdir().unwrap();
    // The board makes 1 unit a second at most, which is 0.42 mL/s of this pump.
    let board = plug(Options { settings: vec![(110, 60.0)], ..Options::default() });
    let slow = |file: &mut PumpFile| file.pump.default_rate_ml_s = 0.2;
    let trial = || bench(folder.path(), &board, slow).planning_afresh(true);
    let refused = trial().prepare(DoseRequest::dose(0.2)).unwrap_err();
    assert!(matches!(refused, DoseError::Unconfirmed { changed: false, .. }), "{refused}");
    let refused = Rehearsal::new(&trial()).unwrap_err();
    assert!(matches!(refused, DoseError::Unconfirmed { .. }), "{refused}");
    let fast = DoseRequest::dose(0.2).with_cruise(Cruise::Flow { ml_s: 2.0 });
    bench(folder.path(), &board, slow).prepare(fast).unwrap();
    dose(&bench(folder.path(), &board, slow).confirming_pump(true)).unwrap();
    trial().prepare(DoseRequest::dose(0.2)).unwrap();
    Rehearsal::new(&trial()).unwrap();
    let refused = trial().prepare(fast).unwrap_err();
    assert!(matches!(refused, DoseError::DeviceSpeed { .. }), "{refused}");
    // A word for other values is none.
    let other = |file: &mut PumpFile| file.motor.gear = 2.0;
    let refused = bench(folder.path(), &board, other).planning_afresh(true).prepare(DoseRequest::dose(0.2));
    assert!(matches!(refused.unwrap_err(), DoseError::TurnedOtherwise { .. }));
}

#[test]
fn an_angle_is_found_by_hand_without_a_word_and_sought_by_the_motor_with_one() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let plain = bench(folder.path(), &board, |_| ());
    let (mut session, _) = plain.set_angle(Some(Phase::known(0.5))).unwrap();
    assert!(matches!(
        session.jog(100, 0.5, |_| ControlFlow::Continue(())),
        Err(DoseError::Unconfirmed { .. })
    ));
    assert_eq!(board.rest().steps, 0);
    drop(session);
    // Setting the angle records the word too.
    drop(plain.confirming_pump(true).set_angle(Some(Phase::known(0.5))).unwrap());
    dose(&bench(folder.path(), &board, |_| ())).unwrap();
}
