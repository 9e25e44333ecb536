//! Scripts, which answer by options.

use crate::person::Desk;
use crate::truth::TruePump;

/// Every answer of a simulated pump.
const SIM: [&str; 21] = [
    "setup",
    "acid",
    "--ml-per-rev",
    "0.5mL",
    "--rollers",
    "4",
    "--microsteps",
    "16",
    "--driver",
    "sim",
    "--altitude",
    "500m",
    "--suction-lift",
    "0.3m",
    "--rate",
    "0.2mL/s",
    "--volume",
    "5mL",
    "--weight",
    "4.93g",
    "--yes",
];

#[test]
fn options_answer_everything_without_a_question() {
    let desk = Desk::new();
    let ended = desk.types(&SIM);
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.asked.is_empty(), "{:?}", ended.asked);
    let file = desk.configured("pumps/acid.toml").unwrap();
    for line in ["default_rate_ml_s = 0.2", "altitude_m = 500.0", "lift_mm = 300.0"] {
        assert!(file.contains(line), "{line}: {file}");
    }
    assert_eq!(desk.json(&["5mL"])["volume_basis"], "calibrated");
}

#[test]
fn a_bore_that_nobody_knows_is_an_option_as_it_is_an_answer() {
    let desk = Desk::new();
    let ended = desk.types(&[&SIM[..], &["--bore", "unknown", "--nozzle-bore", "unknown"]].concat());
    assert_eq!(ended.code, 0, "{}", ended.err);
    let file = desk.configured("pumps/acid.toml").unwrap();
    assert!(!file.contains("bore_mm"), "{file}");
    let refused = desk.types(&[&SIM[..], &["--bore", "wide"]].concat());
    assert!(refused.code == 2 && refused.err.contains("wide"), "{}", refused.err);
}

#[test]
fn a_missing_answer_is_one_message_that_names_its_option() {
    for (option, names) in [
        ("--ml-per-rev", "--head masterflex-ls-16, --ml-per-rev 0.5mL"),
        ("--rollers", "--rollers 4"),
        ("--microsteps", "--microsteps 16"),
        ("--driver", "--driver grbl"),
        ("--altitude", "--altitude 500m or --ambient 98.2kPaa"),
    ] {
        let desk = Desk::new();
        let at = SIM.iter().position(|word| *word == option).unwrap();
        let words = [&SIM[..at], &SIM[at + 2..]].concat();
        let ended = desk.types(&words);
        assert_eq!(ended.code, 2, "{option}: {}", ended.err);
        assert!(
            ended.err.contains(names) && ended.err.matches("error:").count() == 1,
            "{option}: {}",
            ended.err
        );
        assert_eq!(ended.out, "", "{option}");
        assert_eq!(desk.configured("config.toml"), None);
        // A call without --yes and without a terminal says it too.
        let ended = desk.types(&words[..words.len() - 1]);
        assert!(ended.code == 2 && ended.err.contains(names), "{option}: {}", ended.err);
    }
}

#[test]
fn a_real_motor_does_not_move_before_somebody_can_say_what_it_did() {
    let desk = Desk::new();
    let mut pump = TruePump::new(0.55, 3200.0, (0.3, 60.0), 0.4);
    let port = pump.port();
    let board = ["--driver", "grbl", "--port", &port, "--axis", "X", "--configure"];
    let words = [&SIM[..8], &board, &SIM[10..18], &["--yes"]].concat();
    let refused = desk.types(&words);
    assert!(refused.code == 2 && refused.err.contains("--turned 1"), "{}", refused.err);
    let refused = desk.types(&[&words[..], &["--turned", "1"]].concat());
    assert!(refused.code == 2 && refused.err.contains("--direction forward"), "{}", refused.err);
    assert_eq!(pump.board.rest().steps, 0);
    // The file alone moves nothing either.
    let file = desk.types(&[&words[..], &["--no-motion"]].concat());
    assert!(file.code == 0 && file.err.contains("Nothing was moved"), "{}", file.err);
    assert_eq!(pump.board.rest().steps, 0);

    let dosed =
        desk.types(&[&words[..], &["--turned", "1", "--direction", "forward", "--prime", "1mL"]].concat());
    assert_eq!(dosed.code, 0, "{}", dosed.err);
    assert!(dosed.err.contains("`dose setup acid --weight 4.93g`"), "{}", dosed.err);
    // One revolution, 1 mL of 0.5 mL each, then 5 mL.
    assert_eq!(pump.board.rest().steps, 13 * 3200);
    pump.tare();
    let weighed = desk.types(&["setup", "acid", "--weight", "5.47g"]);
    assert_eq!(weighed.code, 0, "{}", weighed.err);
    assert!(weighed.out.contains("a dose of 5 mL lies between"), "{}", weighed.out);
    assert_eq!(pump.turns(), 0.0, "the weight alone moves nothing");
}

