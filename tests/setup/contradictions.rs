//! Answers that contradict one another: one message, nothing moved, nothing lost.

use std::fs;

use crate::person::{ACID, Desk, by_part};
use crate::truth::TruePump;

/// Refused with exit code 2, and one message with these parts. Nothing is written.
fn is_refused(desk: &Desk, words: &[&str], parts: &[&str]) {
    let before = (
        desk.configured("config.toml"),
        desk.configured("pumps/acid.toml"),
        desk.configured("setup/acid.toml"),
    );
    let ended = desk.types(words);
    assert_eq!(ended.code, 2, "{words:?}: {}{}", ended.out, ended.err);
    for part in parts {
        assert!(ended.err.contains(part), "{part}: {}", ended.err);
    }
    assert!(ended.err.matches("error:").count() == 1 && ended.out.is_empty(), "{}", ended.err);
    let after = (
        desk.configured("config.toml"),
        desk.configured("pumps/acid.toml"),
        desk.configured("setup/acid.toml"),
    );
    assert_eq!(before, after, "{words:?}");
}

#[test]
fn options_that_contradict_each_other_are_one_message() {
    let desk = Desk::new();
    is_refused(
        &desk,
        &["setup", "acid", "--head", "kamoer-kphm400-25", "--rollers", "4", "--yes"],
        &["kamoer-kphm400-25 has 3 rollers by its document, and 4 are said"],
    );
    is_refused(&desk, &["setup", "acid", "--head", "masterflex-ls-61", "--yes"], &["masterflex-ls-16"]);
    // (101.325 - 3.17) kPa of water of 997 kg/m³ is 10.04 m.
    is_refused(
        &desk,
        &[&ACID[..], &["--altitude", "0m", "--suction-lift", "12m"]].concat(),
        &["water is not sucked up 12 m", "10.04 m"],
    );
    // 100 r/min of 0.5 mL are 0.833 mL/s.
    is_refused(&desk, &[&ACID[..], &["--rate", "5mL/s"]].concat(), &["needs 600 r/min", "0.833 mL/s"]);
    is_refused(&desk, &[&ACID[..], &["--head", "kamoer-kphm400-25"]].concat(), &["cannot be used with"]);
    is_refused(&desk, &["setup", "Acid", "--yes"], &["`Acid` cannot name a pump", "a-z"]);
    is_refused(&desk, &["setup", "three-roller", "--yes"], &["no built-in pump's name"]);
}

#[test]
fn a_rate_that_the_board_does_not_step_is_refused_before_anything_moves() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    // 0.5 mL/s is a revolution a second, of 200 x 256 x 2 steps. The board makes 6000 mm/min of 250 steps, 25000
    // steps/s: 14.65 r/min.
    let fine = [
        "--microsteps",
        "256",
        "--gear",
        "2",
        "--rate",
        "0.5mL/s",
        "--turned",
        "1",
        "--direction",
        "forward",
    ];
    let board = ["--driver", "grbl", "--port", &port, "--axis", "X", "--altitude", "500m"];
    let refused = desk.types(&[&ACID[..], &fine, &board].concat());
    assert_eq!(refused.code, 2, "{}", refused.err);
    for part in ["0.5 mL/s needs 60.00 r/min", "to 14.65 r/min", "0.1221 mL/s"] {
        assert!(refused.err.contains(part), "{part}: {}", refused.err);
    }
    assert_eq!(pump.board.rest().steps, 0);
}

#[test]
fn an_answer_that_contradicts_is_asked_again_and_the_others_stay() {
    let desk = Desk::new();
    let mut heights = ["12m", "0.3m"].iter();
    let answers =
        [("Rollers", "4"), ("Head:", "0.5mL"), ("Microsteps", "16"), ("Driver", "sim"), ("Altitude", "500m")];
    let mut react = by_part(&answers);
    let ended = desk.answers(&["setup", "acid"], &mut |question| {
        if question.starts_with("Height of the pump") {
            heights.next().map(ToString::to_string)
        } else {
            react(question)
        }
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("water is not sucked up 12 m: the air of 95.5 kPa"), "{}", ended.err);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("lift_mm = 300.0"));
}

