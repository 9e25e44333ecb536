//! The motor of a new pump: its steps as options or as an answer.

use std::io::{self, BufRead, IsTerminal};

use clap::Args;
use pump_bench::catalogue::{MotorSteps, StatedMotor};
use pump_bench::units::{FULL_STEPS_PER_REV, MICROSTEPS, STEPS_PER_REV, count};

use crate::failure::Failure;
use crate::terminal::say;

/// Full steps per revolution of a usual stepper motor, of 1.8 deg each.
const USUAL_FULL_STEPS: u32 = 200;

/// The steps of the motor.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motor")]
pub(super) struct OwnMotorOptions {
    /// Steps per revolution of the motor, microsteps included, as 3200
    #[arg(long, value_name = "N", conflicts_with_all = ["full_steps", "microsteps"])]
    #[arg(value_parser = count("number of steps per revolution", STEPS_PER_REV))]
    steps_per_rev: Option<u32>,
    /// Full steps per revolution of the motor, with --microsteps [default: 200]
    #[arg(long, value_name = "N", requires = "microsteps")]
    #[arg(value_parser = count("number of full steps per revolution", FULL_STEPS_PER_REV))]
    full_steps: Option<u32>,
    /// Microsteps per full step, as the stepper driver is set, as 16
    #[arg(long, value_name = "N")]
    #[arg(value_parser = count("number of microsteps", MICROSTEPS))]
    microsteps: Option<u32>,
    /// Revolutions of the motor per revolution of the pump head [default: 1]
    #[arg(long, value_name = "RATIO")]
    gear: Option<f64>,
}

impl OwnMotorOptions {
    /// The motor as the options state it, or as a person at the keyboard answers. `None` if nobody says.
    pub(super) fn stated(&self) -> Result<Option<StatedMotor>, Failure> {
        let given = self.steps_per_rev.map(MotorSteps::PerRevolution);
        let micro = self.microsteps.map(|microsteps| {
            let full_steps = self.full_steps.unwrap_or(USUAL_FULL_STEPS);
            MotorSteps::Microsteps { full_steps, microsteps }
        });
        let steps = match given.or(micro) {
            None if io::stdin().is_terminal() && io::stderr().is_terminal() => asked()?,
            steps => steps,
        };
        match (steps, self.gear) {
            (Some(steps), gear) => Ok(Some(StatedMotor::new(steps).with_gear(gear.unwrap_or(1.0)))),
            (None, None) => Ok(None),
            (None, Some(_)) => Err(Failure::refused(
                "--gear alone does not say the motor's steps; add --steps-per-rev 3200, or --microsteps 16",
            )),
        }
    }
}

/// Asks a person for the steps. `None` for an empty answer.
fn asked() -> Result<Option<MotorSteps>, Failure> {
    loop {
        say("steps per revolution of the motor, microsteps included, as 3200 (Enter: not known yet): ");
        let mut line = String::new();
        let read = io::stdin().lock().read_line(&mut line);
        read.map_err(|error| Failure::refused(format!("the answer cannot be read: {error}")))?;
        match line.trim() {
            "" => return Ok(None),
            answer => match count("number of steps per revolution", STEPS_PER_REV)(answer) {
                Ok(steps) => return Ok(Some(MotorSteps::PerRevolution(steps))),
                Err(error) => say(&format!("{error}\n")),
            },
        }
    }
}
