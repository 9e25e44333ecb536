//! The questions about the motor: its steps per revolution of the pump head.

use pump_bench::catalogue::{unusual_full_steps, unusual_microsteps};
use pump_bench::setup::{Answers, Topic, USUAL_FULL_STEPS};
use pump_bench::units::{FULL_STEPS_PER_REV, MICROSTEPS, count};

use super::asker::{Asked, Question};
use super::course::{Course, heading, tell_person};

/// Asks for the steps of the motor, unless a file knows them.
pub(super) fn ask(course: &mut Course) -> Asked<()> {
    let is_known = course.answers.has_steps() && course.answers.gear.is_some();
    if is_known || course.answers.is_of_file() && !is_unconfirmed(course)? {
        return Ok(());
    }
    heading("The motor");
    if !course.answers.has_steps() {
        if course.answers.full_steps.is_none() {
            ask_full_steps(course)?;
        }
        ask_microsteps(course)?;
    }
    if course.answers.gear.is_none() {
        ask_gear(course)?;
    }
    if let Some(motor) = course.answers.motor() {
        tell_person(&format!("  {motor}"));
    }
    Ok(())
}

/// True if a file describes the pump and nobody has said its motor's steps.
fn is_unconfirmed(course: &Course) -> Asked<bool> {
    Ok(course.pump_file()?.0.motor.confirmed == Some(false))
}

fn ask_full_steps(course: &mut Course) -> Asked<()> {
    let usual = USUAL_FULL_STEPS.to_string();
    let question = Question {
        text: "Full steps per revolution of the motor",
        option: "--full-steps 200, or --steps-per-rev 3200",
        usual: course.suggested(|last| last.full_steps.map(|steps| steps.to_string()), Some(&usual)),
        help: "360 over the angle on the motor's label: 1.8 deg is 200, 0.9 deg is 400",
    };
    let suggested = question.usual.as_ref().map(|usual| usual.answer.clone());
    let mut doubted = None;
    // An unusual number is taken once it is said again, and as a suggestion that somebody has said before.
    let read = |answer: &str| {
        let steps = count("number of full steps per revolution", FULL_STEPS_PER_REV)(answer);
        let steps = steps.map_err(|error| error.to_string())?;
        match unusual_full_steps(steps) {
            Some(why) if doubted != Some(steps) && suggested.as_deref() != Some(answer) => {
                doubted = Some(steps);
                Err(format!("{why}; write {steps} again if the motor has them"))
            }
            _ => Ok(steps),
        }
    };
    course.settle(Topic::FullSteps, &question, read, |answers, steps| answers.full_steps = Some(steps))
}

fn ask_microsteps(course: &mut Course) -> Asked<()> {
    let full_steps = course.answers.full_steps.unwrap_or(USUAL_FULL_STEPS);
    // Steps of a revolution that are no multiple are those of another motor.
    let of_steps = |steps: u32| steps.is_multiple_of(full_steps).then(|| steps / full_steps);
    let microsteps = |last: &Answers| last.microsteps.or_else(|| of_steps(last.steps_per_rev?));
    let question = Question {
        text: "Microsteps per full step",
        option: "--microsteps 16",
        usual: course.suggested(|last| microsteps(last).map(|steps| steps.to_string()), None),
        help: "the switches or jumpers of the stepper driver set them, as 16; if you are not sure say 16: the first \
               revolution shows it. A Klipper board sets those of a TMC2209 itself: 1, 2, 4, 8, 16, 32, 64, 128 or 256",
    };
    let suggested = question.usual.as_ref().map(|usual| usual.answer.clone());
    let mut doubted = None;
    // Unusual microsteps are taken once they are said again, and as a suggestion that somebody has said before.
    let read = |answer: &str| {
        let steps = count("number of microsteps", MICROSTEPS)(answer).map_err(|error| error.to_string())?;
        match unusual_microsteps(steps) {
            Some(why) if doubted != Some(steps) && suggested.as_deref() != Some(answer) => {
                doubted = Some(steps);
                Err(format!("{why}; write {steps} again if yours has them"))
            }
            _ => Ok(steps),
        }
    };
    course.settle(Topic::Microsteps, &question, read, |answers, steps| answers.microsteps = Some(steps))
}

fn ask_gear(course: &mut Course) -> Asked<()> {
    let question = Question {
        text: "Gear: revolutions of the motor per revolution of the head",
        option: "--gear 1",
        usual: course.suggested(|last| last.gear.map(|gear| gear.to_string()), Some("1")),
        help: "1 without a gearbox; a gearbox 1:5 is 5",
    };
    let read = |answer: &str| match answer.parse::<f64>() {
        Ok(gear) if gear > 0.0 && gear.is_finite() => Ok(gear),
        _ => Err(format!("`{answer}` is no gear; write a number, as 5")),
    };
    course.settle(Topic::Gear, &question, read, |answers, gear| answers.gear = Some(gear))
}