#[test]
fn a_name_that_another_pump_has_is_refused() {
    let desk = Desk::new();
    fs::create_dir_all(desk.path("config/pump-dose")).unwrap();
    let text =
        pump_bench::built_in("three-roller").unwrap().to_toml().replace("\"three-roller\"", "\"acid\"");
    fs::write(desk.path("own.toml"), text).unwrap();
    let own = desk.path("own.toml");
    for name in ["acid", "base"] {
        // The name itself, or another name of a file with this id.
        let config = format!("schema = \"config/1\"\n[pumps]\n{name} = {:?}\n", own);
        fs::write(desk.path("config/pump-dose/config.toml"), config).unwrap();
        is_refused(&desk, &ACID, &["own.toml is that of a pump `acid` already; choose another name"]);
    }
    // A record that is left from before is not taken over.
    fs::remove_file(desk.path("config/pump-dose/config.toml")).unwrap();
    let own = own.to_str().unwrap();
    assert_eq!(desk.types(&["5mL", "--pump", own]).code, 0);
    let journal = desk.journal("acid", "sim").unwrap();
    is_refused(&desk, &ACID, &["state/acid is that of a pump `acid` already"]);
    assert_eq!(desk.journal("acid", "sim").unwrap(), journal);
}

#[test]
fn a_pump_file_that_was_changed_by_hand_is_not_written_anew() {
    let desk = Desk::new();
    let words =
        [&ACID[..], &["--microsteps", "16", "--driver", "sim", "--altitude", "500m", "--no-motion"]].concat();
    assert_eq!(desk.types(&words).code, 0);
    let path = desk.path("config/pump-dose/pumps/acid.toml");
    let mine = fs::read_to_string(&path).unwrap().replace("count = 4", "count = 4 # seen");
    fs::write(&path, &mine).unwrap();
    let refused = desk.types(&["setup", "acid", "--rate", "0.1mL/s", "--yes", "--no-motion"]);
    assert!(refused.code == 2 && refused.err.contains("was changed by hand"), "{}", refused.err);
    assert_eq!(fs::read_to_string(&path).unwrap(), mine);
}

#[test]
fn a_weight_that_cannot_be_is_refused_and_the_dose_stays() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let board =
        ["--microsteps", "16", "--driver", "grbl", "--port", &port, "--axis", "X", "--altitude", "500m"];
    let turn = ["--turned", "1", "--direction", "forward", "--prime", "0", "--volume", "5mL"];
    let dosed = desk.types(&[&ACID[..], &board, &turn].concat());
    assert_eq!(dosed.code, 0, "{}", dosed.err);
    let steps = pump.board.rest().steps;
    for (weight, part) in [("50g", ", half to twice the "), ("5", "has no unit"), ("-5g", "without sign")] {
        let refused = desk.types(&["setup", "acid", "--weight", weight]);
        assert!(refused.code == 2 && refused.err.contains(part), "{weight}: {}", refused.err);
    }
    assert_eq!(pump.board.rest().steps, steps);
    assert_eq!(desk.types(&["setup", "acid", "--weight", "4.98g"]).code, 0);
}

#[test]
fn another_head_leaves_the_calibration_of_the_first_and_is_weighed_again() {
    let desk = Desk::new();
    let sim = ["--microsteps", "16", "--driver", "sim", "--altitude", "500m", "--volume", "5mL"];
    let first = desk.types(&[&ACID[..], &sim].concat());
    assert_eq!(first.code, 0, "{}", first.err);
    let other = desk.types(&["setup", "acid", "--ml-per-rev", "0.4mL", "--bore", "1.6mm", "--yes"]);
    assert_eq!(other.code, 0, "{}", other.err);
    assert!(other.err.contains("Calibration 1 was made with another head"), "{}", other.err);
    assert!(other.out.contains("calibration 2 of acid (sim): 1 run at"), "{}", other.out);
    assert_eq!(desk.json(&["5mL"])["volume_basis"], "calibrated");
    // A bore alone belongs to the head that is on record.
    let bore = desk.types(&["setup", "acid", "--bore", "2mm", "--yes"]);
    assert!(bore.code == 0 && !bore.err.contains("another head"), "{}", bore.err);
    is_refused(
        &desk,
        &["setup", "base", "--head", "kamoer-kphm400-25", "--bore", "2mm", "--yes"],
        &["--bore stands beside a volume per revolution"],
    );
}
