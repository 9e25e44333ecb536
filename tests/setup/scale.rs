//! The weight of the first dose: from a balance, from the command line, and once more.

use std::sync::Arc;

use pump_model::{DefaultPulse, Line, Pump};

use crate::balance::{Defect, SimulatedBalance, Speech, Truth, Vessel};
use crate::person::Desk;
use crate::simulated::Simulated;
use crate::simulated::options::Options;
use crate::truth::{TrueBoard, TruePump};

impl TrueBoard for Arc<Simulated> {
    fn steps(&self) -> i64 {
        self.rest().steps
    }

    fn device(&self) -> String {
        self.path().display().to_string()
    }
}

/// Options that answer everything but port and scale.
const HANDS_OFF: [&str; 25] = [
    "setup",
    "acid",
    "--ml-per-rev",
    "0.5mL",
    "--rollers",
    "4",
    "--microsteps",
    "16",
    "--driver",
    "grbl",
    "--axis",
    "X",
    "--altitude",
    "500m",
    "--outlet-end",
    "immersed",
    "--turned",
    "1",
    "--direction",
    "forward",
    "--prime",
    "1mL",
    "--volume",
    "5mL",
    "--yes",
];

/// A board with a pump of 0.55 mL a revolution, and a balance under its vessel.
fn bench(defect: Defect) -> (Arc<Simulated>, SimulatedBalance) {
    let options = Options { time_scale: 20.0, patient: true, ..Options::default() };
    let board = Arc::new(Simulated::start(options).unwrap());
    let pulse = DefaultPulse::new(0.23, 50.0);
    let pump = Pump::from_ml_per_rev(0.55, 4, pulse, Line::PUBLISHED, Line::PUBLISHED).unwrap();
    let truth = Truth {
        factor: 1.0,
        zero_rad: 0.4,
        steps_per_rev: 3200.0,
        // Water of 25 °C weighed in air of 95.5 kPa (OIML R 111-1, C.4).
        g_ml: 0.996,
        drop_ml: 0.001,
        fall_s: 0.01,
        lag_s: 0.05,
        decimals: 3,
        vessel_g: 50.0,
        defect,
        defect_from_ml: 0.0,
    };
    let turned = Arc::clone(&board);
    let vessel = Vessel::new(pump, truth);
    let steps = move || turned.truth().steps;
    (board, SimulatedBalance::start(Speech::MtSics, vessel, steps).unwrap())
}

#[test]
fn a_balance_weighs_the_first_dose_without_a_hand() {
    let desk = Desk::new();
    let (board, balance) = bench(Defect::None);
    let (port, scale) = (board.device(), balance.path().display().to_string());
    let words = [&HANDS_OFF[..], &["--port", &port, "--scale-port", &scale]].concat();
    let ended = desk.types(&words);
    assert_eq!(ended.code, 0, "{}{}", ended.out, ended.err);
    assert!(ended.err.contains("g more on the balance"), "{}", ended.err);
    // The pump delivers 0.55 mL where its owner said 0.5.
    let calibration = desk.json(&["calibrate", "list", "--pump", "acid"]);
    assert_eq!(calibration["calibrations"].as_array().map(Vec::len), Some(1), "{calibration}");
    assert!(ended.out.contains("0.55 mL per revolution") || ended.out.contains("0.550 mL"), "{}", ended.out);
    assert!(ended.out.contains("a dose of 5 mL lies between"), "{}", ended.out);
    // Every command that is told runs as it is printed.
    let told = ended.out.split('`').skip(1).step_by(2).filter_map(|quoted| quoted.strip_prefix("dose "));
    let told: Vec<&str> = told.filter(|words| !words.contains('<')).collect();
    assert!(told.contains(&format!("setup acid --scale-port {scale}").as_str()), "{told:?}");
    assert!(told.len() >= 3 && told.iter().all(|words| words.contains("acid")), "{told:?}");
    for words in told {
        let words: Vec<&str> = words.split(' ').collect();
        let more: &[&str] = match words[..2] {
            ["setup", _] => &["--yes"],
            ["calibrate", "run"] => &["--dry-run"],
            _ => &[],
        };
        let ran = desk.types(&[&words[..], more].concat());
        assert_eq!(ran.code, 0, "{words:?}: {}", ran.err);
    }
    // One more dose, by the balance again.
    let again = desk.types(&["setup", "acid", "--yes", "--scale-port", &scale]);
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(again.out.contains(" runs at"), "{}", again.out);
}

