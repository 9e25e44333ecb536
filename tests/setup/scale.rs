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
    assert!(refused.code == 2 && refused.err.contains("moved since setup's dose"), "{}", refused.err);
    // It is made anew, and weighed. Another volume comes too late then.
    assert_eq!(desk.types(&["setup", "acid", "--yes"]).code, 0);
    assert_ne!(pump.board.rest().steps, steps);
    let late = desk.types(&["setup", "acid", "--volume", "7mL", "--weight", "4.98g"]);
    assert!(late.code == 2 && late.err.contains("so that --volume changes nothing"), "{}", late.err);
    assert_eq!(desk.types(&["setup", "acid", "--weight", "4.98g"]).code, 0);
    assert_eq!(desk.types(&["8mL", "--pump", "acid"]).code, 0);
    let refused = desk.types(&["setup", "acid", "--weight", "7.9g"]);
    assert!(refused.code == 2 && refused.err.contains("dosed since setup weighed a dose"), "{}", refused.err);
    assert!(refused.err.contains("`dose calibrate last <READING> --pump acid`"), "{}", refused.err);
    assert!(desk.configured("setup/acid.toml").unwrap().contains("weighed = 1"));
}

#[test]
fn a_dose_that_waits_for_its_weight_is_made_anew_once_the_pump_is_turned_round() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let hands_off = |more: &[&str]| desk.types(&[&HANDS_OFF[..], &["--port", &port], more].concat());
    let dosed = hands_off(&[]);
    assert!(dosed.code == 0 && dosed.err.contains("Weigh the dose"), "{}", dosed.err);
    let round = desk.types(&["setup", "acid", "--direction", "reverse", "--turned", "1", "--yes"]);
    assert!(round.code == 0 && round.err.contains("Weigh the dose"), "{}", round.err);
    assert!(round.err.contains("as the pump runs forward, as --direction says"), "{}", round.err);
    let [turn, dose] = ["One revolution", "Weigh a dose"].map(|part| round.err.find(part));
    assert!(turn.is_some() && turn < dose, "{}", round.err);
    // The rotor is turned for its angle, so the dose is weighed no more, and setup goes on all the same.
    let turned = desk.types(&["home", "--set", "10deg", "--pump", "acid"]);
    assert_eq!(turned.code, 0, "{}", turned.err);
    let late = desk.types(&["setup", "acid", "--weight", "4.98g"]);
    assert!(late.code == 2 && late.err.contains("moved since setup's dose"), "{}", late.err);
    let again = desk.types(&["setup", "acid", "--volume", "7mL", "--yes"]);
    assert!(again.code == 0 && again.err.contains("Weigh a dose"), "{}", again.err);
    assert_eq!(desk.types(&["setup", "acid", "--weight", "6.98g"]).code, 0);
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

/// Prints 3 g while no dose is on record, and then what the file `after` says.
const AFTER_DOSE: &str = "if grep -q '\"purpose\":\"dose\"' state/acid/sim/journal.jsonl 2>/dev/null; then cat after; \
                          else echo 3.000 g; fi";

/// Options that set a simulated pump up for a dose of 5 mL.
const SIM: [&str; 18] = [
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
    "--prime",
    "0",
    "--volume",
    "5mL",
    "--yes",
    "--scale-wait=2s",
];

#[test]
fn a_dose_whose_reading_failed_weighs_what_the_balance_shows_more_than_before_it() {
    let desk = Desk::new();
    std::fs::write(desk.path("after"), "garbage\n").unwrap();
    let failed = desk.types(&[&SIM[..], &["--scale-command", AFTER_DOSE]].concat());
    assert!(failed.code == 1 && failed.err.contains("`dose setup acid --scale-"), "{}", failed.err);
    let journal = desk.journal("acid", "sim");
    // The vessel of 3 g is on the balance still.
    std::fs::write(desk.path("after"), "8.000 g\n").unwrap();
    let ended = desk.types(&["setup", "acid", "--yes", "--scale-command", AFTER_DOSE]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("  5.000 g more on the balance"), "{}", ended.err);
    assert_eq!(desk.journal("acid", "sim"), journal, "nothing is dosed");
    let calibration = desk.json(&["calibrate", "list", "--pump", "acid"]).to_string();
    // 5 g of water are 5.02 mL, where the file says 5.
    assert!(calibration.contains("\"factor\":1.00"), "{calibration}");
}

