//! Simulates a node at the end of a pseudo-terminal, for people without hardware: `cargo run --example simulated_node`.

mod simulated_node;

use std::error::Error;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use simulated_node::SimulatedNode;

const HELP: &str = "\
A simulated node at the end of a pseudo-terminal: the logic of the board's firmware, with four motors in software.
Prints a device that `dose --driver node --port` takes, and runs until it is interrupted.

  --for <seconds>    ends by itself
  --piped            ends with its standard input
  --number <number>  number of the board [default: 1]
";

fn main() -> Result<(), Box<dyn Error>> {
    let (mut number, mut limit, mut is_piped) = (1, None, false);
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
            "--number" => number = value()?.parse()?,
            other => return Err(format!("{other} is not an option\n{HELP}").into()),
        }
    }
    let board = SimulatedNode::start(number)?;
    writeln!(std::io::stdout(), "{}", board.path().display())?;
    if is_piped {
        std::io::stdin().read_to_end(&mut Vec::new())?;
        limit = Some(Duration::ZERO);
    }
    let started = Instant::now();
    while limit.is_none_or(|limit| started.elapsed() < limit) {
        std::thread::sleep(Duration::from_millis(50));
    }
    writeln!(std::io::stdout(), "{:?} steps", board.truth().steps)?;
    Ok(())
}