#[test]
fn a_balance_that_says_no_mass_is_refused_before_anything_moves() {
    for (defect, said) in [(Defect::Garbage, "which is no mass"), (Defect::Silent, "balance")] {
        let desk = Desk::new();
        let (board, balance) = bench(defect);
        let (port, scale) = (board.device(), balance.path().display().to_string());
        let more = ["--port", &port, "--scale-port", &scale, "--scale-wait", "2s"];
        let refused = desk.types(&[&HANDS_OFF[..], &more].concat());
        assert_eq!(refused.code, 2, "{}", refused.err);
        assert!(refused.err.contains(said) && refused.err.matches("error:").count() == 1, "{}", refused.err);
        assert_eq!((board.rest().steps, desk.configured("config.toml")), (0, None));
    }
    let both = ["--weight", "5g", "--scale-command", "true"];
    let refused = Desk::new().types(&[&HANDS_OFF[..], &both].concat());
    assert!(refused.code == 2 && refused.err.contains("cannot be used with"), "{}", refused.err);
}

#[test]
fn a_weight_that_comes_later_reads_the_last_dose_again_and_doses_nothing() {
    let desk = Desk::new();
    let sim =
        ["setup", "acid", "--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--driver", "sim"];
    let first = desk.types(&[&sim[..], &["--altitude", "500m", "--volume", "5mL", "--yes"]].concat());
    assert_eq!(first.code, 0, "{}", first.err);
    let journal = desk.journal("acid", "sim");
    let weighed = desk.types(&["setup", "acid", "--weight", "4.93g"]);
    assert_eq!(weighed.code, 0, "{}", weighed.err);
    assert!(weighed.asked.is_empty() && weighed.out.contains("1 run at"), "{}", weighed.out);
    assert!(weighed.err.contains("takes the place of the earlier reading"), "{}", weighed.err);
    assert_eq!(desk.journal("acid", "sim"), journal, "nothing is dosed");
    assert!(desk.configured("setup/acid.toml").unwrap().contains("weighed = 1"));
}

#[test]
fn a_weight_is_that_of_the_setups_dose_and_of_no_later_one() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let dosed = desk.types(&[&HANDS_OFF[..], &["--port", &pump.port()]].concat());
    assert_eq!(dosed.code, 0, "{}", dosed.err);
    assert_eq!(desk.types(&["8mL", "--pump", "acid"]).code, 0);
    let steps = pump.board.rest().steps;
    let refused = desk.types(&["setup", "acid", "--weight", "4.98g"]);
    assert!(refused.code == 2 && refused.err.contains("dosed again since setup's dose"), "{}", refused.err);
    // It is made anew, and weighed.
    assert_eq!(desk.types(&["setup", "acid", "--yes"]).code, 0);
    assert_ne!(pump.board.rest().steps, steps);
    assert_eq!(desk.types(&["setup", "acid", "--weight", "4.98g"]).code, 0);
    assert_eq!(desk.types(&["8mL", "--pump", "acid"]).code, 0);
    let refused = desk.types(&["setup", "acid", "--weight", "7.9g"]);
    assert!(refused.code == 2 && refused.err.contains("dosed since setup weighed a dose"), "{}", refused.err);
    assert!(refused.err.contains("`dose calibrate last <READING> --pump acid`"), "{}", refused.err);
    assert!(desk.configured("setup/acid.toml").unwrap().contains("weighed = 1"));
}

#[test]
fn a_weight_before_the_first_dose_of_a_real_pump_is_refused() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let refused = desk.types(&[&HANDS_OFF[..], &["--port", &pump.port(), "--weight", "4.93g"]].concat());
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("none was made yet; leave it out"), "{}", refused.err);
    assert_eq!((pump.board.rest().steps, desk.configured("config.toml")), (0, None));
}
