//! The questions about the board: what turns the motor, its port and its axis.

mod socket;

use std::path::{Path, PathBuf};

use pump_bench::drives::{
    DriveError, FoundBoard, PortFault, board_has_answered, find_board, find_boards, serial_ports,
};
use pump_bench::notice::{Remedy, with_sources};
use pump_bench::pump_file::{Axis, DriverName};
use pump_bench::report::Explain;
use pump_bench::setup::{Answers, Topic};

use super::asker::{Asked, Question, Usual};
use super::course::{Course, heading, tell_person};
use super::options::axis;
use crate::advice;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{say, warn};

/// Folder of the devices.
const DEVICES: &str = "/dev";

/// Asks what turns the motor, and where it is.
pub(super) fn ask(course: &mut Course) -> Asked<()> {
    if course.answers.driver.is_none() {
        heading("The board");
        // The board at a port that was said tells its driver.
        if course.answers.port.is_some() && !meet(course)? {
            forget_port(course)?;
        }
    }
    if course.answers.driver.is_none() {
        ask_driver(course)?;
    }
    if course.answers.driver == Some(DriverName::Sim) {
        return Ok(());
    }
    let mut full = None;
    // A pump that is set up keeps its port and its axis.
    let is_kept = course.answers.is_finished() && course.answers.port.is_some();
    loop {
        if course.answers.port.is_none() {
            ask_port(course, full.as_deref())?;
        }
        let is_open = match course.answers.driver {
            Some(DriverName::Klipper) => socket::is_open(course),
            _ => course.answers.axis.is_none(),
        };
        if is_open && !meet(course)? {
            forget_port(course)?;
            continue;
        }
        if course.answers.driver == Some(DriverName::Klipper) {
            return socket::ask(course);
        }
        lack_of_axis(course)?;
        if !is_kept {
            axis_of_another(course)?;
        }
        if course.answers.axis.is_some() || ask_axis(course)? {
            return Ok(());
        }
        // Each axis of this board turns another pump.
        full.clone_from(&course.answers.port);
        forget_port(course)?;
    }
}

/// Forgets the port, which is asked for anew.
fn forget_port(course: &mut Course) -> Result<(), Failure> {
    let mut answers = course.answers.clone();
    answers.port = None;
    course.board = None;
    course.take(answers)
}

/// Drops an axis that turns another pump: the port was said after it. A script is refused.
fn axis_of_another(course: &mut Course) -> Asked<()> {
    let Some(error) = course.axis_of_another() else { return Ok(()) };
    if course.asker.is_silent() {
        return Err(Failure::from(error).into());
    }
    tell_person(&format!("  {error}"));
    let mut answers = course.answers.clone();
    answers.axis = None;
    Ok(course.take(answers)?)
}

/// Asks the board at a port that nobody was asked for who it is, so that only axes are offered that it has. Returns
/// false if no board answers there.
fn meet(course: &mut Course) -> Asked<bool> {
    let port = course.answers.port.clone().filter(|_| course.board.is_none());
    let is_told = |port: &PathBuf| course.asker.is_silent() && course.silent_port.as_ref() == Some(port);
    let Some(port) = port.filter(|port| !is_told(port)) else { return Ok(true) };
    let found = who_is_at(&port, course.answers.driver);
    if let Some(signal) = interrupt::signal() {
        return Err(Failure::stopped(signal, false, "stopped by the user").into());
    }
    match found {
        Ok(board) => {
            course.board = Some(board.clone());
            take_driver(course, &board).map(|()| true)
        }
        Err(why) => {
            tell_person(&format!("  {why}"));
            // A script may write the file of a board that is not there yet.
            Ok(course.asker.is_silent())
        }
    }
}

fn ask_driver(course: &mut Course) -> Asked<()> {
    let question = Question {
        text: "Driver: grbl, node or klipper for a board, or sim to try it without one",
        option: "--driver grbl",
        // Nobody has named a real motor whose driver is that of another pump.
        usual: course
            .suggested(|last| last.driver.map(|driver| driver.as_str().to_owned()), None)
            .filter(|_| !course.asker.is_silent()),
        help: "grbl: a board that speaks grbl 1.1's protocol over a USB cable (grbl, grblHAL, FluidNC); node: a board \
               with this project's own firmware (docs/node.md); klipper: a printer board with the Klipper firmware \
               (docs/klipper.md); sim: a motor, pump and vessel that exist in the \
               program only",
    };
    let read = |answer: &str| answer.parse::<DriverName>().map_err(|error| error.to_string());
    course.settle(Topic::Driver, &question, read, |answers, driver| answers.driver = Some(driver))
}

