//! The word that a motor moves: it is said before a motion, and before no refusal.

use std::fs;

use crate::person::{Desk, Ended};
use crate::simulated_node::SimulatedNode;

/// Options that set a pump up without a question or a motion.
const OPTIONS: [&str; 15] = [
    "setup",
    "acid",
    "--ml-per-rev",
    "0.5mL",
    "--rollers",
    "4",
    "--altitude",
    "500m",
    "--rate",
    "0.6mL/s",
    "--direction",
    "forward",
    "--no-motion",
    "--yes",
    "--microsteps",
];

/// Pump on a board, with its microsteps and a rate that the pump file allows.
fn set_up(words: &[&str]) -> Desk {
    let desk = Desk::new();
    let ended = desk.types(&[&OPTIONS[..], words].concat());
    assert_eq!(ended.code, 0, "{}", ended.err);
    desk
}

/// Changes a line of the pump file.
fn rewrite(desk: &Desk, from: &str, to: &str) {
    let path = desk.path("config/pump-dose/pumps/acid.toml");
    let file = fs::read_to_string(&path).unwrap();
    assert!(file.contains(from), "{from}: {file}");
    fs::write(&path, file.replacen(from, to, 1)).unwrap();
}

fn is_refused_in_silence(ended: &Ended, said: &str) {
    assert!(ended.code == 2 && ended.err.contains(said), "{}: {}", ended.code, ended.err);
    assert!(!format!("{}{}", ended.out, ended.err).contains("MOVING"), "{}{}", ended.out, ended.err);
}

#[test]
fn a_plan_that_a_node_refuses_is_not_announced_as_a_motion() {
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let node = ["--driver", "node", "--port", &port];
    let desk = set_up(&[&["512"], &node[..]].concat());
    is_refused_in_silence(
        &desk.types(&["1mL", "--rate", "0.8mL/s"]),
        "the node driver makes 96385 steps/s at most",
    );
    is_refused_in_silence(
        &desk.types(&["1mL", "--rate", "0.8mL/s", "--format", "json"]),
        "the node driver makes 96385 steps/s at most",
    );
    let desk = set_up(&[&["16"], &node[..]].concat());
    assert_eq!(desk.types(&["home", "--set", "30deg+-1deg"]).code, 0);
    rewrite(&desk, "driver = \"node\"", "driver = \"node\"\nbaud = 9600");
    // The questions for the state of an axis are more than such a line carries.
    is_refused_in_silence(
        &desk.types(&["3mL", "--smooth"]),
        "[drive] baud is 9600; allowed: 115200 to 4000000",
    );
    assert_eq!(board.truth().steps, [0; 4]);
    rewrite(&desk, "baud = 9600", "baud = 115200");
    let ended = desk.types(&["0.1mL"]);
    assert!(ended.code == 0 && ended.out.starts_with("MOVING acid on /dev/"), "{ended:?}");
}
