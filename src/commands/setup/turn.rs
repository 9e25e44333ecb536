//! One revolution that a person watches: it shows the motor's steps and the way in which the pump turns.

mod known_microsteps;

use std::ops::ControlFlow;

use pump_bench::drives::{DriveError, NodeError};
use pump_bench::notice::{Notice, Remedy};
use pump_bench::pump_file::DriverName;
use pump_bench::report::{Explain, with_sources};
use pump_bench::setup::Answers;
use pump_bench::units::{STEPS_PER_REV, count};
use pump_bench::{Bench, DoseError};
use pump_model::units::rad_s;

use super::asker::{Asked, Question, Stop, Usual, yes_or_no};
use super::board;
use super::course::{Course, heading, rounded, tell_person};
use super::options::turns;
use super::place;
use super::written::rewrite;
use crate::advice;
use crate::failure::Failure;
use crate::terminal::{announced, noted};

/// Speed of the revolution, r/min: slow enough to follow with the eyes.
const WATCHED_RPM: f64 = 10.0;

/// Remedies that write the board's settings.
const CONFIGURES: [Remedy; 2] = [Remedy::Configure, Remedy::ConfigureOrRaise];

/// Turns the pump until its steps and its direction are those of the motor.
pub(super) fn watch(course: &mut Course, turned: &mut Option<f64>) -> Asked<()> {
    if course.answers.done.turned && course.answers.done.directed {
        return Ok(());
    }
    heading("One revolution");
    if course.is_simulated() {
        tell_person("  SIMULATED: no motor moves, so the mark comes back");
        turn(course)?;
        return Ok(seen(course, |answers| (answers.done.turned, answers.done.directed) = (true, true))?);
    }
    refuse_unseen(course, *turned)?;
    meet_board(course)?;
    may_move(course)?;
    let mut wrong = 0;
    while !(course.answers.done.turned && course.answers.done.directed) {
        turn(course)?;
        see(course, turned, &mut wrong)?;
    }
    Ok(())
}

/// Asks what the revolution has shown, until it is clear whether another one is to follow.
fn see(course: &mut Course, turned: &mut Option<f64>, wrong: &mut u32) -> Asked<()> {
    loop {
        if !course.answers.done.turned {
            see_turn(course, turned, wrong)?;
        }
        if !course.answers.done.turned || course.answers.done.directed {
            return Ok(());
        }
        match see_direction(course) {
            Err(Stop::Back) => seen(course, |answers| answers.done.turned = false)?,
            seen => return seen,
        }
    }
}

/// Forgets which way the pump turned: the next revolution shows it, and begins when a person says so.
pub(super) fn forget_direction(course: &mut Course) -> Result<(), Failure> {
    seen(course, |answers| answers.done.directed = false)
}

/// Refuses to turn a real motor while nobody can say what it did.
fn refuse_unseen(course: &Course, turned: Option<f64>) -> Result<(), Failure> {
    if !course.asker.is_silent() {
        return Ok(());
    }
    let missing = |what: &str, option: &str| {
        Err(Failure::refused(format!("nobody is asked, and {what} is not known; say {option}"))
            .allowed(option))
    };
    if !course.answers.done.turned && turned.is_none() {
        return missing("how far the head turns for one revolution", "--turned 1");
    }
    if !course.answers.done.directed && course.answers.invert.is_none() {
        return missing("which way it turns", "--direction forward");
    }
    Ok(())
}

