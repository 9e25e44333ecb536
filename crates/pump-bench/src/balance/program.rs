//! A balance that a program of the user reads: it prints one mass.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::process::{ExitStatus, Stdio};
use std::time::Duration;

use super::words::shown_line;
use super::{Balance, BalanceError, BalanceReading, agreeing, printed_reading};
use crate::drives::StopRequest;
use crate::shell::{end_with_its_group, shell_command};

/// Time between two looks at the program.
const LOOK: Duration = Duration::from_millis(5);

/// End of the program's output that is read, in bytes.
const LAST_BYTES: u64 = 4096;

/// Longest output of a program that reads a balance, in bytes. One that prints more prints for ever.
const MOST_BYTES: u64 = 1 << 20;

/// Balance that a program reads. The last line that the program prints is the mass, with its unit.
///
/// The program prints at once what the balance shows. It is run until three readings in a row agree where the balance
/// is to stand still.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramBalance {
    command: String,
}

impl ProgramBalance {
    /// Returns a balance that this command reads. The system's shell runs it.
    pub fn new(command: impl Into<String>) -> Self {
        Self { command: command.into() }
    }

    fn failed(&self, source: std::io::Error) -> BalanceError {
        BalanceError::Program { command: self.command.clone(), source }
    }

    /// Runs the program once. A program that does not end within `longest`, and all that it has started, is ended.
    fn run(&self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        let failed = |error| self.failed(error);
        // Files take any amount of output, so that the program never waits for this one to read.
        let [mut out, mut err] =
            [tempfile::tempfile().map_err(failed)?, tempfile::tempfile().map_err(failed)?];
        let mut shell = shell_command(&self.command);
        shell.stdin(Stdio::null());
        shell.stdout(out.try_clone().map_err(failed)?).stderr(err.try_clone().map_err(failed)?);
        let mut child = shell.spawn().map_err(failed)?;
        // A busy computer gives the program less time too, so that only waits count.
        let mut waited = Duration::ZERO;
        let status = loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            let prints_on = [&out, &err].iter().any(|file| length(file) > MOST_BYTES);
            let why = if stop.is_made() {
                Some(BalanceError::Stopped)
            } else if prints_on {
                Some(self.ended_badly("it prints without end"))
            } else {
                (waited >= longest).then_some(BalanceError::Silent { within: longest })
            };
            if let Some(why) = why {
                end_with_its_group(&mut child);
                return Err(why);
            }
            std::thread::sleep(LOOK);
            waited += LOOK;
        };
        self.reading(status, last_line(&mut out).map_err(failed)?, last_line(&mut err).map_err(failed)?)
    }

    fn reading(
        &self,
        status: ExitStatus,
        said: String,
        complaint: String,
    ) -> Result<BalanceReading, BalanceError> {
        if status.success() {
            printed_reading(&said)
        } else {
            let complaint = if complaint.is_empty() { complaint } else { format!("; {complaint}") };
            Err(self.ended_badly(&format!("{status}{complaint}")))
        }
    }

    fn ended_badly(&self, said: &str) -> BalanceError {
        BalanceError::ProgramFailed { command: self.command.clone(), said: said.to_owned() }
    }
}

/// Length of a file. 0 where nobody can tell.
fn length(file: &File) -> u64 {
    file.metadata().map_or(0, |data| data.len())
}

/// Reads the last line of a file that is not empty.
fn last_line(file: &mut File) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(length(file).saturating_sub(LAST_BYTES)))?;
    file.take(LAST_BYTES).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.lines().rfind(|line| !line.trim().is_empty()).map(shown_line).unwrap_or_default())
}

impl Balance for ProgramBalance {
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        agreeing(longest, stop, || self.run(longest, stop))
    }

    fn read_now(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        self.run(longest, stop)
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
        let bare = read("echo 23.45").unwrap_err().to_string();
        assert!(bare.contains("`23.45`, a number without a unit; print `23.45 g`"), "{bare}");
        assert!(read("true").unwrap_err().to_string().contains("no mass"));
        assert!(read("echo no cable >&2; exit 3").unwrap_err().to_string().contains("no cable"));
        let silent = read("exit 3").unwrap_err().to_string();
        assert!(silent.ends_with("failed: exit status: 3"), "{silent}");
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

    #[test]
    fn a_program_that_prints_for_ever_is_ended_with_all_that_it_started() {
        let error = read("yes 1 g | tee /dev/stderr").unwrap_err().to_string();
        assert!(error.contains("it prints without end"), "{error}");
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let command = format!("sleep 600 & echo $! > '{0}.new'; mv '{0}.new' '{0}'; wait", pid.display());
        let (asked, begun) = (pid.clone(), StopRequest::new(move || pid.exists()));
        let stopped = ProgramBalance::new(command).read_still(Duration::from_secs(500), &begun);
        assert!(matches!(stopped, Err(BalanceError::Stopped)));
        let sleeps: i32 = std::fs::read_to_string(asked).unwrap().trim().parse().unwrap();
        let sleeps = rustix::process::Pid::from_raw(sleeps).unwrap();
        // It is ended, and soon is no process any more.
        let began = Instant::now();
        while rustix::process::test_kill_process(sleeps).is_ok() && !is_dead(sleeps) {
            assert!(began.elapsed() < Duration::from_secs(120));
            std::thread::sleep(LOOK);
        }
    }

    /// True for a process that ended and whose parent has not asked for its end.
    fn is_dead(pid: rustix::process::Pid) -> bool {
        let path = format!("/proc/{}/stat", pid.as_raw_nonzero());
        std::fs::read_to_string(path).is_ok_and(|stat| stat.contains(") Z "))
    }

    #[test]
    fn a_program_gives_no_reading_while_the_balance_settles() {
        let folder = tempfile::tempdir().unwrap();
        let runs = folder.path().join("runs");
        let command = format!(
            "echo >> '{0}'; n=$(wc -l < '{0}'); if [ $n -gt 4 ]; then n=5; fi; echo 1$n.00 g",
            runs.display()
        );
        assert_eq!(read(&command).unwrap().mass_g, 15.0);
        // A dose by weight asks for what it shows now.
        std::fs::remove_file(&runs).unwrap();
        let now =
            ProgramBalance::new(command).read_now(Duration::from_secs(120), &StopRequest::default()).unwrap();
        assert_eq!(now.mass_g, 11.0);
    }
}