#[test]
fn a_pump_file_and_a_drawing_may_stand_in_place_of_the_head() {
    let desk = Desk::new();
    let drawn = [
        "setup",
        "drawn",
        "--tube",
        "10x14mm",
        "--backplate",
        "63mm",
        "--roller",
        "20mm",
        "--offset",
        "40mm",
        "--contact",
        "30deg",
        "--rollers",
        "3",
        "--microsteps",
        "64",
        "--driver",
        "sim",
        "--altitude",
        "1350m",
        "--yes",
    ];
    let ended = desk.types(&drawn);
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(desk.configured("pumps/drawn.toml").unwrap().contains("radius_mm = 63.0"));
    let from = desk.path("config/pump-dose/pumps/drawn.toml");
    let copied = desk.types(&["setup", "copy", "--from", from.to_str().unwrap(), "--driver", "sim", "--yes"]);
    assert_eq!(copied.code, 0, "{}", copied.err);
    let file = desk.configured("pumps/copy.toml").unwrap();
    assert!(file.contains("id = \"copy\"") && file.contains("steps_per_rev = 12800"), "{file}");
}

#[test]
fn a_file_of_absolute_pressures_is_asked_for_the_place_and_keeps_its_heights_in_other_air() {
    let desk = Desk::new();
    // 88.637 kPa in the paper's air of 85.7 kPa: supply and vessel stand 0.3 m above the pump.
    std::fs::write(desk.path("paper.toml"), pump_bench::built_in("three-roller").unwrap().to_toml()).unwrap();
    let copy = [
        "setup",
        "copy",
        "--from",
        "paper.toml",
        "--steps-per-rev",
        "3200",
        "--driver",
        "sim",
        "--no-motion",
    ];
    let refused = desk.types(&[&copy[..], &["--yes"]].concat());
    assert!(refused.code == 2 && refused.err.contains("say --altitude 500m or --ambient"), "{}", refused.err);
    let copied = desk.types(&[&copy[..], &["--altitude", "0m", "--suction-lift", "0.5m", "--yes"]].concat());
    assert_eq!(copied.code, 0, "{}", copied.err);
    assert!(copied.err.contains("air of 101.3 kPa, sucks up 0.5 m, lifts 0.3 m"), "{}", copied.err);
    let file = desk.configured("pumps/copy.toml").unwrap();
    for line in ["altitude_m = 0.0", "lift_mm = 500.0", "lift_mm = 300.0"] {
        assert!(file.contains(line), "{line}: {file}");
    }
    assert!(!file.contains("reservoir_kpa"), "{file}");
    // The example's place is one of its own.
    let desk = Desk::new();
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pumps/my-pump.toml");
    let words = ["setup", "mine", "--from", example, "--driver", "sim", "--no-motion", "--yes"];
    let unsaid = desk.types(&words);
    assert!(unsaid.code == 2 && unsaid.err.contains("--microsteps"), "{}", unsaid.err);
    let said = desk.types(&[&words[..], &["--microsteps", "16"]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(desk.configured("pumps/mine.toml").unwrap().contains("steps_per_rev = 3200"));
}
