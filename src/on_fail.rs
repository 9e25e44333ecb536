//! The command of the shell that is run once a dose has failed: it tells a person.

use std::env;
use std::io::{self, Write};
use std::path::Path;
use std::process::{ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::report::ErrorKind;
use pump_bench::shell::{end_with_its_group, shell_command};

use crate::failure::Failure;
use crate::progress::supervised;
use crate::terminal::warn;

/// Longest time that the command has.
const LONGEST: Duration = Duration::from_secs(10);

/// Time between two looks at the command.
const LOOK: Duration = Duration::from_millis(20);

/// A command of the shell that is run once a dose has failed.
#[derive(Debug, Clone)]
pub(crate) struct OnFail {
    command: String,
    /// The pump's name.
    pump: String,
    /// The rack's name; none for a pump by itself.
    rack: Option<String>,
    /// True if a refusal is told by the program that ordered.
    only_faults: bool,
}

impl OnFail {
    pub(crate) fn new(command: &str, pump: &str) -> Self {
        Self { command: command.to_owned(), pump: pump.to_owned(), rack: None, only_faults: false }
    }

    /// The command for faults alone, where the supervising program tells who ordered of a refusal.
    pub(crate) fn unless_answered(self) -> Self {
        Self { only_faults: env::var_os("DOSE_ANSWERED").is_some(), ..self }
    }

    /// The command for the failure of a rack, which is named by its file or by its name in the configuration. The pump
    /// is then the one that failed.
    pub(crate) fn of_rack(self, named: &str) -> Self {
        let stem = Path::new(named).file_stem().map_or(named.into(), |stem| stem.to_string_lossy());
        Self { pump: String::new(), rack: Some(stem.into_owned()), ..self }
    }

    /// Runs the command with the reason of a failure. Its own failure is a warning: the dose has failed anyway.
    pub(crate) fn tell(&self, failure: &Failure) {
        let is_stop = failure.kind_word() == ErrorKind::Stopped.as_str();
        if self.only_faults && failure.is_any_refusal() || is_stop && supervised::is_seen() {
            return;
        }
        let warned = match self.run(failure) {
            Ok(Some(status)) if status.success() => return,
            Ok(Some(status)) => format!("ended with {status}"),
            Ok(None) => format!("was ended after {} s", LONGEST.as_secs()),
            Err(error) => format!("could not be run: {error}"),
        };
        warn(&[format!("the command of --on-fail, `{}`, {warned}", self.command)]);
    }

    /// Runs the command. Returns none if it was ended because it took too long.
    fn run(&self, failure: &Failure) -> io::Result<Option<ExitStatus>> {
        let (least_ml, most_ml) = failure
            .delivered_ml()
            .map_or((String::new(), String::new()), |(least, most)| (least.to_string(), most.to_string()));
        let mut child = shell_command(&self.command)
            .env("DOSE_FAIL_PUMP", failure.pump().unwrap_or(&self.pump))
            .env("DOSE_FAIL_RACK", self.rack.as_deref().unwrap_or_default())
            .env("DOSE_FAIL_CODE", failure.exit_code().to_string())
            .env("DOSE_FAIL_KIND", failure.kind_word())
            .env("DOSE_FAIL_LEAST_ML", least_ml)
            .env("DOSE_FAIL_MOST_ML", most_ml)
            .stdin(Stdio::piped())
            // Reports alone go to standard output.
            .stdout(io::stderr())
            .spawn()?;
        if let Some(mut to) = child.stdin.take() {
            // A command that reads nothing may have ended. A reason is shorter than what a pipe holds.
            let _ = to.write_all((failure.json() + "\n").as_bytes());
        }
        let until = Instant::now() + LONGEST;
        while Instant::now() < until {
            if let Some(status) = child.try_wait()? {
                return Ok(Some(status));
            }
            sleep(LOOK);
        }
        end_with_its_group(&mut child);
        Ok(None)
    }
}
