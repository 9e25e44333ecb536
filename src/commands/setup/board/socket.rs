//! The questions about a board with the Klipper firmware: the socket of the motor, and the motor's current.

use pump_bench::drives::FoundBoard;
use pump_bench::notice::with_sources;
use pump_bench::pump_file::DriverName;
use pump_bench::setup::{Answers, MotorSocket, PrinterBoard, Topic};
use pump_bench::units;

use super::super::asker::{Asked, Question};
use super::super::course::{Course, tell_person};
use crate::failure::Failure;

/// Pins of a motor, as a user types them.
const PINS: &str = "step=PB13,dir=PB12,enable=!PB14";

/// Current with which the pins of a socket are looked up, in A.
const TRIED_A: f64 = 0.5;

/// True if the motor's socket has to be asked for, and the board may say which one it is.
pub(super) fn is_open(course: &Course) -> bool {
    course.answers.driver == Some(DriverName::Klipper) && course.answers.socket.is_none()
}

/// Asks for the socket, and for the motor's current where the board sets it.
pub(super) fn ask(course: &mut Course) -> Asked<()> {
    no_axis(course)?;
    socket_of_another(course)?;
    socket_of_other_board(course)?;
    if course.answers.socket.is_none() {
        ask_socket(course)?;
    }
    let sets_current = course.answers.socket.as_ref().is_some_and(MotorSocket::has_driver_wire);
    if sets_current && course.answers.current_a.is_none() {
        ask_current(course)?;
        ask_hold_current(course)?;
    }
    Ok(())
}

/// Drops a socket that the board at the port cannot have: another board answered than the one that was named, or pins
/// that it lacks. A script is refused.
pub(super) fn socket_of_other_board(course: &mut Course) -> Asked<()> {
    let Some(socket) = course.answers.socket.clone() else { return Ok(()) };
    let Err(why) = fits(course.board.as_ref(), &socket) else { return Ok(()) };
    if course.asker.is_silent() {
        return Err(Failure::refused(format!("{why}; say --socket")).value(socket).into());
    }
    tell_person(&format!("  {why}"));
    let mut answers = course.answers.clone();
    answers.socket = None;
    Ok(course.take(answers)?)
}

/// Refuses a socket that the board which answered cannot have.
fn fits(board: Option<&FoundBoard>, socket: &MotorSocket) -> Result<(), String> {
    let Some(board @ FoundBoard::Klipper { chip, .. }) = board else { return Ok(()) };
    if let Some(named) =
        socket.board().filter(|named| !chip.is_empty() && !named.chips().contains(&chip.as_str()))
    {
        return Err(format!(
            "the {} comes with {}, and the board at this port has {chip}; name the board that it is, or the pins of \
             its motor, as step=PB13,dir=PB12,enable=!PB14",
            named.title,
            named.chips().join(" or ")
        ));
    }
    // Any current: the pins of the stepper driver's wire are those of the socket.
    let table = socket.table(Some(TRIED_A), None);
    board.check_pins(&table).map_err(|error| with_sources(&error))
}

/// Drops an axis, which this board has not: its pins say which motor turns. A script is refused.
fn no_axis(course: &mut Course) -> Asked<()> {
    let Some(axis) = course.answers.axis else { return Ok(()) };
    let why = "a Klipper board has no axes: the socket says which motor turns";
    if course.asker.is_silent() {
        let refused = format!("{why}; leave --axis out, and say --socket");
        return Err(Failure::refused(refused).value(axis).allowed("--socket").into());
    }
    tell_person(&format!("  {why}"));
    let mut answers = course.answers.clone();
    answers.axis = None;
    Ok(course.take(answers)?)
}

/// Drops a socket that turns another pump: the port was said after it. A script is refused.
fn socket_of_another(course: &mut Course) -> Asked<()> {
    let Some(error) = course.socket_of_another() else { return Ok(()) };
    if course.asker.is_silent() {
        return Err(Failure::from(error).into());
    }
    tell_person(&format!("  {error}"));
    let mut answers = course.answers.clone();
    answers.socket = None;
    Ok(course.take(answers)?)
}

