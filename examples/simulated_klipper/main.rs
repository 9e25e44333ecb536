//! Simulates a board with Klipper's firmware at the end of a pseudo-terminal, for people without hardware: `cargo run
//! --example simulated_klipper`.

mod simulated_klipper;
#[cfg(test)]
mod tests;

use std::error::Error;
use std::io::{Write, stdin};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use simulated_klipper::{Character, IndexSensor, SimulatedKlipper, pin_of, socket_of};

const HELP: &str = "\
A simulated board with Klipper's firmware at the end of a pseudo-terminal: an SKR Mini E3 V2.0 with four sockets X, Y,
Z and E. Prints a device that `dose --driver klipper --port` takes, and runs until it is interrupted.

  --for <seconds>      ends by itself
  --piped              ends with its standard input
  --chip <name>        microcontroller that its dictionary names [default: stm32f103xe]
  --clock <Hz>         ticks of its clock in a second [default: 72000000]
  --drift <ppm>        drift of its clock, in parts of a million
  --first-tick <tick>  tick at which it is switched on
  --slots <number>     commands that its queue holds [default: 512]
  --fastest <steps/s>  most steps a second [default: 590000]
  --baud <bits/s>      rate of its line; 0 is a line without delay, as USB [default: 250000]
  --drivers <number>   sockets with a TMC2209 on the line PC11, PC10 [default: 2]
  --index <pin=socket:steps>  index sensor at a pin, high once in so many steps of a socket, as PC0=X:3200
  --lose <part>, --double <part>, --damage <part>  parts of the bytes on the line, in each direction
  --seed <number>      seed of that
  --app <name>         name of another firmware
  --lacks <command>    firmware without a command, as queue_step
  --record <file>      the time of each step: socket, tick, and 1 or -1

Lines on standard input are hands at the board:

  reset                resets the board, which loses its configuration and its clock
  pull, plug           pulls its cable, and plugs it in again
  cut, restore         cuts the motors' supply, as an emergency stop does, and gives it back
  shutdown             its firmware shuts down by itself, as if a step had come late
  jump <ticks>         lets its clock jump
  fault <socket> <flag>  a driver reports otpw, ot, s2ga, s2gb, s2vsa, s2vsb, ola or olb, as fault X ot
  mend <socket> <flag>   ends it
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

fn run() -> Result<(), Box<dyn Error>> {
    let (mut limit, mut is_piped) = (None, false);
    let mut character = Character::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--help" | "-h" => {
                write!(std::io::stdout(), "{HELP}")?;
                return Ok(());
            }
            "--for" => {
                let seconds = number(&word, &value()?)?;
                limit =
                    Some(Duration::try_from_secs_f64(seconds).map_err(|error| format!("--for: {error}"))?);
            }
            "--piped" => is_piped = true,
            other => {
                if !set(&mut character, other, &mut value)? {
                    return Err(format!("{other} is not an option; --help lists them").into());
                }
            }
        }
    }
    serve(character, limit, is_piped)
}

/// Sets what an option says. Returns false if it is none.
fn set(
    character: &mut Character,
    word: &str,
    value: &mut impl FnMut() -> Result<String, String>,
) -> Result<bool, Box<dyn Error>> {
    match word {
        // The name lives as long as the program.
        "--chip" => character.chip = value()?.leak(),
        "--clock" => character.hz = number(word, &value()?)?,
        "--drift" => character.drift_ppm = number(word, &value()?)?,
        "--first-tick" => character.first_tick = number(word, &value()?)?,
        "--slots" => character.slots = number(word, &value()?)?,
        "--fastest" => character.most_steps_s = number(word, &value()?)?,
        "--baud" => character.baud = number(word, &value()?)?,
        "--drivers" => character.drivers = number(word, &value()?)?,
        "--index" => character.index = Some(sensor(&value()?)?),
        "--lose" => character.noise.lost = number(word, &value()?)?,
        "--double" => character.noise.doubled = number(word, &value()?)?,
        "--damage" => character.noise.damaged = number(word, &value()?)?,
        "--seed" => character.noise.seed = number(word, &value()?)?,
        // The name lives as long as the program.
        "--app" => character.app = value()?.leak(),
        "--lacks" => character.lacks = Some(value()?),
        "--record" => character.record = Some(value()?.into()),
        _ => return Ok(false),
    }
    Ok(true)
}

/// Reads the number that an option says.
fn number<T: FromStr>(word: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{word} {text} is no number that fits; --help lists the options"))
}

/// Reads the index sensor that `PC0=X:3200` names.
fn sensor(text: &str) -> Result<IndexSensor, Box<dyn Error>> {
    let wrong = || format!("{text} is no pin with a socket and its steps, as PC0=X:3200");
    let (pin, motor) = text.split_once('=').ok_or_else(wrong)?;
    let (socket, steps) = motor.split_once(':').ok_or_else(wrong)?;
    let pin = pin_of(pin).ok_or_else(wrong)?;
    Ok(IndexSensor { pin, socket: socket_of(socket)?, steps: number("--index", steps)? })
}

/// Serves the board until the time is over or the standard input ends.
fn serve(character: Character, limit: Option<Duration>, is_piped: bool) -> Result<(), Box<dyn Error>> {
    let board = SimulatedKlipper::start_as(character)?;
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
    let truth = board.truth();
    writeln!(std::io::stdout(), "{:?} steps", truth.steps)?;
    if let Some(reason) = truth.shutdown {
        writeln!(std::io::stdout(), "shut down: {reason}")?;
    }
    Ok(())
}
