//! Somebody who leaves at every question, and comes back.

use std::process::Command;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use crate::person::{Desk, Ended, by_part};
use crate::truth::TruePump;

/// Answers to everything on a simulated motor.
const ANSWERS: [(&str, &str); 8] = [
    ("Name", "acid"),
    ("Head:", "0.5mL"),
    ("Rollers", "4"),
    ("Microsteps", "16"),
    ("Driver", "sim"),
    ("Altitude", "500m"),
    ("Volume of the dose", "5mL"),
    ("Reading", "4.93g"),
];

#[test]
fn answers_survive_that_the_person_leaves_at_every_question() {
    let desk = Desk::new();
    let mut answered: Vec<String> = Vec::new();
    for call in 0..40 {
        // Each time one question more is answered, and then the input ends.
        let mut count = 0;
        let mut react = by_part(&ANSWERS);
        let ended = desk.answers(&["setup", "acid"], &mut |question| {
            count += 1;
            if count == 1 { react(question) } else { None }
        });
        if ended.code == 0 {
            assert!(call > 10, "{call} calls: {}", ended.err);
            assert!(ended.out.contains("a dose of 5 mL lies between"), "{}", ended.out);
            assert_eq!(desk.configured("setup/acid.toml").unwrap().matches("weighed = 1").count(), 1);
            return;
        }
        assert!(ended.err.contains("; say --") || ended.err.contains("say a name"), "{}", ended.err);
        assert!(ended.err.contains("`dose setup acid` goes on"), "{}", ended.err);
        assert!(!ended.err.contains("panicked"), "{}", ended.err);
        // The pump has no file yet, or one that nobody has tried.
        let status = desk.types(&["status", "--pump", "acid"]);
        let left = "`dose setup acid` goes on with its setup, which was left";
        assert!([status.out, status.err].concat().contains(left), "call {call}");
        // Questions that decide the pump file are asked once.
        let first = ended.asked[0].clone();
        assert!(!answered.contains(&first) || is_repeated(&first), "{first} again: {answered:?}");
        answered.push(first);
    }
    panic!("no end: {answered:?}");
}

/// True for a question whose answer is no fact: it is asked whenever the run comes to it.
fn is_repeated(question: &str) -> bool {
    ["Is this right", "Is the line full", "Put a vessel"].iter().any(|start| question.starts_with(start))
}

#[test]
fn quit_leaves_without_an_error_and_continue_finds_the_run_that_was_left() {
    let desk = Desk::new();
    let mut react = by_part(&ANSWERS);
    let left = desk.answers(&["setup", "acid"], &mut |question| {
        if question.starts_with("Driver") { Some("quit".to_owned()) } else { react(question) }
    });
    assert_eq!(left.code, 0, "{}", left.err);
    assert!(left.err.contains("The answers are on record; `dose setup acid` goes on"), "{}", left.err);
    assert_eq!(desk.configured("pumps/acid.toml"), None);
    let ended = desk.answers(&["setup", "--continue"], &mut by_part(&ANSWERS));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(!ended.err.contains("Rollers, counted"), "{}", ended.err);
    let none = desk.types(&["setup", "--continue"]);
    assert!(none.code == 2 && none.err.contains("nothing to go on with"), "{}", none.err);
}

#[test]
fn a_second_weighing_joins_the_first() {
    let desk = Desk::new();
    assert_eq!(desk.answers(&["setup", "acid"], &mut by_part(&ANSWERS)).code, 0);
    let again = desk.answers(&["setup", "acid"], &mut by_part(&ANSWERS));
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(again.err.contains("This pump is set up. Weigh one more dose?"), "{}", again.err);
    assert!(again.out.contains("2 runs at"), "{}", again.out);
}