fn ask_socket(course: &mut Course) -> Asked<()> {
    let chip = match &course.board {
        Some(FoundBoard::Klipper { chip, .. }) => chip.as_str(),
        _ => "",
    };
    let found = course.board.clone();
    let fitting: Vec<_> = PrinterBoard::with_chip(chip).collect();
    let is_unlisted = fitting.is_empty() && !chip.is_empty();
    let boards = if fitting.is_empty() { PrinterBoard::all().iter().collect() } else { fitting };
    let boards = if is_unlisted { Vec::new() } else { boards };
    if is_unlisted {
        tell_person(&format!(
            "  no board of this program's list has its microcontroller, {chip}: say the pins, from the board's file of \
             Klipper's folder config"
        ));
    }
    for board in &boards {
        let sockets = board.sockets().collect::<Vec<_>>().join(", ");
        tell_person(&format!("  {}: the {}, with the sockets {sockets}", board.name, board.title));
    }
    let port = course.answers.port.clone().unwrap_or_default();
    let others = course.others_at(&port);
    for other in others.iter().filter(|other| other.step_pin.is_some()) {
        let pin = other.step_pin.as_deref().unwrap_or_default();
        let socket = socket_at(&boards, pin).map_or(pin.to_owned(), |socket| format!("{socket} ({pin})"));
        tell_person(&format!("  {} has the motor at {socket} of this board", other.name));
    }
    let is_taken = |pin: &str| others.iter().any(|other| other.step_pin.as_deref() == Some(pin));
    let free = sockets_of(&boards).find(|(_, socket)| !is_taken(socket.step_pin()));
    let (text, option) = match free.filter(|_| !is_unlisted) {
        Some((name, _)) => {
            (format!("Board and socket of the motor, as {name}, or its pins"), format!("--socket {name}"))
        }
        None => (format!("Pins of the motor, as {PINS}"), format!("--socket {PINS}")),
    };
    let question = Question {
        text: &text,
        option: &option,
        usual: course.former(|before| before.socket.as_ref().map(ToString::to_string)),
        help: "the board's name is printed on it, and the socket's beside the motor's plug; the pins of any other \
               board are in its file of Klipper's folder config, as step=PB13,dir=PB12,enable=!PB14, and \
               uart=PC11,tx=PC10,address=0 for a TMC2209",
    };
    let read = |answer: &str| {
        let socket: MotorSocket = answer.parse().map_err(|error| format!("{error}"))?;
        fits(found.as_ref(), &socket)?;
        let is_taken = |pin: &str| pin == socket.step_pin();
        match others.iter().find(|other| other.step_pin.as_deref().is_some_and(is_taken)) {
            Some(other) => Err(format!("{socket} is that of {}; choose another socket", other.name)),
            None => Ok(socket),
        }
    };
    let had_current = course.answers.current_a.is_some();
    course.settle(Topic::Socket, &question, read, Answers::set_socket)?;
    if had_current && course.answers.current_a.is_none() {
        tell_person(
            "  these pins name no wire to a TMC2209, so the current that was said is left out: the stepper driver's \
             own screw or jumper sets it",
        );
    }
    Ok(())
}

/// Returns the sockets of these boards, each as a user types it.
fn sockets_of<'a>(boards: &'a [&PrinterBoard]) -> impl Iterator<Item = (String, MotorSocket)> + 'a {
    let names =
        boards.iter().flat_map(|board| board.sockets().map(|socket| format!("{}:{socket}", board.name)));
    names.filter_map(|name| name.parse().ok().map(|socket| (name, socket)))
}

/// Returns the socket of one of these boards whose step pin is `pin`, as a user types it.
fn socket_at(boards: &[&PrinterBoard], pin: &str) -> Option<String> {
    sockets_of(boards).find(|(_, socket)| socket.step_pin() == pin).map(|(name, _)| name)
}

fn ask_current(course: &mut Course) -> Asked<()> {
    let question = Question {
        text: "Current of the motor (RMS), as 0.5A",
        option: "--current 0.5A",
        // The current is that of a motor's label: nobody has said that this motor is like the last one.
        usual: course
            .suggested(|last| last.current_a.map(|current_a| format!("{current_a}A")), None)
            .filter(|_| !course.asker.is_silent()),
        help: "the board sets it in the stepper driver; the motor's label says the most of a phase, and 0.7 of that \
               keeps a motor cool that rests a lot",
    };
    let read = |answer: &str| units::current_a(answer).map_err(|error| error.to_string());
    course.settle(Topic::Current, &question, read, |answers, current_a| answers.current_a = Some(current_a))
}

fn ask_hold_current(course: &mut Course) -> Asked<()> {
    if course.answers.hold_a.is_some() || course.asker.is_silent() {
        return Ok(());
    }
    let of_run = format!("{}A", course.answers.current_a.unwrap_or_default());
    // The current at rest of another motor fits its own current alone.
    let run_a = course.answers.current_a;
    let of_last =
        |last: &Answers| last.hold_a.filter(|_| last.current_a == run_a).map(|hold_a| format!("{hold_a}A"));
    let question = Question {
        text: "Current of the motor at rest (RMS), as 0.3A",
        option: "--hold-current 0.3A",
        usual: course.suggested(of_last, Some(&of_run)),
        help: "the motor holds with it between doses, so that the rollers stay where they are; half of the current of \
               the turning motor holds most heads, and leaves the motor cooler",
    };
    let read = |answer: &str| units::current_a(answer).map_err(|error| error.to_string());
    course.settle(Topic::HoldCurrent, &question, read, |answers, hold_a| answers.hold_a = Some(hold_a))
}
