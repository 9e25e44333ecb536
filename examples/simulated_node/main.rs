//! Simulates a node at the end of a pseudo-terminal, for people without hardware: `cargo run --example simulated_node`.

mod simulated_node;

use std::error::Error;
use std::io::{Write, stdin};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use simulated_node::{Character, SimulatedNode};

const HELP: &str = "\
A simulated node at the end of a pseudo-terminal: the logic of the board's firmware, with four motors in software.
Prints a device that `dose --driver node --port` takes, and runs until it is interrupted.

  --for <seconds>    ends by itself
  --piped            ends with its standard input
  --number <number>  number of the board [default: 1]
  --index <axis=steps>  index sensor of an axis, active once in so many steps, as X=3200
  --fault-high <axis>  stepper driver of an axis whose output is high in a fault, as DIAG of a TMC2209
  --protocol <n>     firmware that speaks this version of the protocol, as 1

Lines on standard input are hands at the board:

  estop              presses the emergency stop; release releases it
  fault <axis>       the stepper driver of an axis reports a fault, as fault X; mend X ends it
  reset              resets the board, which loses its count
  pull, plug         pulls the cable between computer and board, and plugs it in again; the board goes on running
";

fn main() -> Result<(), Box<dyn Error>> {
    let (mut limit, mut is_piped) = (None, false);
    let mut character = Character { number: 1, ..Character::default() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--help" | "-h" => {
                write!(std::io::stdout(), "{HELP}")?;
                return Ok(());
            }
            "--for" => limit = Some(Duration::from_secs_f64(value()?.parse()?)),
            "--piped" => is_piped = true,
            "--number" => character.number = value()?.parse()?,
            "--protocol" => character.protocol = Some(value()?.parse()?),
            "--fault-high" => {
                character.fault_high[place_of(&value()?).ok_or("name an axis X, Y, Z or A")?] = true;
            }
            "--index" => sense(&mut character, &value()?)?,
            other => return Err(format!("{other} is not an option\n{HELP}").into()),
        }
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

/// Returns the place of an axis by its letter.
fn place_of(axis: &str) -> Option<usize> {
    ["X", "Y", "Z", "A"].iter().position(|name| *name == axis)
}

/// Connects the index sensor that `X=3200` names.
fn sense(character: &mut Character, text: &str) -> Result<(), Box<dyn Error>> {
    let wrong = || format!("{text} is no axis X, Y, Z or A with its steps, as X=3200");
    let (axis, steps) = text.split_once('=').ok_or_else(wrong)?;
    let place = place_of(axis).ok_or_else(wrong)?;
    character.index_steps[place] = Some(steps.parse()?);
    Ok(())
}