/// Connects the board, which moves nothing, and offers to write the settings that do not fit the pump.
fn meet_board(course: &mut Course) -> Asked<()> {
    loop {
        let bench = course.bench()?;
        let mut session = bench.session()?;
        let connected = session.connect();
        let notes = session.notes();
        let range_rad_s = session.speed_range_rad_s();
        drop(session);
        let fixes = |remedies: &[Remedy]| remedies.iter().any(|remedy| CONFIGURES.contains(remedy));
        let offers = course.answers.configure.is_none();
        let error = match connected {
            Ok(()) if offers && notes.iter().any(|note| fixes(note.remedies())) => None,
            Ok(()) => {
                course.warn(&notes);
                if rate_fits(course, range_rad_s)? {
                    tell_person(board_fits(course.answers.driver));
                    return Ok(());
                }
                continue;
            }
            Err(error) if fixes(&error.remedies()) && course.answers.configure != Some(true) => Some(error),
            Err(error) if is_without_current(&error) && !course.asker.is_silent() => {
                wait_for_current(course, &error)?;
                continue;
            }
            Err(error) if is_of_other_board(&error) && !course.asker.is_silent() => {
                take_board(course, &error)?;
                continue;
            }
            Err(error) => {
                let told = error.told(course.runnable.words());
                board_is_away(course, Failure::from(error).saying(told))?;
                continue;
            }
        };
        let words = match &error {
            Some(error) => with_sources(error),
            None => notes.iter().map(Notice::text).collect::<Vec<_>>().join("; "),
        };
        tell_person(&format!("  {words}"));
        if course.asker.is_silent() {
            let Some(error) = error else {
                course.warn(&notes);
                return rate_fits(course, range_rad_s).map(drop);
            };
            return Err(Failure::from(error).into());
        }
        let question = Question {
            text: "May the board's settings be written, so that they fit the pump?",
            option: "--configure",
            usual: Some(Usual::new("yes")),
            help: "the settings that change are said, each with its value before; docs/motor.md lists them",
        };
        let agreed = course.asker.agrees(&question)?;
        let mut answers = course.answers.clone();
        answers.configure = Some(agreed);
        course.take(answers)?;
        if let (Some(error), false) = (error, agreed) {
            return Err(Failure::from(error).into());
        }
    }
}

fn board_fits(driver: Option<DriverName>) -> &'static str {
    match driver {
        Some(DriverName::Node | DriverName::Klipper) => "  the board answers, and makes what the pump needs",
        _ => "  the board answers, and its settings fit the pump",
    }
}

/// True if the board answers, and gives the motor no current.
fn is_without_current(error: &DoseError) -> bool {
    let DoseError::Connection(DriveError::Device(source)) = error else { return false };
    matches!(source.downcast_ref(), Some(NodeError::Estop | NodeError::Driver))
}

/// True if the record of the pump is of another board, or of the same one with other settings.
fn is_of_other_board(error: &DoseError) -> bool {
    let takes = [Remedy::AcceptBoard, Remedy::AcceptSettings, Remedy::ResetBoard];
    error.remedies().iter().any(|remedy| takes.contains(remedy))
}

/// Asks if the board at the port turns the pump from now on. Otherwise its port is asked for anew.
fn take_board(course: &mut Course, error: &DoseError) -> Asked<()> {
    tell_person(&format!("  {}", with_sources(error)));
    let question = Question {
        text: "Does the board at this port turn the pump from now on? (yes, no)",
        option: "--no-motion",
        usual: None,
        help: "yes takes the board as it is: its count begins anew, and the rollers' angle is unknown; no asks for the \
               port of the pump's own board",
    };
    if course.asker.agrees(&question)? {
        course.accepts_board = true;
        return Ok(());
    }
    board::ask_again(course)?;
    rewrite(course)
}

/// Waits until a person has seen to an emergency stop or a fault of the stepper driver: the board is the right one.
fn wait_for_current(course: &mut Course, error: &DoseError) -> Asked<()> {
    tell_person(&format!("  the board answers, and gives the motor no current: {}", with_sources(error)));
    let question = Question {
        text: "Is the cause removed, so that the board may be asked again? (yes, quit)",
        option: "--no-motion",
        usual: None,
        help: "release the emergency stop once it is safe, then write yes; nothing moves yet; quit leaves, and the \
               answers stay on record",
    };
    if course.asker.agrees(&question)? { Ok(()) } else { Err(Stop::Left) }
}

