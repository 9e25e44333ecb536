//! A balance that a program of the user reads: it prints one mass.

use std::io::{Read, Seek};
use std::process::{Command, Stdio};
use std::time::Duration;

use super::words::shown_line;
use super::{Balance, BalanceError, BalanceReading, printed_reading};
use crate::drives::StopRequest;

/// Time between two looks at the program.
const LOOK: Duration = Duration::from_millis(20);

/// Longest output of the program that is read, in bytes.
const MOST_BYTES: u64 = 4096;

/// Balance that a program reads. The last line that the program prints is the mass, with its unit.
///
/// The program waits by itself until the balance stands still.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramBalance {
    command: String,
}

impl ProgramBalance {
    /// Returns a balance that this command reads. The system's shell runs it.
    pub fn new(command: impl Into<String>) -> Self {
        Self { command: command.into() }
    }

    fn shell(&self) -> Command {
        let (shell, flag) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
        let mut command = Command::new(shell);
        command.args([flag, &self.command]).stdin(Stdio::null());
        command
    }

    fn failed(&self, source: std::io::Error) -> BalanceError {
        BalanceError::Program { command: self.command.clone(), source }
    }
}

impl Balance for ProgramBalance {
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        let failed = |error| self.failed(error);
        // Files take any amount of output, so that the program never waits for this one to read.
        let [mut out, mut err] =
            [tempfile::tempfile().map_err(failed)?, tempfile::tempfile().map_err(failed)?];
        let mut child = self
            .shell()
            .stdout(out.try_clone().map_err(failed)?)
            .stderr(err.try_clone().map_err(failed)?)
            .spawn()
            .map_err(failed)?;
        // A busy computer gives the program less time too, so that only waits count.
        let mut waited = Duration::ZERO;
        let status = loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            let is_stopped = stop.is_made();
            if is_stopped || waited >= longest {
                // The program is this process's own, and it is of no use any more.
                let _ = child.kill().and_then(|()| child.wait().map(drop));
                return Err(if is_stopped {
                    BalanceError::Stopped
                } else {
                    BalanceError::Silent { within: longest }
                });
            }
            std::thread::sleep(LOOK);
            waited += LOOK;
        };
        let text = |file: &mut std::fs::File| {
            let mut bytes = Vec::new();
            file.rewind().and_then(|()| file.take(MOST_BYTES).read_to_end(&mut bytes)).map_err(failed)?;
            Ok(String::from_utf8_lossy(&bytes).into_owned())
        };
        let (said, complaint) = (text(&mut out)?, text(&mut err)?);
        let last = |text: &str| {
            text.lines().rfind(|line| !line.trim().is_empty()).map(shown_line).unwrap_or_default()
        };
        if !status.success() {
            let said = format!("{status}; {}", last(&complaint));
            return Err(BalanceError::ProgramFailed { command: self.command.clone(), said });
        }
        printed_reading(&last(&said))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::time::Instant;

    use super::*;

    fn read_within(longest: Duration, command: &str) -> Result<BalanceReading, BalanceError> {
        ProgramBalance::new(command).read_still(longest, &StopRequest::default())
    }

    /// Reads from a program that ends by itself, however busy the machine is.
    fn read(command: &str) -> Result<BalanceReading, BalanceError> {
        read_within(Duration::from_secs(120), command)
    }

    #[test]
    fn the_last_line_of_the_program_is_the_mass() {
        assert_eq!(read("echo warming up; echo ' 23.45 g'").unwrap().mass_g, 23.45);
        assert!(read("echo 23.45").unwrap_err().to_string().contains("`23.45`, which is no mass"));
        assert!(read("true").unwrap_err().to_string().contains("no mass"));
        assert!(read("echo no cable >&2; exit 3").unwrap_err().to_string().contains("no cable"));
    }

    #[test]
    fn a_program_that_does_not_end_is_left_and_a_stop_is_heard() {
        let silent = read_within(Duration::from_millis(300), "exec sleep 600");
        assert!(matches!(silent, Err(BalanceError::Silent { .. })));
        let began = Instant::now();
        let stop = StopRequest::new(|| true);
        let stopped = ProgramBalance::new("exec sleep 600").read_still(Duration::from_secs(500), &stop);
        assert!(matches!(stopped, Err(BalanceError::Stopped)) && began.elapsed() < Duration::from_secs(120));
    }
}
