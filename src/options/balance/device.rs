//! The balance under the vessel: what it speaks, and where.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use pump_bench::balance::{
    Balance, BalanceReading, ProgramBalance, Protocol, SerialBalance, SerialLine, refuse_port_of_board,
};
use pump_bench::units;

use crate::failure::Failure;
use crate::interrupt;
use crate::options::choice::choice;
use crate::terminal::waiting;

/// Usual longest wait for a balance to stand still, s.
const STILL_S: f64 = 60.0;

/// Longest wait that can be asked for, s.
const MOST_WAIT_S: f64 = 86_400.0;

/// The balance under the vessel.
#[derive(Debug, Args)]
#[command(next_help_heading = "Balance")]
pub(crate) struct BalanceOptions {
    /// Serial port of the balance under the vessel, as /dev/ttyUSB1
    #[arg(long, value_name = "DEVICE", conflicts_with = "scale_command")]
    scale_port: Option<PathBuf>,
    /// Protocol of the balance [default: mt-sics]
    #[arg(long, value_name = "mt-sics|sbi", requires = "scale_port", value_parser = choice(&[
        (Protocol::MtSics, "MT-SICS: Mettler-Toledo and many others"),
        (Protocol::Sbi, "SBI: Sartorius"),
    ]))]
    scale_protocol: Option<Protocol>,
    /// Speed and framing of the balance's line [default: 9600,8N1; of sbi 9600,7O1]
    #[arg(long, value_name = "BAUD,FRAMING", requires = "scale_port")]
    scale_line: Option<SerialLine>,
    /// Longest wait for the balance to stand still, as 60s [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    scale_wait: Option<f64>,
    /// Command that prints what the balance shows, as `23.45 g`
    #[arg(long, value_name = "COMMAND")]
    scale_command: Option<String>,
}

impl BalanceOptions {
    /// Refuses options of a balance that is not asked for.
    pub(crate) fn refuse_without(&self, option: &str) -> Result<(), Failure> {
        if self.is_given() || self.scale_wait.is_some() {
            return Err(Failure::refused(format!(
                "a balance ends a dose only where {option} says so; add it"
            )));
        }
        Ok(())
    }

    /// The options as they were typed, each with its value, so that another command can be told with them.
    pub(crate) fn typed(&self) -> Vec<(&'static str, String)> {
        let path = |path: &PathBuf| path.display().to_string();
        let typed = [
            ("--scale-port", self.scale_port.as_ref().map(path)),
            ("--scale-protocol", self.scale_protocol.map(|protocol| protocol.as_str().to_owned())),
            ("--scale-line", self.scale_line.map(|line| line.to_string())),
            ("--scale-wait", self.scale_wait.map(|wait_s| format!("{wait_s}s"))),
            ("--scale-command", self.scale_command.clone()),
        ];
        typed.into_iter().filter_map(|(option, value)| Some((option, value?))).collect()
    }

    /// True if a balance is named.
    pub(crate) fn is_given(&self) -> bool {
        self.scale_port.is_some() || self.scale_command.is_some()
    }

    /// The longest wait for the balance to stand still.
    pub(crate) fn longest_wait(&self) -> Duration {
        Duration::from_secs_f64(self.scale_wait.unwrap_or(STILL_S).min(MOST_WAIT_S))
    }

    /// Opens the balance that is named, or returns `None` if a person answers. The port of the pump's `board` is
    /// refused.
    pub(crate) fn open(&self, board: Option<&Path>) -> Result<Option<Box<dyn Balance>>, Failure> {
        if let Some(command) = &self.scale_command {
            return Ok(Some(Box::new(ProgramBalance::new(command.clone()))));
        }
        let Some(port) = &self.scale_port else { return Ok(None) };
        refuse_port_of_board(port, board).map_err(Failure::of)?;
        let protocol = self.scale_protocol.unwrap_or(Protocol::MtSics);
        let line = self.scale_line.unwrap_or(protocol.usual_line());
        let balance = SerialBalance::open(port, line, protocol).map_err(Failure::of)?;
        Ok(Some(Box::new(balance)))
    }
}

/// Reads a balance that stands still, with a sign of life.
pub(crate) fn read_still(balance: &mut dyn Balance, longest: Duration) -> Result<BalanceReading, Failure> {
    let sign = waiting("waiting for the balance to stand still");
    let found = balance.read_still(longest, &interrupt::stop_request());
    sign.finish_and_clear();
    found.map_err(Failure::of)
}
