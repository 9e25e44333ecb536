//! The command as a program that the service starts.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Stdio;

use tokio::process::Command;

/// The command, and the environment that each of its processes has: where configuration and records are.
#[derive(Debug, Clone)]
pub struct Program {
    path: PathBuf,
    environment: Vec<(&'static str, OsString)>,
}

impl Program {
    /// Names the program at `path`, and variables that its processes have beside those of the service.
    pub fn new(path: PathBuf, environment: Vec<(&'static str, OsString)>) -> Self {
        Self { path, environment }
    }

    /// Returns the process of these words, which is not started yet. It is no process of a terminal, and asks nothing.
    pub fn command(&self, words: &[String]) -> Command {
        let mut command = Command::new(&self.path);
        command.args(words).envs(self.environment.iter().map(|(name, value)| (name, value)));
        // The process acts by itself, even where its configuration names a service.
        command.env("DOSE_SERVICE", "off").env_remove("DOSE_PUMP");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // A Ctrl-C at the service's terminal reaches the service alone, which stops its pumps in order.
        #[cfg(unix)]
        command.process_group(0);
        command
    }
}