/// Asks the port. That of a board all of whose axes turn other pumps is not suggested.
fn ask_port(course: &mut Course, full: Option<&Path>) -> Asked<()> {
    let is_silent = course.asker.is_silent();
    let mut found = if is_silent { Vec::new() } else { search()? };
    let of_last = course.suggested(|last| Some(last.port.as_ref()?.display().to_string()), None);
    found.extend(shared_board(course, of_last.as_ref(), &found));
    let is_free = |usual: &Usual| {
        let port = Path::new(&usual.answer);
        let board = found.iter().find(|(at, _)| at == port).map(|(_, board)| board);
        full != Some(port) && free_axis(course, board, port, axes(board, course.answers.driver)).is_some()
    };
    let free: Vec<_> =
        found.iter().filter(|(port, _)| is_free(&Usual::new(port.display().to_string()))).collect();
    let of_driver = free.iter().filter(|(_, board)| Some(board.driver()) == course.answers.driver);
    let only = match (of_driver.collect::<Vec<_>>().as_slice(), free.as_slice()) {
        ([(port, _)], _) | (_, [(port, _)]) => Some(Usual::new(port.display().to_string())),
        _ => None,
    };
    let is_there = |usual: &Usual| found.iter().any(|(port, _)| Path::new(&usual.answer) == port);
    let question = Question {
        text: "Port of the board",
        option: "--port /dev/ttyUSB0",
        usual: of_last.clone().filter(is_there).filter(is_free).or(only).or(of_last).filter(is_free),
        help: "the device that appears when you plug the board's cable in, as /dev/ttyUSB0",
    };
    let (mut board, named) = (None, course.answers.driver);
    let read = |answer: &str| {
        let port = Path::new(answer);
        if !port.exists() {
            let fault = PortFault::missing();
            return Err(format!("no board is at {answer}: {fault}; is the cable of the board plugged in?"));
        }
        if !is_silent {
            let known = found.iter().find(|(at, _)| at == port).map(|(_, board)| board.clone());
            board = Some(known.map_or_else(|| who_is_at(port, named), Ok)?);
        }
        Ok(port.to_owned())
    };
    course.settle(Topic::Port, &question, read, |answers, port| answers.port = Some(port))?;
    course.board = board;
    course.board.clone().map_or(Ok(()), |board| take_driver(course, &board))
}

/// Asks the board of a suggested port that the search has not found, if it turns another pump: it is suggested while
/// one of its axes is free.
fn shared_board(
    course: &Course,
    suggested: Option<&Usual>,
    found: &[(PathBuf, FoundBoard)],
) -> Option<(PathBuf, FoundBoard)> {
    let port = Path::new(&suggested?.answer);
    let is_known = course.asker.is_silent() || found.iter().any(|(at, _)| at == port);
    if is_known || !port.exists() || course.others_at(port).is_empty() {
        return None;
    }
    Some((port.to_owned(), who_is_at(port, course.answers.driver).ok()?))
}

/// Asks the port anew, of a board that does not answer there.
pub(super) fn ask_again(course: &mut Course) -> Asked<()> {
    forget_port(course)?;
    ask(course)
}

/// Asks a port that the search has not found who is there, the board of a driver that was `named` first. It says why
/// there is no board.
fn who_is_at(port: &Path, named: Option<DriverName>) -> Result<FoundBoard, String> {
    let shown = port.display();
    say(&format!("  asking {shown} (nothing moves)\n"));
    match find_board(port, named, &interrupt::stop_request()) {
        Ok(board) => {
            tell_person(&format!("  {shown}: {board}"));
            Ok(board)
        }
        Err(error) => {
            // The remedy is said below, in the words of these questions.
            let is_no_port = error.remedies().contains(&Remedy::FindPort);
            let why = if is_no_port { with_sources(&error) } else { advice::told(&error) };
            let why = answer_in_words(&error, &shown.to_string(), &why);
            Err(format!("{why}; name the board's port, or quit and come back"))
        }
    }
}

/// The words for a port without a board that can be used.
fn answer_in_words(error: &DriveError, port: &str, why: &str) -> String {
    match board_has_answered(error) {
        true => why.to_owned(),
        false => format!("no board answers at {port}: {why}"),
    }
}

