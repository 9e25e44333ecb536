//! Someone who types commands into a folder of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// A bench of its own for each test.
pub(crate) struct User {
    pub folder: tempfile::TempDir,
}

pub(crate) struct Answer {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl User {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env_remove("DOSE_PUMP")
            .env_remove("DOSE_CONFIG");
        command.env("XDG_CONFIG_HOME", self.path("config"));
        // So wide that no line is wrapped: the tests look for words, help.rs for the width.
        command.env("DOSE_STATE_DIR", self.path("state")).env("COLUMNS", "1000");
        command
    }

    pub(crate) fn types(&self, arguments: &[&str]) -> Answer {
        let Output { status, stdout, stderr } = self.command(arguments).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Answer { code: status.code().unwrap(), out: text(stdout), err: text(stderr) }
    }

    /// Types a command that may take so many seconds of the processor, whatever else the machine does meanwhile.
    pub(crate) fn json_within_cpu_s(&self, limit_s: u32, arguments: &[&str]) -> Value {
        let command = self.command(&[arguments, &["--format", "json"]].concat());
        let mut limited = Command::new("sh");
        limited.args(["-c", &format!("ulimit -t {limit_s}; exec \"$0\" \"$@\"")]);
        limited.arg(command.get_program()).args(command.get_args()).current_dir(self.folder.path());
        limited.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
        let output = limited.env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG").output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    }

    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let answer = self.types(&[arguments, &["--format", "json"]].concat());
        assert_eq!(answer.code, 0, "{arguments:?}: {}", answer.err);
        serde_json::from_str(&answer.out).unwrap()
    }

    /// Refused with exit code 2, one message, no panic, nothing on standard output and nothing on record.
    pub(crate) fn is_refused(&self, arguments: &[&str]) -> String {
        let before = self.record();
        let answer = self.types(arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {}{}", answer.out, answer.err);
        assert_eq!(answer.out, "", "{arguments:?}");
        assert!(!answer.err.contains("panicked"), "{arguments:?}: {}", answer.err);
        assert_eq!(self.record(), before, "{arguments:?} changed the record");
        answer.err
    }

    pub(crate) fn record(&self) -> Option<String> {
        self.record_of("three-roller")
    }

    pub(crate) fn record_of(&self, pump: &str) -> Option<String> {
        fs::read_to_string(self.path(&format!("state/{pump}/sim/journal.jsonl"))).ok()
    }

    /// Waits until the last motion of a pump has steps on record. Its first progress comes before any step.
    pub(crate) fn until_moved(&self, pump: &str) {
        let moved = |text: &str| {
            let motion = text.rsplit("\"intent\"").next().unwrap();
            motion.lines().any(|line| line.contains("\"progress\"") && !line.contains("\"made\":0,"))
        };
        let deadline = Instant::now() + Duration::from_secs(120);
        while !self.record_of(pump).is_some_and(|text| moved(&text)) {
            assert!(Instant::now() < deadline, "no steps of {pump} on record");
            sleep(Duration::from_millis(2));
        }
    }
}

pub(crate) fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

pub(crate) fn rows(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    (header, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}
