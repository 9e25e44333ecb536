//! Simulates a node at the end of a pseudo-terminal, for people without hardware: `cargo run --example simulated_node`.

mod simulated_node;

use std::error::Error;
use std::io::{Write, stdin};
use std::process::ExitCode;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use simulated_node::{Character, SimulatedNode};

/// Fewest steps from one index mark to the next.
const LEAST_WAY: u32 = 2;

const HELP: &str = "\
A simulated node at the end of a pseudo-terminal: the logic of the board's firmware, with four motors in software.
Prints a device that `dose --driver node --port` takes, and runs until it is interrupted.

  --for <seconds>    ends by itself
  --piped            ends with its standard input
  --number <number>  number of the board, as 18 or 0x12 [default: 1]; dose prints it with hexadecimal digits
  --index <axis=steps>  index sensor of an axis, active once in so many steps, as X=3200
  --fault-high <axis>  stepper driver of an axis whose output is high in a fault, as DIAG of a TMC2209
  --protocol <n>     firmware that speaks this version of the protocol, as 1

Lines on standard input are hands at the board:

  estop              presses the emergency stop; release releases it
  fault <axis>       the stepper driver of an axis reports a fault, as fault X; mend X ends it
  reset              resets the board, which loses its count
  pull, plug         pulls the cable between computer and board, and plugs it in again; the board goes on running
";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Options of the command line.
#[derive(Debug, Default)]
struct Options {
    character: Character,
    limit: Option<Duration>,
    is_piped: bool,
    asks_help: bool,
}

impl Options {
    fn parse(words: impl IntoIterator<Item = String>) -> Result<Self, String> {
        let mut options =
            Self { character: Character { number: 1, ..Character::default() }, ..Self::default() };
        let character = &mut options.character;
        let mut words = words.into_iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--help" | "-h" => options.asks_help = true,
                "--for" => options.limit = Some(time(&value()?)?),
                "--piped" => options.is_piped = true,
                "--number" => character.number = number(&value()?)?,
                "--protocol" => character.protocol = Some(protocol(&value()?)?),
                "--fault-high" => character.fault_high[place_of(&value()?)?] = true,
                "--index" => sense(character, &value()?)?,
                other => return Err(format!("{other} is not an option; --help lists them")),
            }
        }
        Ok(options)
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let Options { character, limit, is_piped, asks_help } = Options::parse(std::env::args().skip(1))?;
    if asks_help {
        write!(std::io::stdout(), "{HELP}")?;
        return Ok(());
    }
    let board = SimulatedNode::start_as(character)?;
    writeln!(std::io::stdout(), "{}", board.path().display())?;
    let started = Instant::now();
    let (told, hands) = mpsc::channel();
    // The thread ends with the standard input or with the program.
    std::thread::spawn(move || stdin().lines().map_while(Result::ok).try_for_each(|line| told.send(line)));
    while limit.is_none_or(|limit| started.elapsed() < limit) {
        match hands.recv_timeout(Duration::from_millis(50)) {
            Ok(words) => {
                if let Err(error) = board.touch(&words) {
                    writeln!(std::io::stderr(), "{error}")?;
                }
            }
            Err(RecvTimeoutError::Disconnected) if is_piped => break,
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(Duration::from_millis(50)),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
    writeln!(std::io::stdout(), "{:?} steps", board.truth().steps)?;
    Ok(())
}

/// Reads a time in s.
fn time(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.ok_or(format!("{text} is no time in seconds, as 60"))
}

/// Reads the number of a board: decimal, or hexadecimal after `0x`, as `dose` prints it.
fn number(text: &str) -> Result<u64, String> {
    let read = text.strip_prefix("0x").map_or(text.parse(), |digits| u64::from_str_radix(digits, 16));
    read.map_err(|_| format!("{text} is no number of a board, as 18, or as 0x12 with hexadecimal digits"))
}

/// Reads a version of the protocol.
fn protocol(text: &str) -> Result<u8, String> {
    text.parse().map_err(|_| format!("{text} is no version of the protocol: 0 to 255"))
}

/// Returns the place of an axis by its letter.
fn place_of(axis: &str) -> Result<usize, String> {
    let place = ["X", "Y", "Z", "A"].iter().position(|name| name.eq_ignore_ascii_case(axis));
    place.ok_or(format!("{axis} is none of the axes X, Y, Z and A"))
}

/// Connects the index sensor that `X=3200` names.
fn sense(character: &mut Character, text: &str) -> Result<(), String> {
    let (axis, steps) = text.split_once('=').ok_or(format!("{text} names no steps, as X=3200"))?;
    // The mark is a hundredth of the way wide, and has to be passed.
    let steps = steps.parse().ok().filter(|steps| *steps >= LEAST_WAY);
    character.index_steps[place_of(axis)?] = Some(
        steps.ok_or(format!("{text} needs whole steps from one mark to the next, {LEAST_WAY} or more"))?,
    );
    Ok(())
}
