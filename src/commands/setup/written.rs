//! The summary of the answers, and the pump file that they make.

use pump_bench::catalogue::unusual;
use pump_bench::pump_file::{DriveTable, DriverName, OutletEnd, PumpFile, Reservoir};
use pump_bench::setup::Topic;

use super::asker::{Asked, Question, Stop, Usual};
use super::course::{Course, head_in_words, heading, rounded, rounded_to, tell_person};
use super::{back, board, head, motor, place};
use crate::failure::Failure;

/// Words that change a part of the answers.
const PARTS: &str = "head, motor, board, place or rate";

/// Answer to the question whether the answers are right.
enum Verdict {
    Right,
    Correct(&'static [Topic]),
}

/// Asks every question that has no answer yet, and writes the pump file once the answers are right.
pub(super) fn write(course: &mut Course) -> Asked<()> {
    loop {
        match write_answered(course) {
            Err(Stop::Back) => back::to_question_before(course)?,
            written => return written,
        }
    }
}

fn write_answered(course: &mut Course) -> Asked<()> {
    loop {
        head::ask(course)?;
        motor::ask(course)?;
        board::ask(course)?;
        place::ask(course)?;
        course.at = None;
        course.answers.check()?;
        let (file, text) = course.pump_file()?;
        course.end_correction()?;
        if is_written(course, &text) && !std::mem::take(&mut course.reviews) {
            return Ok(());
        }
        heading(&format!("The pump `{}`", course.answers.name));
        summary(course, &file)?.iter().for_each(|line| tell_person(line));
        unusual(&file).iter().for_each(|warning| tell_person(&format!("  warning: {warning}")));
        let question = Question {
            text: "Is this right? Enter writes the pump file; the word of a line changes it",
            option: "--yes",
            usual: Some(Usual::new("yes")),
            help: "the word of a line asks that part again: head, motor, board, place or rate",
        };
        match course.asker.ask(&question, verdict)? {
            Verdict::Right => return put(course, &text),
            Verdict::Correct(part) => course.correct(part),
        }
    }
}

/// Writes the file anew after an answer changed, without a question.
pub(super) fn rewrite(course: &mut Course) -> Asked<()> {
    let (_, text) = course.pump_file()?;
    course.at = None;
    put(course, &text)
}

/// True if the file on the disk is the one of these answers.
fn is_written(course: &Course, text: &str) -> bool {
    course.folder.has_pump(&course.answers, text)
}

fn put(course: &mut Course, text: &str) -> Result<(), Stop> {
    let is_new = !is_written(course, text);
    let path = course.folder.write_pump(&mut course.answers, text)?;
    if is_new {
        tell_person(&format!("  {} is written", path.display()));
        tell_reset(course);
    }
    Ok(())
}

/// Says which pumps lose their current once the first motion of a new one has its Klipper board configured anew.
fn tell_reset(course: &Course) {
    let (Some(DriverName::Klipper), Some(port)) = (course.answers.driver, &course.answers.port) else {
        return;
    };
    let others = course.others_at(port);
    let names: Vec<_> = others.iter().map(|other| format!("`{}`", other.name)).collect();
    if names.is_empty() || course.board_on_record().is_some() {
        return;
    }
    tell_person(&format!(
        "  The first motion of `{}` resets the board, so that it knows its pins: the motors of {} are without current \
         meanwhile, and the angle of their rollers is known less well.",
        course.answers.name,
        names.join(" and ")
    ));
}

fn verdict(answer: &str) -> Result<Verdict, String> {
    Ok(match answer {
        "y" | "yes" => Verdict::Right,
        // The usual rate is that of a head.
        "head" | "rollers" => Verdict::Correct(&[Topic::Head, Topic::Bore, Topic::Rollers, Topic::Rate]),
        "motor" => Verdict::Correct(&[Topic::FullSteps, Topic::Microsteps, Topic::Gear]),
        "board" => {
            const BOARD: [Topic; 6] =
                [Topic::Driver, Topic::Port, Topic::Axis, Topic::Socket, Topic::Current, Topic::HoldCurrent];
            Verdict::Correct(const { &BOARD })
        }
        "place" => Verdict::Correct(&[
            Topic::Ambient,
            Topic::SuctionLift,
            Topic::DischargeLift,
            Topic::OutletEnd,
            Topic::Nozzle,
        ]),
        "rate" => Verdict::Correct(&[Topic::Rate]),
        other => return Err(format!("`{other}` is none of yes, {PARTS}")),
    })
}

/// The answers, a line for each part.
fn summary(course: &Course, file: &PumpFile) -> Result<Vec<String>, Failure> {
    let answers = &course.answers;
    let model = file.model().map_err(Failure::of)?;
    let mut lines = Vec::new();
    let mut line = |name: &str, words: &str| lines.push(format!("  {name:<8}{words}"));
    let head = answers.head.as_ref().map(head_in_words).unwrap_or_default();
    let known = if head.contains("per revolution") {
        String::new()
    } else {
        format!(", {} mL per revolution", rounded(model.revolution_ml()))
    };
    let bore = file.head.as_ref().and_then(|head| head.tube_bore_mm);
    let bore = bore.map_or(String::new(), |mm| format!(", bore of {mm} mm"));
    line("head", &format!("{head}{known}, {} rollers{bore}", file.rollers.count));
    let steps = answers.motor().map_or_else(
        || {
            format!(
                "{} steps per revolution of the motor, gear {}",
                file.motor.steps_per_rev, file.motor.gear
            )
        },
        |motor| motor.to_string(),
    );
    line("motor", &steps);
    line("board", &board_in_words(course, file));
    usual_pins(file).into_iter().for_each(|pins| line("pins", pins));
    let lift = |reservoir: Reservoir, what: &str, place: &str, side: &str| match reservoir {
        Reservoir::Lift(0.0) => String::new(),
        Reservoir::Lift(mm) if mm < 0.0 => format!(", {place} {} m {side} the pump", rounded(-1e-3 * mm)),
        Reservoir::Lift(mm) => format!(", {what} {} m", rounded(1e-3 * mm)),
        Reservoir::Pressure(kpa) => format!(", {place} at {kpa} kPa absolute"),
    };
    let (inlet, outlet) = (file.inlet.reservoir, file.outlet.line.reservoir);
    let lifts =
        format!("{}{}", lift(inlet, "sucks up", "supply", "above"), lift(outlet, "lifts", "vessel", "below"));
    let end = match (file.outlet.end, file.outlet.nozzle_bore_mm) {
        (Some(OutletEnd::Immersed), _) => ", outlet immersed".to_owned(),
        (_, Some(mm)) => format!(", outlet of {mm} mm in air"),
        (_, None) => ", outlet in air".to_owned(),
    };
    line("place", &format!("air of {:.1} kPa{lifts}{end}", file.ambient.pressure_kpa));
    let rate_ml_s = file.pump.default_rate_ml_s;
    let speed_rpm = 60.0 * rate_ml_s / model.revolution_ml();
    line("rate", &format!("{rate_ml_s} mL/s, {} r/min of the head", rounded_to(speed_rpm, 3)));
    Ok(lines)
}

/// The pins of a node's stepper driver, if the file leaves them out.
fn usual_pins(file: &PumpFile) -> Option<&'static str> {
    let is_unsaid = |drive: &&DriveTable| drive.driver == DriverName::Node && drive.pins.is_none();
    file.drive.as_ref().filter(is_unsaid).map(|_| {
        "those of a DRV8825, without its fault output; docs/node.md says what the pump file names for a TMC2209 or \
         another stepper driver"
    })
}

/// The board, its port, and the axis or the socket of the motor.
fn board_in_words(course: &Course, file: &PumpFile) -> String {
    let Some(drive) = file.drive.as_ref().filter(|drive| drive.driver != DriverName::Sim) else {
        return "sim: no motor moves".to_owned();
    };
    let port = drive.port.as_ref().map_or_else(|| "no port".to_owned(), |port| port.display().to_string());
    let place = match (&course.answers.socket, &drive.klipper) {
        (Some(socket), Some(pins)) => {
            let current = pins.tmc.as_ref().map_or_else(String::new, |tmc| match tmc.hold_a {
                Some(hold_a) => format!(", {} A, {hold_a} A at rest", tmc.run_a),
                None => format!(", {} A", tmc.run_a),
            });
            format!("socket {socket}{current}")
        }
        (None, Some(pins)) => format!("steps at {}", pins.step),
        (_, None) => {
            let number = match &course.board {
                Some(board) => board.number(),
                None => course.board_on_record().and_then(|board| board.number),
            };
            let number = number.map_or_else(String::new, |number| format!(", board {number:016x}"));
            format!("axis {}{number}", drive.axis)
        }
    };
    format!("{} at {port}, {place}", drive.driver)
}