/// Makes the course on a board, and sends `signal` to the command while the weighed dose runs.
fn stopped_in_the_dose(desk: &Desk, pump: &TruePump, signal: &str) -> Ended {
    let port = pump.port();
    let words = [
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
        "--port",
        &port,
        "--axis",
        "X",
        "--altitude",
        "500m",
        "--prime",
        "0",
        "--volume",
        "10mL",
        "--turned",
        "1",
        "--direction",
        "forward",
    ];
    thread::scope(|scope| {
        desk.answers(&words, &mut |question| {
            if question.starts_with("Put a vessel") {
                // The dose is 64000 steps long.
                let from = pump.board.rest().steps;
                scope.spawn(move || {
                    let until = Instant::now() + Duration::from_secs(60);
                    while pump.board.truth().steps - from < 8000 {
                        if Instant::now() > until {
                            // The dose ended before, as its code says.
                            return;
                        }
                        thread::sleep(Duration::from_millis(2));
                    }
                    let process = desk.process.load(Ordering::SeqCst).to_string();
                    assert!(Command::new("kill").args([signal, &process]).status().unwrap().success());
                });
            }
            Some(if question.starts_with("May the motor") { "yes".to_owned() } else { String::new() })
        })
    })
}

/// Pause of a board's thread from which on the drive may take the board for silent: it gives up after 2 s.
const STARVED: Duration = Duration::from_secs(1);

/// Stops or cuts a dose off, and makes it again. Returns false if the machine was so busy that the board was silent.
fn is_made_again(signal: &str, code: i32) -> bool {
    let desk = Desk::new();
    let mut pump = TruePump::left_alone(0.54, 3200.0, (0.3, 60.0), 0.9);
    let stopped = stopped_in_the_dose(&desk, &pump, signal);
    if pump.board.truth().longest_pause > STARVED {
        return false;
    }
    assert_eq!(stopped.code, code, "{signal}: {}{}", stopped.out, stopped.err);
    let steps = pump.board.rest().steps;
    assert!((8000..60_000).contains(&(steps - 3200)), "{signal}: {steps}");
    let journal = desk.journal("acid", "grbl").unwrap();
    // A script does not leave the rest by the way.
    let file = desk.configured("pumps/acid.toml");
    for again in [&["--again"][..], &[], &["--axis", "Y"]] {
        let refused = desk.types(&[&["setup", "acid", "--yes"][..], again].concat());
        let is_told =
            refused.err.contains("is unfinished") && refused.err.contains("`dose resume --pump acid`");
        assert!(refused.code == 4 && is_told, "{}: {}", refused.code, refused.err);
        assert_eq!(desk.journal("acid", "grbl").unwrap(), journal);
        assert_eq!(desk.configured("pumps/acid.toml"), file);
    }
    // A person who quits there has changed nothing either.
    let answers = desk.configured("setup/acid.toml");
    let left = desk.answers(&["setup", "acid", "--axis", "Y"], &mut |_| Some("quit".to_owned()));
    assert!(left.code == 0 && left.asked[0].starts_with("Is the rest to be left"), "{:?}", left.asked);
    assert_eq!([desk.configured("setup/acid.toml"), desk.configured("pumps/acid.toml")], [answers, file]);
    assert_eq!(desk.journal("acid", "grbl").unwrap(), journal);
    let ended = desk.answers(&["setup", "acid"], &mut |question| {
        Some(match question {
            q if q.starts_with("Is the rest to be left") => "yes".to_owned(),
            q if q.starts_with("Put a vessel") => {
                pump.tare();
                String::new()
            }
            q if q.starts_with("Reading") => pump.reading(),
            _ => String::new(),
        })
    });
    if pump.board.truth().longest_pause > STARVED {
        return false;
    }
    assert_eq!(ended.code, 0, "{signal}: {}", ended.err);
    assert!(ended.asked[0].starts_with("Is the rest to be left"), "{:?}", ended.asked);
    assert!(!ended.err.contains("One revolution"), "{}", ended.err);
    let after = desk.journal("acid", "grbl").unwrap();
    assert!(after.starts_with(&journal) && after.len() > journal.len(), "the record goes on");
    // The dose that was weighed is the whole one.
    assert!((pump.turns() - 20.0).abs() < 1e-9, "{signal}: {}", pump.turns());
    assert!(ended.out.contains("1 run at"), "{}", ended.out);
    true
}

