//! Doses that an emergency stop or a fault of the stepper driver ends, and the turn to the index sensor after it.

use std::process::Stdio;
use std::time::Duration;

use crate::person::Desk;
use crate::simulated_node::{Character, SimulatedNode};

/// Steps of a revolution of the built-in pump's motor.
const STEPS_PER_REV: u32 = 12_800;

/// Writes the built-in pump at the board as `acid.toml`, with `more` in the table `[drive]`.
fn acid(desk: &Desk, board: &SimulatedNode, more: &str) {
    let file = desk.types(&["pumps", "show", "three-roller"]);
    assert_eq!(file.code, 0, "{}", file.err);
    let pump: String = file.out.replace("id = \"three-roller\"", "id = \"acid\"");
    let port = board.path().display();
    let drive = format!("\n[drive]\ndriver = \"node\"\nport = \"{port}\"\naxis = \"X\"\n{more}");
    std::fs::write(desk.path("acid.toml"), pump + &drive).unwrap();
}

/// Begins a dose of 3 mL and touches the board once its motor has made some steps. Returns the error.
fn ended_by(desk: &Desk, board: &SimulatedNode, hand: &str) -> String {
    let mut running = desk.command(&["3mL", "--pump", "acid.toml", "--confirm-pump"]);
    let running = running.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let before = board.truth().steps[0];
    while board.truth().steps[0] < before + 300 {
        std::thread::sleep(Duration::from_millis(5));
    }
    board.touch(hand).unwrap();
    let ended = running.wait_with_output().unwrap();
    let err = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(1), "{err}");
    err
}

#[test]
fn a_turn_to_the_index_within_a_dose_is_announced_counted_and_told_before_the_rest() {
    let desk = Desk::new();
    let index_steps = [Some(STEPS_PER_REV), None, None, None];
    let board =
        SimulatedNode::start_as(Character { number: 7, index_steps, ..Character::default() }).unwrap();
    acid(&desk, &board, "index_angle_deg = 10.0\n");
    ended_by(&desk, &board, "estop");
    board.touch("release").unwrap();
    let json = |words: &[&str]| desk.json(&[words, &["--pump", "acid.toml"]].concat());
    let before = json(&["status"]);
    assert_eq!(before["unfinished"]["searched_ml"], 0.0, "{before}");
    let made = board.truth().steps[0];
    let asked = desk.types(&["home", "--unfinished", "--sensor", "--pump", "acid.toml"]);
    assert!(asked.code == 2 && asked.err.contains("a dose of 3 mL is unfinished"), "{}", asked.err);
    let home = desk.types(&["home", "--unfinished", "--sensor", "--yes", "--pump", "acid.toml"]);
    assert_eq!(home.code, 0, "{}", home.err);
    let turned = board.truth().steps[0] - made;
    assert!(turned > 1_000, "{turned} steps to the index");
    for said in ["it pumps up to 21.3 mL", "put the tube's end over waste first", "counts as not delivered"] {
        assert!(home.err.contains(said), "{said}: {}", home.err);
    }
    let after = json(&["status"]);
    let searched_ml = after["unfinished"]["searched_ml"].as_f64().unwrap();
    let worn = |status: &serde_json::Value| status["wear"]["volume_ml"].as_f64().unwrap();
    assert!((searched_ml - (worn(&after) - worn(&before))).abs() < 1e-9 && searched_ml > 1.0, "{after}");
    for (key, value) in [("delivered_least_ml", "least"), ("delivered_most_ml", "most")] {
        assert_eq!(after["unfinished"][key], before["unfinished"][key], "{value} of the dose");
    }
    let text = desk.types(&["status", "--pump", "acid.toml"]);
    assert!(text.out.contains("turns to find the angle pumped"), "{}", text.out);
    let log = desk.types(&["log", "--pump", "acid.toml"]);
    let line =
        log.out.lines().find(|line| line.contains("to the index")).unwrap_or_else(|| panic!("{}", log.out));
    assert!(line.contains("jog") && line.contains(&format!("{searched_ml:.4} mL")), "{line}");
    let rest = desk.types(&["resume", "--pump", "acid.toml"]);
    assert_eq!(rest.code, 0, "{}", rest.err);
    let said = "while this dose was unfinished, which count as not delivered";
    assert!(rest.err.contains(said) && rest.err.contains("as much more than 3 mL"), "{}", rest.err);
    assert_eq!(json(&["status"])["unfinished"], serde_json::Value::Null);
}

#[test]
fn a_motor_whose_current_is_cut_is_not_said_to_hold() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    acid(&desk, &board, "[drive.pins]\ndriver_fault = true\n");
    for (hand, other) in [("estop", "release"), ("fault X", "mend X")] {
        assert_eq!(desk.types(&["home", "--set", "30deg", "--pump", "acid.toml"]).code, 0);
        let err = ended_by(&desk, &board, hand);
        assert!(err.contains("mL were delivered, the motor has no current, and the drive failed"), "{err}");
        assert!(!err.contains("the motor holds"), "{err}");
        // The wiring was right when the dose began.
        let wiring = match hand {
            "estop" => "a bridge from its stop input to GND (GP22 of a Pico)",
            _ => "[drive.pins] driver_fault names the level of its fault output",
        };
        assert!(!err.contains(wiring) && err.matches("`dose status").count() == 1, "{err}");
        let status = desk.types(&["status", "--pump", "acid.toml"]).out;
        let why = match hand {
            "estop" => "because the emergency stop cut the motor's current",
            _ => "because the stepper driver lost the motor's current in motion",
        };
        assert!(status.contains(why) && status.contains("--unfinished --set <ANGLE>"), "{status}");
        let again = desk.types(&["resume", "--rate", "1mL/min", "--pump", "acid.toml"]);
        assert!(again.code == 2 && again.err.contains(wiring), "{}: {}", again.code, again.err);
        board.touch(other).unwrap();
        assert_eq!(desk.types(&["accept", "--pump", "acid.toml"]).code, 0);
    }
}

#[test]
fn a_fault_output_that_is_high_in_a_fault_is_read_as_such() {
    let desk = Desk::new();
    let fault_high = [true, false, false, false];
    let board = SimulatedNode::start_as(Character { number: 7, fault_high, ..Character::default() }).unwrap();
    acid(&desk, &board, "[drive.pins]\ndriver_fault = true\n");
    let wrong = desk.types(&["0.2mL", "--pump", "acid.toml", "--confirm-pump"]);
    assert!(wrong.code == 2 && wrong.err.contains("the stepper driver reported a fault"), "{}", wrong.err);
    acid(&desk, &board, "[drive.pins]\ndriver_fault = \"high\"\n");
    let err = ended_by(&desk, &board, "fault X");
    assert!(err.contains("the stepper driver reported a fault"), "{err}");
    board.touch("mend X").unwrap();
    assert_eq!(desk.types(&["resume", "--pump", "acid.toml"]).code, 0);
}