#[test]
fn a_dose_before_which_nobody_read_the_balance_is_weighed_by_hand_or_made_again() {
    let desk = Desk::new();
    std::fs::write(desk.path("after"), "8.000 g\n").unwrap();
    // Somebody leaves where the weight is asked for.
    let left = desk.answers(&SIM[..16], &mut |question| (!question.starts_with("Reading")).then(String::new));
    assert!(left.err.contains("say --weight 4.93g, or --again to dose again"), "{}", left.err);
    let balance = ["setup", "acid", "--yes", "--scale-command", AFTER_DOSE];
    let refused = desk.types(&balance);
    assert!(refused.err.contains("the balance was not read before this dose"), "{}", refused.err);
    assert!(refused.err.contains("--weight") && refused.err.contains("--again"), "{}", refused.err);
    assert!(desk.configured("setup/acid.toml").unwrap().contains("weighed = 0"));
    let weighed = desk.types(&["setup", "acid", "--yes", "--weight", "4.93g"]);
    assert_eq!(weighed.code, 0, "{}", weighed.err);
    assert!(desk.configured("setup/acid.toml").unwrap().contains("weighed = 1"));
}

#[test]
fn a_balance_beside_a_simulated_pump_is_told_that_no_motor_moved() {
    let desk = Desk::new();
    let still = desk.types(&[&SIM[..], &["--scale-command", "echo 3.000 g"]].concat());
    assert_eq!(still.code, 1, "{}", still.err);
    assert!(
        still.err.contains(
            "the balance rose by 0.000 g where a simulated motor made the steps of 5 mL: no motor moved"
        ),
        "{}",
        still.err
    );
    assert!(!still.err.contains("is the vessel on it"), "{}", still.err);
}

#[test]
fn an_option_asks_for_one_more_dose_of_a_pump_that_is_set_up() {
    let desk = Desk::new();
    assert_eq!(desk.types(&SIM[..17]).code, 0);
    let doses = |desk: &Desk| desk.journal("acid", "sim").unwrap().matches("\"purpose\":\"dose\"").count();
    let unasked = desk.types(&["setup", "acid"]);
    assert!(
        unasked.code == 2 && unasked.err.contains("say --again for one more, or --yes for none"),
        "{}",
        unasked.err
    );
    let first = doses(&desk);
    assert_eq!((desk.types(&["setup", "acid", "--yes"]).code, doses(&desk)), (0, first));
    let again = desk.types(&["setup", "acid", "--again", "--yes"]);
    assert!(again.code == 0 && again.out.contains("2 runs at"), "{}{}", again.out, again.err);
    assert_eq!(doses(&desk), 2 * first);
    // A person may change by hand what no question asks for, and setup weighs on.
    let path = desk.path("config/pump-dose/pumps/acid.toml");
    let edited = std::fs::read_to_string(&path).unwrap() + "\n# my own\n[safety]\nmax_ml_per_day = 500.0\n";
    std::fs::write(&path, &edited).unwrap();
    let again = desk.types(&["setup", "acid", "--again", "--yes"]);
    assert!(again.code == 0 && again.out.contains("3 runs at"), "{}{}", again.out, again.err);
    assert_eq!((doses(&desk), std::fs::read_to_string(&path).unwrap()), (3 * first, edited));
    let both = desk.types(&["setup", "acid", "--again", "--weight", "4.93g"]);
    let said =
        "--weight is that of the dose in the vessel, and --again leaves that dose and makes another one";
    assert!(both.code == 2 && both.err.contains(said), "{}", both.err);
    assert_eq!(doses(&desk), 3 * first);
}