#[test]
fn a_dose_that_was_stopped_or_cut_off_is_on_record_and_made_again() {
    for (signal, code) in [("-INT", 130), ("-KILL", -1)] {
        assert!(
            (0..4).any(|_| is_made_again(signal, code)),
            "{signal}: this machine is too busy for the board"
        );
    }
}

/// Answers with a word for a part of the summary, once, and something else for one question of that part.
fn correcting<'a>(
    word: &'a str,
    question: &'a str,
    answer: &'a str,
) -> impl FnMut(&str) -> Option<String> + 'a {
    let mut react = by_part(&ANSWERS);
    let (mut said, mut seen) = (false, 0);
    move |asked| {
        if asked.starts_with("Is this right") && !said {
            said = true;
            return Some(word.to_owned());
        }
        if asked.starts_with(question) && said {
            seen += 1;
            return (seen == 1).then(|| answer.to_owned());
        }
        // Enter keeps every other answer of the part.
        if said && asked.contains('[') { Some(String::new()) } else { react(asked) }
    }
}

#[test]
fn a_corrected_line_keeps_the_answers_beside_it() {
    let desk = Desk::new();
    let motor = desk.answers(&["setup", "acid", "--no-motion"], &mut correcting("motor", "Microsteps", "8"));
    assert_eq!(motor.code, 0, "{}", motor.err);
    assert!(
        motor.err.contains("Gear: revolutions of the motor per revolution of the head [1]"),
        "{}",
        motor.err
    );
    assert!(motor.err.contains("Microsteps per full step [16]"), "{}", motor.err);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("steps_per_rev = 1600"));

    let desk = Desk::new();
    let head = desk.answers(&["setup", "acid", "--no-motion"], &mut correcting("head", "Head:", "5mL"));
    assert_eq!(head.code, 0, "{}", head.err);
    assert!(head.err.contains("Rollers, counted [4]"), "{}", head.err);
    // The usual rate is that of the head: ten times the volume of a revolution, ten times the rate.
    assert!(head.err.contains("Rate of a dose that names none [2.1mL/s]"), "{}", head.err);
}

#[test]
fn a_correction_that_is_left_changes_nothing() {
    let desk = Desk::new();
    let mut react = correcting("place", "Altitude", "1000m");
    let mut heights = 0;
    let left = desk.answers(&["setup", "acid"], &mut |question| {
        heights += usize::from(question.starts_with("Height of the vessel"));
        if heights == 2 { Some("quit".to_owned()) } else { react(question) }
    });
    assert_eq!(left.code, 0, "{}", left.err);
    assert!(left.err.contains("The answers before the correction are on record"), "{}", left.err);
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut by_part(&ANSWERS));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert_eq!(ended.asked.len(), 1, "{:?}", ended.asked);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("altitude_m = 500"));
}

#[test]
fn a_filling_that_was_stopped_is_asked_for_again_with_the_rest() {
    let desk = Desk::new();
    let pump = TruePump::left_alone(0.5, 3200.0, (0.23, 50.0), 0.2);
    let port = pump.port();
    let head = ["--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--altitude", "500m"];
    let board =
        ["--driver", "grbl", "--port", &port, "--axis", "X", "--turned", "1", "--direction", "forward"];
    let words = [&["setup", "acid"][..], &head, &board].concat();
    let stopped = thread::scope(|scope| {
        desk.answers(&words, &mut |question| {
            if question.starts_with("Volume that fills") {
                let (desk, pump, from) = (&desk, &pump, pump.board.rest().steps);
                scope.spawn(move || {
                    // 10 mL are 64000 steps.
                    while pump.board.truth().steps - from < 6400 {
                        thread::sleep(Duration::from_millis(2));
                    }
                    let process = desk.process.load(Ordering::SeqCst).to_string();
                    assert!(Command::new("kill").args(["-INT", &process]).status().unwrap().success());
                });
                return Some("10mL".to_owned());
            }
            Some(if question.starts_with("May the motor") { "yes".to_owned() } else { String::new() })
        })
    });
    assert_eq!(stopped.code, 130, "{}{}", stopped.out, stopped.err);
    let steps = pump.board.rest().steps;
    let status = desk.types(&["status", "--pump", "acid"]).out;
    assert!(
        status.contains("unfinished: a prime of 10 mL, of which") && status.contains("by the model"),
        "{status}"
    );
    assert!(!status.contains("motor's steps"), "{status}");
    let mut suggested = String::new();
    let ended = desk.answers(&["setup", "acid"], &mut |question| {
        if question.starts_with("Volume that fills") {
            suggested = question.to_owned();
            return None;
        }
        Some(if question.starts_with("Is the rest to be left") { "yes" } else { "" }.to_owned())
    });
    assert!(ended.code == 2 && ended.err.contains("--prime"), "{}", ended.err);
    let rest = suggested.split(['[', ']']).nth(1).and_then(|rest| rest.strip_suffix("mL")).unwrap();
    let rest_ml: f64 = rest.parse().unwrap();
    let pumped_ml = (steps - 3200) as f64 / 3200.0 * 0.5;
    assert!((rest_ml - (10.0 - pumped_ml)).abs() < 0.3, "{suggested}: {pumped_ml} mL were pumped");
    assert_eq!(pump.board.rest().steps, steps, "nothing moves before the volume is said");
}