/// Asks the port anew where no board answers. Nobody is asked by a script, and another failure is passed on.
fn board_is_away(course: &mut Course, failure: Failure) -> Asked<()> {
    if course.asker.is_silent() || !failure.is_of_drive() {
        return Err(failure.into());
    }
    tell_person(&format!("  {}", failure.message()));
    board::ask_again(course)?;
    rewrite(course)
}

/// True if the board makes the rate. Otherwise the rate is asked for anew, or refused where nobody is asked.
fn rate_fits(course: &mut Course, range_rad_s: (f64, f64)) -> Asked<bool> {
    let Err(error) = course.answers.check_board(range_rad_s) else { return Ok(true) };
    if course.asker.is_silent() {
        return Err(Failure::from(error).into());
    }
    tell_person(&format!("  {error}"));
    let mut answers = course.answers.clone();
    answers.rate_ml_s = None;
    course.take(answers)?;
    place::ask(course)?;
    rewrite(course)?;
    Ok(false)
}

/// Asks whether the motor may move: nobody else can agree.
fn may_move(course: &mut Course) -> Asked<()> {
    let revolution_ml = course.bench()?.model().revolution_ml();
    tell_person(&format!(
        "  The pump turns one revolution in {:.0} s and pumps about {} mL. Put both hoses into water, close the head, \
         and draw a line across rotor and housing.",
        60.0 / WATCHED_RPM,
        rounded(revolution_ml)
    ));
    if course.asker.is_silent() {
        return Ok(());
    }
    let question = Question {
        text: "May the motor move? (yes, quit)",
        option: "--yes",
        usual: None,
        help: "write yes, and it turns; quit leaves, and the answers stay on record",
    };
    let name = course.answers.name.clone();
    let may = course.asker.ask(&question, |answer| {
        yes_or_no(answer).ok_or_else(|| {
            format!(
                "`{answer}` is neither yes nor quit; to change an answer quit, then add its option, as `dose setup \
                 {name} --rollers 3`"
            )
        })
    })?;
    if may { Ok(()) } else { Err(Stop::Left) }
}

/// Turns the head by one revolution, as far as its steps are right.
fn turn(course: &mut Course) -> Asked<()> {
    let bench = course.bench()?;
    let mut session = bench.session()?;
    let steps = session.steps_of(std::f64::consts::TAU);
    let interrupt = course.asker.interrupt();
    let made = announced(&mut session, false, &[], |session| {
        session.jog(steps, rad_s(WATCHED_RPM), |_| interrupt.flow())
    });
    let made = noted(&mut session, made?);
    let notes = session.notes();
    course.note_motion(&session);
    course.warn(&notes);
    let made = made?;
    match course.asker.interrupt().flow() {
        ControlFlow::Break(()) if made < steps.unsigned_abs() => {
            let signal = course.asker.interrupt().signal().unwrap_or(0);
            Err(Failure::stopped(signal, true, "stopped by the user in the revolution").into())
        }
        _ => Ok(()),
    }
}