/// Asks the board whose port was said for its axes, so that no file is written for an axis that it lacks. Where no
/// board answers, a script is refused, a person is asked for another port before anything moves, and a pump file alone
/// names the port all the same, with a warning.
pub(super) fn meet_said(course: &mut Course, is_file_alone: bool) -> Asked<()> {
    let is_silent = course.asker.is_silent();
    let Answers { driver, port: Some(port), axis, socket, .. } = &course.answers else { return Ok(()) };
    if *driver == Some(DriverName::Sim) || axis.is_none() && socket.is_none() && !is_silent {
        return Ok(());
    }
    let port = port.clone();
    say(&format!("  asking {} (nothing moves)\n", port.display()));
    let found = find_board(&port, *driver, &interrupt::stop_request());
    if let Some(signal) = interrupt::signal() {
        return Err(Failure::stopped(signal, false, "stopped by the user").into());
    }
    match found {
        Ok(board) => {
            other_driver(course, &board)?;
            course.board = Some(board);
        }
        Err(error) if is_file_alone => {
            // The board may come later, so only a version that will not change by itself needs its remedy.
            let said = if board_has_answered(&error) { advice::told(&error) } else { with_sources(&error) };
            let why = answer_in_words(&error, &port.display().to_string(), &said);
            warn(&[format!("{why}; the pump file names this port all the same")]);
            course.silent_port = Some(port);
        }
        Err(error) if is_silent => {
            let failure = Failure::of(error);
            return Err(failure
                .with("; `--no-motion` writes the pump file of a board that comes later")
                .into());
        }
        Err(_) => {}
    }
    socket::socket_of_other_board(course)?;
    lack_of_axis(course)
}

/// Takes the driver of the board that answers in place of the one that was named. A script is refused.
fn other_driver(course: &mut Course, board: &FoundBoard) -> Asked<()> {
    let (driver, port) = (board.driver(), course.answers.port.clone().unwrap_or_default());
    match course.answers.driver {
        Some(named) if named != driver && course.asker.is_silent() => {
            let port = port.display().to_string();
            let refused = format!("{board} is at {port}, and --driver is {named}; say --driver {driver}");
            let mut answers = course.answers.clone();
            answers.driver = None;
            course.take(answers)?;
            Err(Failure::refused(refused).value(named).allowed(driver).into())
        }
        _ => take_driver(course, board),
    }
}

/// Drops an axis that the board does not report, or that no board of its driver has, so that a person is asked for
/// another. A script is refused.
fn lack_of_axis(course: &mut Course) -> Asked<()> {
    let Some(axis) = course.answers.axis else { return Ok(()) };
    let axes = axes(course.board.as_ref(), course.answers.driver);
    if axes.contains(&axis) {
        return Ok(());
    }
    let port = course.answers.port.clone().unwrap_or_default();
    let lacks = format!("the board at {} has {}, and not {axis}", port.display(), in_words(axes));
    let mut answers = course.answers.clone();
    answers.axis = None;
    course.take(answers)?;
    if course.asker.is_silent() {
        let refused = format!("{lacks}; name one that it has with --axis <AXIS>");
        return Err(Failure::refused(refused).value(axis).allowed(in_words(axes)).into());
    }
    tell_person(&format!("  {lacks}"));
    Ok(())
}

/// Takes the driver of the board that answers at the port.
fn take_driver(course: &mut Course, board: &FoundBoard) -> Asked<()> {
    let driver = board.driver();
    if course.answers.driver != Some(driver) {
        tell_person(&format!("  {board} is at this port, so the driver is {driver}"));
        let mut answers = course.answers.clone();
        answers.driver = Some(driver);
        answers.check().map_err(Failure::from)?;
        course.take(answers)?;
    }
    Ok(())
}

/// Asks every port who is there, and says it. Returns the ports with a board.
fn search() -> Result<Vec<(PathBuf, FoundBoard)>, Failure> {
    let ports = serial_ports(Path::new(DEVICES));
    if ports.is_empty() {
        tell_person("  no serial port of a USB cable is there");
        return Ok(Vec::new());
    }
    let count = ports.len();
    say(&format!("  asking {count} port{} (nothing moves)\n", if count == 1 { "" } else { "s" }));
    let mut found = Vec::new();
    for (port, answer) in find_boards(&ports, &interrupt::stop_request()) {
        let said = match answer {
            Ok(board) => {
                let said = board.to_string();
                found.push((port.clone(), board));
                said
            }
            Err(DriveError::Interrupted) => {
                let signal = interrupt::signal().unwrap_or(0);
                return Err(Failure::stopped(signal, false, "stopped by the user"));
            }
            Err(error) => advice::told(&error),
        };
        tell_person(&format!("  {}: {said}", port.display()));
    }
    Ok(found)
}

