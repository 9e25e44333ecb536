//! A batch: several doses from one command.

use clap::Args;
use pump_bench::dosing::{MAX_DOSES, Missed, Schedule};
use pump_bench::units::{self, count};

use super::choice::choice;
use crate::failure::Failure;

/// Number of doses and their schedule.
#[derive(Debug, Args)]
#[command(next_help_heading = "Batch")]
pub(crate) struct BatchOptions {
    /// Make a batch of this many doses
    #[arg(long_help = "Make a batch of this many doses, one after the other or as --every says.")]
    #[arg(long, value_name = "N", value_parser = count("number of doses", 1..=MAX_DOSES))]
    repeat: Option<u32>,
    /// Time from one dose's start to the next, as 30s
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) every: Option<f64>,
    /// Skip a dose whose time has passed, or make it now [default: skip]
    #[arg(
        long_help = "What becomes of a dose whose time has passed, because the one before took longer or the process \
        was suspended: skip leaves it out, and the batch goes on and ends with exit code 1; now makes \
        it at once. Default: skip"
    )]
    #[arg(long, value_name = "skip|now", value_parser = choice(&[
        (Missed::Skip, "Leave it out; the exit code is 1 at the end"),
        (Missed::Now, "Make it at once"),
    ]))]
    missed: Option<Missed>,
}

impl BatchOptions {
    /// The schedule of a batch; none for a single dose. Options that only a batch obeys are refused without one.
    pub(crate) fn schedule(&self) -> Result<Option<Schedule>, Failure> {
        if self.missed.is_some() && self.every.is_none() {
            return Err(Failure::refused(
                "--missed says what becomes of a dose whose time has passed; give the doses times with --every",
            ));
        }
        let Some(count) = self.repeat else {
            return match self.every {
                Some(_) => Err(Failure::refused(
                    "--every is the time between the doses of a batch; say how many with --repeat",
                )),
                None => Ok(None),
            };
        };
        let schedule = Schedule::new(count.into(), self.every, self.missed.unwrap_or_default())
            .map_err(|error| Failure::of(error).after("--every: "))?;
        Ok((count > 1).then_some(schedule))
    }
}
