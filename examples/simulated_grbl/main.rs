//! Simulates a grbl board at the end of a pseudo-terminal, for people without hardware: `cargo run
//! --example simulated_grbl`.

#[allow(dead_code, reason = "tests choose its defects, and look into its vessel")]
mod balance;
mod board_words;
mod simulated;

use std::error::Error;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use balance::{Defect, SimulatedBalance, Speech, Truth, Vessel};
use board_words::pair;
use pump_model::{DefaultPulse, Line, Pump};
use simulated::Simulated;
use simulated::options::Options;

const HELP: &str = "\
A simulated grbl board, of one axis, X, without --axes, at the end of a pseudo-terminal. Prints a device that
`dose --driver grbl --port` takes, and runs until it is interrupted.

  --balance mt-sics|sbi   a balance too, under the vessel of the built-in pump `three-roller`: prints its device as well
  --head <mL>:<rollers>:<steps>  the head under which the balance's vessel stands, in place of `three-roller`: its
                          volume and its motor's steps per revolution, as --head 0.5:4:3200
  --axes <number>         the board has so many axes, 3 at most: a rack moves them as one line
  --for <seconds>         ends by itself
  --fast <factor>         its motor runs so many times faster
  --resets                opening the port resets it, as an Arduino
  --set <number>=<value>  a setting that differs, as --set 100=80
  --info <text>           the text that somebody has stored in the board with $I=
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

/// Truth about a pump that delivers 3 % more than its model says, in drops of 40 µL, into a vessel of 50 g.
const TRUTH: Truth = Truth {
    factor: 1.03,
    zero_rad: 0.0,
    steps_per_rev: 12_800.0,
    // Water of 25 °C weighed in air of 1.0 kg/m³ (OIML R 111-1, C.4; Kell, 1975).
    g_ml: 0.996_17,
    drop_ml: 0.04,
    fall_s: 0.15,
    lag_s: 0.3,
    decimals: 2,
    vessel_g: 50.0,
    defect: Defect::None,
    defect_from_ml: 0.0,
};

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
    // The board reports the axis that has a motor, so that nobody sets a pump up at another one.
    let mut options = Options { axes: 1, ..Options::default() };
    let mut limit = None;
    let mut speech: Option<Speech> = None;
    let mut vessel = Vessel::new(Pump::three_roller(), TRUTH);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        if board_words::set(&mut options, &word, &mut value)? {
            continue;
        }
        match word.as_str() {
            "--help" | "-h" => {
                write!(std::io::stdout(), "{HELP}")?;
                return Ok(());
            }
            "--balance" => speech = Some(value()?.parse()?),
            "--head" => vessel = vessel_of(&value()?)?,
            "--for" => limit = Some(Duration::from_secs_f64(value()?.parse()?)),
            other => {
                return Err(format!("{other} is not an option; --help lists them").into());
            }
        }
    }
    serve(options, limit, speech, vessel)
}

/// Serves the board, and the balance under its vessel if there is one, until the time is over.
fn serve(
    options: Options,
    limit: Option<Duration>,
    speech: Option<Speech>,
    vessel: Vessel,
) -> Result<(), Box<dyn Error>> {
    let board = Arc::new(Simulated::start(options)?);
    writeln!(std::io::stdout(), "{}", board.path().display())?;
    let turned = Arc::clone(&board);
    let start = |speech| SimulatedBalance::start(speech, vessel, move || turned.truth().steps);
    let balance = speech.map(start);
    let balance = balance.transpose()?;
    if let Some(balance) = &balance {
        writeln!(std::io::stdout(), "{}", balance.path().display())?;
    }
    let started = Instant::now();
    while limit.is_none_or(|limit| started.elapsed() < limit) {
        std::thread::sleep(Duration::from_millis(50));
    }
    writeln!(std::io::stdout(), "{} steps", board.rest().steps)?;
    if let Some(balance) = &balance {
        writeln!(std::io::stdout(), "{:.3} g in the vessel", balance.vessel().landed_g())?;
    }
    Ok(())
}

/// Returns the vessel of a head that delivers 3 % more than its data sheet says, with the usual pulse of bought heads.
fn vessel_of(head: &str) -> Result<Vessel, Box<dyn Error>> {
    let (ml_per_rev, motor) = head.split_once(':').ok_or("--head needs <mL>:<rollers>:<steps>")?;
    let (rollers, steps_per_rev): (u32, f64) = pair(motor)?;
    let pulse = DefaultPulse::new(0.23, 50.0);
    let pump = Pump::from_ml_per_rev(ml_per_rev.parse()?, rollers, pulse, Line::PUBLISHED, Line::PUBLISHED)?;
    Ok(Vessel::new(pump, Truth { steps_per_rev, ..TRUTH }))
}