/// Asks for the axis. Returns false if each axis of the board turns another pump.
fn ask_axis(course: &mut Course) -> Asked<bool> {
    let port = course.answers.port.clone().unwrap_or_default();
    let others = course.others_at(&port);
    for other in &others {
        tell_person(&format!("  {} has the axis {} of this board", other.name, other.axis));
    }
    let recorded = course.recorded_at(course.board.as_ref(), &port);
    for (pump, axis) in &recorded {
        tell_person(&format!(
            "  {pump} has the axis {axis} of this board by its record; the new pump takes its place if you name that \
             axis"
        ));
    }
    let axes = axes(course.board.as_ref(), course.answers.driver);
    let free = free_axis(course, course.board.as_ref(), &port, axes);
    if free.is_none() {
        let refused = format!("each axis of the board at {} turns another pump", port.display());
        if course.asker.is_silent() {
            return Err(Failure::refused(format!("{refused}; name another board with --port <PORT>")).into());
        }
        tell_person(&format!("  {refused}; name another board, or quit"));
        return Ok(false);
    }
    let former = course.former(|before| {
        before.axis.filter(|_| before.port.as_ref() == Some(&port)).map(|axis| axis.as_str().to_owned())
    });
    let is_new = |axis: &&Axis| recorded.iter().all(|(_, other)| other != *axis);
    let whose = if course.answers.driver == Some(DriverName::Node) { "a node" } else { "this board" };
    let question = Question {
        text: "Axis of the board that turns this pump",
        option: "--axis X",
        // Nobody takes the place of another pump by the Enter key alone.
        usual: former.or_else(|| free.filter(|axis| is_new(axis)).map(|axis| Usual::new(axis.as_str()))),
        help: match course.answers.driver {
            Some(DriverName::Node) => {
                "a node's axes 0 to 3 are X, Y, Z and A; docs/node.md says which pins each has"
            }
            _ => "the letter at the board's plug, X, Y, Z, A, B or C",
        },
    };
    let read = |answer: &str| {
        let axis = axis(answer)?;
        if !axes.contains(&axis) {
            return Err(format!("{whose} has {}, and not {axis}", in_words(axes)));
        }
        match others.iter().find(|other| other.axis == axis) {
            Some(other) => Err(format!("{axis} is that of {}; choose another axis", other.name)),
            None => Ok(axis),
        }
    };
    course.settle(Topic::Axis, &question, read, |answers, axis| answers.axis = Some(axis))?;
    if let (true, Some(axis)) = (course.asker.is_silent(), course.answers.axis) {
        let why = match free == Some(&axis) {
            true => "the first of this board that turns no other pump",
            false => "that of this pump before",
        };
        tell_person(&format!("  axis {axis}: {why}; --axis names another"));
    }
    Ok(true)
}

/// The first of these axes of the board at a port that turns no other pump. If each of them does, a person is offered
/// that of a pump that only its record knows, as it may be gone.
fn free_axis<'a>(
    course: &Course,
    board: Option<&FoundBoard>,
    port: &Path,
    axes: &'a [Axis],
) -> Option<&'a Axis> {
    let (others, recorded) = (course.others_at(port), course.recorded_at(board, port));
    let is_free = |axis: &&Axis| others.iter().all(|other| other.axis != **axis);
    let is_new = |axis: &&Axis| recorded.iter().all(|(_, other)| other != *axis);
    let free = axes.iter().filter(is_free).find(is_new);
    free.or_else(|| axes.iter().find(is_free).filter(|_| !course.asker.is_silent()))
}

/// The axes of the board, as far as it tells. A node has four.
fn axes(board: Option<&FoundBoard>, driver: Option<DriverName>) -> &'static [Axis] {
    match (board.map(FoundBoard::axes), driver) {
        (Some(axes @ [_, ..]), _) => axes,
        (_, Some(DriverName::Node)) => Axis::ALL.get(..4).unwrap_or_default(),
        _ => Axis::ALL,
    }
}

/// Axes in words: `the axes X, Y, Z and A`.
fn in_words(axes: &[Axis]) -> String {
    match axes {
        [axes @ .., last] if !axes.is_empty() => {
            let listed: Vec<_> = axes.iter().map(|axis| axis.as_str()).collect();
            format!("the axes {} and {last}", listed.join(", "))
        }
        axes => format!("the axis {} alone", axes.first().map_or("X", |axis| axis.as_str())),
    }
}
