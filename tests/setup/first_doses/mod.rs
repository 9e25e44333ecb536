//! First doses that are refused: they leave no record of the board, so a person corrects the port freely.

mod stopped;
mod trials;

use std::path::Path;

use crate::person::{Desk, Ended};
use crate::simulated::Simulated;
use crate::simulated::options::Options;
use crate::simulated_node::SimulatedNode;

/// Doses on the board at `port` by the built-in pump.
fn doses(desk: &Desk, driver: &str, port: &Path, words: &[&str]) -> Ended {
    let on = ["0.2mL", "--confirm-pump", "--driver", driver, "--port", port.to_str().unwrap()];
    desk.types(&[&on, words].concat())
}

/// Has the first dose at the port `wrong` refused, which no record may show, and doses at the port `right`.
fn corrects_the_port(driver: &str, wrong: &Path, right: &Path, records: &[&str]) {
    let desk = Desk::new();
    let refused = doses(&desk, driver, wrong, &["--rate", "500mL/s"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    let folder = desk.path("state/three-roller").join(driver);
    for name in records {
        assert!(!folder.join(name).exists(), "{driver}: {name} after {}", refused.err);
    }
    assert_eq!(desk.journal("three-roller", driver).unwrap_or_default(), "", "{driver}");
    let dosed = doses(&desk, driver, right, &[]);
    assert_eq!(dosed.code, 0, "{driver}: {}", dosed.err);
    for name in records {
        assert!(folder.join(name).exists(), "{driver}: {name}");
    }
    // From now on the pump has its board.
    let other = doses(&desk, driver, wrong, &[]);
    assert!(other.code == 2 && other.err.contains("--accept-settings"), "{driver}: {}", other.err);
}

#[test]
fn a_refused_first_dose_at_a_grbl_board_leaves_no_record_and_the_right_port_doses() {
    let board = |text, settings| Simulated::start(Options { text, settings, ..Options::default() }).unwrap();
    let (wrong, right) = (board("left pump", vec![]), board("right pump", vec![(100, 210.0)]));
    corrects_the_port("grbl", wrong.path(), right.path(), &["board.json", "board-settings.json"]);
    assert!(wrong.truth().asked > 0, "the first dose was refused after the board had answered");
    assert!(wrong.rest().steps == 0 && right.rest().steps > 100);
}

#[test]
fn a_refused_first_dose_at_a_node_leaves_no_record_and_the_right_port_doses() {
    let [wrong, right] = [1, 2].map(|number| SimulatedNode::start(number).unwrap());
    corrects_the_port("node", wrong.path(), right.path(), &["board.json"]);
    assert!(wrong.truth().steps == [0; 4] && right.truth().steps[0] > 100);
}
