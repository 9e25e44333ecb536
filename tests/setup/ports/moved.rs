//! Pumps that go to another port, axis or board.

use crate::course::sees;
use crate::node::OPTIONS;
use crate::person::Desk;
use crate::simulated_node::SimulatedNode;
use crate::truth::TruePump;

#[test]
fn a_pump_that_has_not_moved_goes_to_the_board_axis_and_driver_that_setup_finds_there() {
    let desk = Desk::new();
    let (board, other) = (SimulatedNode::start(7).unwrap(), SimulatedNode::start(8).unwrap());
    let [port, other_port] = [&board, &other].map(|board| board.path().display().to_string());
    let set_up = |words: &[&str]| desk.types(&[&["setup", "acid"][..], words, &OPTIONS].concat());
    assert_eq!(set_up(&["--port", &port, "--axis", "X"]).code, 0);
    let moved = desk.types(&["setup", "acid", "--port", &other_port, "--no-motion", "--yes"]);
    assert!(moved.code == 0 && moved.err.contains("axis X, board 0000000000000008"), "{}", moved.err);
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/motor.md")).unwrap();
    assert!(page.contains("`dose setup NAME --port OTHER` moves a pump that has not yet moved to"));
    // The axis alone goes on record too, and leaves the one before to another pump.
    let moved = desk.types(&["setup", "acid", "--axis", "Y", "--no-motion", "--yes"]);
    assert_eq!(moved.code, 0, "{}", moved.err);
    let words = ["setup", "base", "--port", &other_port, "--axis", "X"];
    let base = desk.types(&[&words[..], &OPTIONS].concat());
    assert!(base.code == 0 && !base.err.contains("takes its place"), "{}", base.err);
    // A driver that the board has not, and a script that would forget all answers, leave the pump as it was.
    let file = desk.configured("pumps/acid.toml");
    let before = "; the answers on record are as before";
    for (words, told) in [
        (&["--driver", "grbl"][..], "and --driver is grbl"),
        (&["--anew", "--axis", "Z"], "; --anew forgets every answer"),
    ] {
        let refused = desk.types(&[&["setup", "acid", "--no-motion", "--yes"][..], words].concat());
        let said = refused.err;
        assert!(refused.code == 2 && said.contains(told) && said.contains(before), "{said}");
        assert_eq!(desk.configured("pumps/acid.toml"), file);
    }
    let kept = desk.types(&["setup", "acid", "--rate", "0.5mL/s", "--no-motion", "--yes"]);
    assert!(kept.code == 0 && kept.err.contains("axis Y, board 0000000000000008"), "{}", kept.err);
    let dosed = desk.json(&["0.2mL", "--pump", "acid", "--confirm-pump"]);
    assert_eq!(dosed["completed"], true, "{dosed}");
    assert!(board.truth().steps == [0; 4] && other.truth().steps[1] > 0);
    // The record stays as it is until the pump moves at another place.
    let stands = |told: &str| {
        let status = desk.types(&["status", "--pump", "acid"]);
        assert!(status.out.contains(told), "{}", status.out);
    };
    stands("board on record: 0000000000000008, axis Y\n");
    assert_eq!(desk.types(&["setup", "acid", "--axis", "Z", "--no-motion", "--yes"]).code, 0);
    stands("board on record: 0000000000000008, axis Y; its pump file names axis Z now\n");
    // No board answers at the new port: a file alone names it all the same, with a warning.
    let missing = desk.path("no-such-port").display().to_string();
    let away = desk.types(&["setup", "base", "--port", &missing, "--no-motion", "--yes"]);
    assert!(
        away.code == 0 && away.err.contains("the pump file names this port all the same"),
        "{}",
        away.err
    );
}

#[test]
fn a_person_is_asked_if_another_board_turns_a_pump_that_has_moved_and_a_script_is_told_what_takes_it() {
    let desk = Desk::new();
    let (board, other) = (SimulatedNode::start(7).unwrap(), SimulatedNode::start(8).unwrap());
    let [port, other_port] = [&board, &other].map(|board| board.path().display().to_string());
    let words = ["setup", "acid", "--port", &port, "--axis", "X"];
    assert_eq!(desk.types(&[&words[..], &OPTIONS].concat()).code, 0);
    desk.json(&["0.2mL", "--pump", "acid", "--confirm-pump"]);
    let script = desk.types(&["setup", "acid", "--port", &other_port, "--turned", "1", "--yes"]);
    let told = "`dose home --unknown --accept-settings --pump acid` takes the one that is there";
    assert!(script.code == 2 && script.err.contains(told), "{}", script.err);
    let of_other = "is of board 0000000000000007, and another one is at";
    assert!(script.err.contains(of_other), "{}", script.err);
    let mut asked = Vec::new();
    let mut pump = TruePump::behind(other, 0.55, 3200.0, (0.3, 60.0), 0.4);
    let ended = desk.answers(&["setup", "acid"], &mut |question| {
        if question.starts_with("Does the board") {
            asked.push(question.to_owned());
            // The first answer asks for the port anew.
            return Some(if asked.len() == 1 { "no" } else { "yes" }.to_owned());
        }
        Some(match question {
            q if q.starts_with("May the motor move") => "quit".to_owned(),
            q => sees(&mut pump, q, "16"),
        })
    });
    assert_eq!((ended.code, asked.len()), (0, 2), "{asked:?}: {}", ended.err);
    assert!(ended.err.contains("is number 0000000000000008"), "{}", ended.err);
    assert_eq!(pump.board.truth().steps, [0; 4]);
}

#[test]
fn a_weighed_pump_turns_a_revolution_at_its_new_axis_before_it_is_set_up() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let options: Vec<_> = OPTIONS.into_iter().filter(|word| *word != "--no-motion").collect();
    let first = ["setup", "acid", "--port", &port, "--axis", "X", "--turned", "1", "--prime", "0"];
    let set_up = desk.types(&[&first[..], &["--volume", "0.5mL"], &options].concat());
    assert_eq!(set_up.code, 0, "{}", set_up.err);
    let weighed = desk.types(&["setup", "acid", "--weight", "0.5g", "--yes"]);
    assert!(weighed.code == 0 && weighed.out.contains("`acid` is set up"), "{}{}", weighed.out, weighed.err);
    let moved = desk.types(&["setup", "acid", "--axis", "Y", "--yes"]);
    assert!(moved.code == 2 && moved.err.contains("say --turned 1"), "{}", moved.err);
    assert!(!moved.out.contains("is set up"), "{}", moved.out);
    assert_eq!(board.truth().steps[1], 0);
    let turned = desk.types(&["setup", "acid", "--turned", "1", "--yes"]);
    assert!(turned.code == 0 && turned.out.contains("`acid` is set up"), "{}{}", turned.out, turned.err);
    assert_eq!(board.truth().steps[1], 3200);
    let dosed = desk.json(&["0.2mL", "--pump", "acid"]);
    assert_eq!(dosed["completed"], true, "{dosed}");
}