/// Asks how far the head turned, and corrects the steps. `wrong` counts the revolutions that were wrong.
fn see_turn(course: &mut Course, turned_said: &mut Option<f64>, wrong: &mut u32) -> Asked<()> {
    let question = Question {
        text: "Did the line come back to its place after one turn? If not, how far did it turn (1/4, 90deg, 2)?",
        option: "--turned 1",
        usual: turned_said
            .take()
            .map(|turned| Usual::new(turned.to_string()))
            .or_else(|| (!course.asker.is_silent()).then(|| Usual::new("yes"))),
        help: "yes if the line on the rotor meets the line on the housing again; otherwise the turns that it made, as \
               1/4 or 4, or an angle, as 90deg",
    };
    let given = question.usual.clone().filter(|usual| usual.answer != "yes");
    let read = |answer: &str| match yes_or_no(answer) {
        Some(true) => Ok(1.0),
        Some(false) => Err("how far did it turn, as 1/4, 90deg or 2?".to_owned()),
        None => turns(answer),
    };
    let turned = match given {
        Some(usual) => turns(&usual.answer).map_err(Failure::refused)?,
        None => course.asker.ask(&question, read)?,
    };
    if Answers::is_one_turn(turned) {
        return Ok(seen(course, |answers| answers.done.turned = true)?);
    }
    if known_microsteps::are_set(course)? {
        return match known_microsteps::correct(course, turned, *wrong > 0) {
            // The revolution was made, and is judged anew.
            Err(Stop::Back) => see_turn(course, turned_said, wrong),
            corrected => {
                *wrong += 1;
                corrected
            }
        };
    }
    correct_steps(course, turned, turned_said, wrong)
}

/// Asks for the steps of the motor whose revolution made so many turns.
fn correct_steps(
    course: &mut Course,
    turned: f64,
    turned_said: &mut Option<f64>,
    wrong: &mut u32,
) -> Asked<()> {
    let steps = steps_of(&course.bench()?);
    let corrected = course.answers.corrected_steps(steps, turned);
    let micro = corrected.microsteps.map_or(String::new(), |micro| format!(", that is {micro} microsteps,"));
    tell_person(&format!(
        "  It made {} turns for {steps} steps: one turn of the motor takes about {} steps{micro} and not {steps}.",
        rounded(turned),
        corrected.steps_per_rev,
    ));
    let question = Question {
        text: "Steps per revolution of the motor from now on",
        option: "--steps-per-rev",
        usual: Some(Usual::new(corrected.steps_per_rev.to_string())),
        help: "Enter accepts them; another number overrides them. The next revolution shows if they are right",
    };
    let before = course.answers.clone();
    let answers = course.asker.ask(&question, |answer| {
        let steps = count("number of steps per revolution", STEPS_PER_REV)(answer)
            .map_err(|error| error.to_string())?;
        let mut answers = before.clone();
        if steps == corrected.steps_per_rev {
            answers.correct_steps(corrected);
        } else {
            (answers.steps_per_rev, answers.full_steps, answers.microsteps) = (Some(steps), None, None);
        }
        answers.check().map_err(|error| advice::told(&error))?;
        Ok(answers)
    });
    match answers {
        // The revolution was made, and is judged anew.
        Err(Stop::Back) => see_turn(course, turned_said, wrong),
        answers => {
            course.take(answers?)?;
            rewrite(course)
        }
    }
}

fn steps_of(bench: &Bench) -> u32 {
    bench.file().motor.steps_per_rev
}

/// Asks which way the liquid went, and turns the direction round.
fn see_direction(course: &mut Course) -> Asked<()> {
    if course.asker.is_silent() {
        if course.answers.invert == Some(true) {
            tell_person("  the axis counts down as the pump runs forward, as --direction says");
        }
        return Ok(seen(course, |answers| answers.done.directed = true)?);
    }
    let question = Question {
        text: "Did the rotor push the liquid from the supply to the vessel?",
        option: "--direction forward",
        usual: Some(Usual::new("yes")),
        help: "no turns the direction round and makes one more revolution",
    };
    let forward = course.asker.agrees(&question)?;
    let mut answers = course.answers.clone();
    if forward {
        (answers.invert, answers.done.directed) = (Some(answers.invert == Some(true)), true);
        course.answers = answers;
        course.keep()?;
        return rewrite(course);
    }
    answers.invert = Some(answers.invert != Some(true));
    course.take(answers)?;
    rewrite(course)
}

/// Notes what was seen.
fn seen(course: &mut Course, note: impl Fn(&mut Answers)) -> Result<(), Failure> {
    note(&mut course.answers);
    course.keep()
}
