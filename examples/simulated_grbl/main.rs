//! Simulates a grbl board at the end of a pseudo-terminal, for people without hardware: `cargo run
//! --example simulated_grbl`.

mod simulated;

use std::error::Error;
use std::io::Write;
use std::str::FromStr;
use std::time::{Duration, Instant};

use simulated::Simulated;
use simulated::options::{Options, Sensor};

const HELP: &str = "\
A simulated grbl board at the end of a pseudo-terminal. Prints a device that `dose --driver grbl --port` takes, and runs
until it is interrupted.

  --for <seconds>         ends by itself
  --fast <factor>         its motor runs so many times faster
  --resets                opening the port resets it, as an Arduino
  --set <number>=<value>  a setting that differs, as --set 100=80
  --sensor <step>         an index sensor at this step of 12800
  --firmware grbl|grbl09|grblhal|fluidnc
  --auto-report <seconds> reports its position by itself, as grblHAL's $481
  --chatter               sends messages without end
  --press <step>:<byte>   somebody else sends a byte at this step: 33 is a hold button, 133 a jog cancel
  --jog <step>:<mm>       somebody else jogs at this step
  --garble <jog>:<digit>  a jog arrives with this first digit
  --stretch <jog>         a jog goes twice as far
  --miss <step>:<number>  the motor misses steps, and the counter learns of them 500 steps later
  --misread <number>=<value>  the first list of settings tells this value
";

fn main() -> Result<(), Box<dyn Error>> {
    let mut options = Options::default();
    let mut limit = None;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--help" | "-h" => {
                write!(std::io::stdout(), "{HELP}")?;
                return Ok(());
            }
            "--for" => limit = Some(Duration::from_secs_f64(value()?.parse()?)),
            "--fast" => options.time_scale = value()?.parse()?,
            "--resets" => options.resets_on_open = true,
            "--set" => {
                let text = value()?;
                let (number, value) = text.split_once('=').ok_or("--set needs <number>=<value>")?;
                options.settings.push((number.parse()?, value.parse()?));
            }
            "--sensor" => options.sensor = Some(Sensor { at: value()?.parse()?, width: 128, every: 12_800 }),
            "--auto-report" => options.auto_report = Some(Duration::from_secs_f64(value()?.parse()?)),
            "--chatter" => options.chatters = true,
            "--press" => options.defects.pressed = Some(pair(&value()?)?),
            "--jog" => options.defects.foreign = Some(pair(&value()?)?),
            "--garble" => options.defects.garbles = Some(pair(&value()?)?),
            "--stretch" => options.defects.stretches = Some(value()?.parse()?),
            "--miss" => {
                let (place, steps) = pair(&value()?)?;
                options.defects.misses = Some((place, steps, place + 500));
            }
            "--misread" => {
                let (number, value) = pair(&value()?.replace('=', ":"))?;
                options.defects.misreads = Some((1, number, value));
            }
            "--firmware" => options.firmware = value()?.parse()?,
            other => {
                return Err(format!("{other} is not an option\n{HELP}").into());
            }
        }
    }
    let board = Simulated::start(options)?;
    writeln!(std::io::stdout(), "{}", board.path().display())?;
    let started = Instant::now();
    while limit.is_none_or(|limit| started.elapsed() < limit) {
        std::thread::sleep(Duration::from_millis(50));
    }
    writeln!(std::io::stdout(), "{} steps", board.rest().steps)?;
    Ok(())
}

/// Reads two values with a colon between them.
fn pair<A, B>(text: &str) -> Result<(A, B), Box<dyn Error>>
where
    A: FromStr<Err: Error + 'static>,
    B: FromStr<Err: Error + 'static>,
{
    let (one, two) = text.split_once(':').ok_or(format!("{text} needs a colon between two values"))?;
    Ok((one.parse()?, two.parse()?))
}
