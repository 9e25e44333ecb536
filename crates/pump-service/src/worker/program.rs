//! The command as a program that the service starts.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Stdio;

use tokio::process::Command;

/// Variables by which the allocator of the GNU C library gives freed memory back to the system. Clap's definitions take
/// a megabyte while a process reads its words, and each pump that moves has a process. Other C libraries ignore them.
const MEMORY: [(&str, &str); 3] =
    [("MALLOC_MMAP_THRESHOLD_", "4096"), ("MALLOC_TRIM_THRESHOLD_", "0"), ("MALLOC_TOP_PAD_", "0")];

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
        command.env("DOSE_SERVICE", "off").env_remove("DOSE_PUMP").envs(MEMORY);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // A Ctrl-C at the service's terminal reaches the service alone, which stops its pumps in order.
        #[cfg(unix)]
        command.process_group(0);
        command
    }
}
