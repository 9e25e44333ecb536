//! The way back to the previous question.

use crate::person::{Desk, Ended, Reaction};
use crate::truth::TruePump;

/// Answers questions in this order, each known by its first words. The input ends after the last.
fn in_order<'a>(answers: &'a [(&'a str, &'a str)]) -> Box<Reaction<'a>> {
    let mut answers = answers.iter();
    Box::new(move |question| {
        let (start, answer) = answers.next()?;
        assert!(question.starts_with(start), "`{start}` is not asked, but `{question}`");
        Some((*answer).to_owned())
    })
}

fn sets_up(desk: &Desk, more: &[&str], answers: &[(&str, &str)]) -> Ended {
    let ended = desk.answers(&[&["setup", "acid"], more].concat(), &mut *in_order(answers));
    assert_eq!((ended.code, ended.asked.len()), (0, answers.len()), "{}", ended.err);
    ended
}

/// Answers from the motor to the place.
const REST: [(&str, &str); 10] = [
    ("Full steps", ""),
    ("Microsteps", "16"),
    ("Gear", ""),
    ("Driver", "sim"),
    ("Altitude", "500m"),
    ("Height of the pump", ""),
    ("Height of the vessel", ""),
    ("End of the outlet", ""),
    ("Inner diameter", ""),
    ("Rate", ""),
];

#[test]
fn back_asks_the_question_before_anew_in_this_run_and_in_the_next() {
    let desk = Desk::new();
    // A litre in place of a millilitre leaves no bore that fits.
    let left = [("Head:", "back"), ("Head:", "0.5 L"), ("Bore", "1.6mm"), ("Bore", "quit")];
    let said = sets_up(&desk, &[], &left);
    // Piped answers were written before: nobody types these words. At a terminal the page of docs shows them.
    assert!(!said.err.contains("back returns") && !said.err.contains("? explains"), "{}", said.err);
    assert!(said.err.contains("no question was asked before this one"), "{}", said.err);
    let again = [
        ("Bore", "back"),
        (
            "Head: mL per revolution (as 0.5mL), a name of the catalogue, a pump file, or `drawing` [500mL]",
            "0.5mL",
        ),
        ("Bore", "2mm"),
        ("Rollers", "back"),
        ("Bore of the tube (inner diameter), or `unknown` [2mm]", "back"),
        (
            "Head: mL per revolution (as 0.5mL), a name of the catalogue, a pump file, or `drawing` [0.5mL]",
            "",
        ),
        ("Bore of the tube (inner diameter), or `unknown` [2mm]", "1.6mm"),
        ("Rollers", "4"),
    ];
    // The summary goes back to the rate, and a correction's first question to the summary.
    let end = [
        ("Is this right?", "back"),
        ("Rate of a dose that names none [0.21mL/s]", "back"),
        ("Inner diameter of the outlet's end, or `unknown` [1.6mm]", ""),
        ("Rate", "0.2mL/s"),
        ("Is this right?", "motor"),
        ("Full steps per revolution of the motor [200]", "400"),
        ("Microsteps per full step [16]", "back"),
        ("Full steps per revolution of the motor [400]", "back"),
        ("Is this right?", ""),
    ];
    sets_up(&desk, &["--no-motion"], &[&again[..], &REST, &end].concat());
    let file = desk.configured("pumps/acid.toml").unwrap();
    for line in
        ["ml_per_rev = 0.5\n", "tube_bore_mm = 1.6\n", "steps_per_rev = 3200", "default_rate_ml_s = 0.2\n"]
    {
        assert!(file.contains(line), "{line}: {file}");
    }
}

#[test]
fn back_walks_through_the_dimensions_of_a_drawing() {
    let desk = Desk::new();
    let drawing = [
        ("Head:", "drawing"),
        ("Rollers", "4"),
        ("Radius of the backplate", "back"),
        ("Rollers, counted [4]", "back"),
        ("Head:", "drawing"),
        ("Rollers", "3"),
        ("Radius of the backplate", "63mm"),
        ("Radius of a roller", "back"),
        ("Radius of the backplate (raceway) [63mm]", ""),
        ("Radius of a roller", "20mm"),
        ("From the shaft", "40mm"),
        ("Tube", "10x14mm"),
        ("Contact angle", "30deg"),
        ("Full steps", "back"),
        ("Rollers, counted [3]", ""),
        ("Radius of the backplate (raceway) [63mm]", ""),
        ("Radius of a roller [20mm]", ""),
        ("From the shaft to a roller's axis [40mm]", ""),
        ("Tube, bore x outer diameter [10x14mm]", ""),
        ("Contact angle [30deg]", ""),
        ("Full steps", "quit"),
    ];
    sets_up(&desk, &[], &drawing);
    let answers = desk.configured("setup/acid.toml").unwrap();
    for line in ["rollers = 3\n", "backplate_mm = 63.0\n", "contact_deg = 30.0\n"] {
        assert!(answers.contains(line), "{line}: {answers}");
    }
}

#[test]
fn back_repeats_no_motion_that_nobody_has_asked_for() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let known =
        ["--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--driver", "grbl", "--port"];
    let place = [&port[..], "--axis", "X", "--altitude", "500m", "--rate", "0.2mL/s", "--configure"];
    let words = [&known[..], &place].concat();
    let answers = [
        ("Bore", ""),
        ("Gear", ""),
        ("Height of the pump", ""),
        ("Height of the vessel", ""),
        ("End of the outlet", ""),
        ("Inner diameter", ""),
        ("Is this right?", ""),
        ("May the motor move?", "quit"),
    ];
    sets_up(&desk, &words, &answers);
    // A pump whose direction nobody has seen yet moves by its setup alone.
    let dose = desk.types(&["1mL", "--pump", "acid"]);
    assert_eq!(dose.code, 2, "{}", dose.err);
    assert!(dose.err.contains("`dose setup acid` goes on with its setup, which was left"), "{}", dose.err);
    let revolution = [
        ("May the motor move?", "back"),
        ("Is this right?", ""),
        ("May the motor move?", "yes"),
        ("Did the line come back", "400"),
        ("Steps per revolution of the motor from now on", "back"),
        ("Did the line come back", "yes"),
        ("Did the rotor push", "back"),
        ("Did the line come back", "yes"),
        ("Did the rotor push", "yes"),
        ("Volume that fills both hoses", "back"),
        ("May the motor move?", "quit"),
    ];
    sets_up(&desk, &[], &revolution);
    let turned = pump.board.rest().steps;
    assert_eq!(turned, 3200, "one revolution was agreed to");
    let line = [
        ("May the motor move?", "yes"),
        ("Did the rotor push", "yes"),
        ("Volume that fills both hoses", "1mL"),
        ("Is the line full", "back"),
        ("Volume that fills both hoses (0: they are full) [0mL]", ""),
        ("Volume of the dose", "back"),
        ("Is the line full", ""),
        ("Volume of the dose", "1mL"),
        ("Put a vessel", "back"),
        ("Volume of the dose [1mL]", "2mL"),
        ("Put a vessel", ""),
        ("Reading", "back"),
        ("Reading", "2.00g"),
    ];
    let ended = sets_up(&desk, &[], &line);
    assert!(ended.err.contains("no way leads back over it"), "{}", ended.err);
    // A second revolution, 1 mL into the line and 2 mL into the vessel.
    assert_eq!(pump.board.rest().steps, 2 * 3200 + 6 * 3200);
}