#[test]
fn a_motion_that_takes_long_is_asked_for_and_one_beyond_an_hour_is_a_slip() {
    let desk = Desk::new();
    let moved = |desk: &Desk| desk.journal("acid", "sim").unwrap().matches("\"purpose\":\"prime\"").count();
    let mut react = by_part(&ANSWERS);
    let no = desk.answers(&["setup", "acid"], &mut |question| match question {
        q if q.starts_with("Volume that fills") => Some("100mL".to_owned()),
        q if q.starts_with("That is long for a line") => Some("no".to_owned()),
        q => react(q),
    });
    assert_eq!(no.code, 0, "{}", no.err);
    assert!(no.err.contains("A real pump would take 476 s."), "{}", no.err);
    assert_eq!(moved(&desk), 0);
    let refused = desk.types(&["setup", "acid", "--prime", "5L", "--yes"]);
    assert!(refused.code == 2 && refused.err.contains("5000 mL take longer than an hour"), "{}", refused.err);
    assert_eq!(moved(&desk), 0);
    let (mut fills, mut doses) = (["1mL"].iter(), ["5L", "5mL"].iter());
    let ended = desk.answers(&["setup", "acid"], &mut |question| match question {
        q if q.starts_with("Volume that fills") => fills.next().map(ToString::to_string),
        q if q.starts_with("Volume of the dose") => doses.next().map(ToString::to_string),
        q => react(q),
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("5000 mL take longer than an hour at the usual rate"), "{}", ended.err);
    // The time is known before the word that begins it.
    let vessel = ended.err.find("Put a vessel").unwrap();
    assert!(ended.err[..vessel].ends_with("A real pump would take 24 s.\n"), "{}", ended.err);
    let silent = desk.types(&["setup", "acid", "--again", "--volume", "5L", "--yes"]);
    assert!(silent.code == 2 && silent.err.contains("say --volume 5mL"), "{}", silent.err);
}

#[test]
fn a_pump_that_was_removed_before_its_setup_ended_can_be_set_up_again() {
    let desk = Desk::new();
    let mut react = by_part(&ANSWERS);
    // The pump has moved, and no dose was weighed.
    let left = desk.answers(&["setup", "acid"], &mut |question| {
        if question.starts_with("Volume of the dose") { Some("quit".to_owned()) } else { react(question) }
    });
    assert_eq!(left.code, 0, "{}", left.err);
    let removed = desk.types(&["pumps", "remove", "acid", "--anyway"]);
    assert_eq!(removed.code, 0, "{}", removed.err);
    assert!(removed.out.contains("`dose setup acid` writes the pump file again"), "{}", removed.out);
    assert_eq!(desk.configured("pumps/acid.toml"), None);
    let again = desk.types(&["setup", "acid", "--anew", "--no-motion"]);
    assert!(again.code == 2 && again.err.contains("no answer to \"Head"), "{}", again.err);
    let again = desk.answers(&["setup", "acid", "--no-motion"], &mut by_part(&ANSWERS));
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(desk.configured("pumps/acid.toml").is_some());
}
