//! Someone who answers questions, in a folder of their own.

use std::fs;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longest time for one question.
const LIMIT: Duration = Duration::from_secs(120);

/// Setup of a bought head of half a millilitre and four rollers, as a script says it.
pub(crate) const ACID: [&str; 7] = ["setup", "acid", "--rollers", "4", "--ml-per-rev", "0.5mL", "--yes"];

/// A desk with its configuration and its records.
pub(crate) struct Desk {
    folder: tempfile::TempDir,
    /// Process of the command that was typed last.
    pub(crate) process: AtomicU32,
}

/// End of a command.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
    /// Questions in their order.
    pub(crate) asked: Vec<String>,
}

/// Reaction to a question. `None` ends the answers.
pub(crate) type Reaction<'a> = dyn FnMut(&str) -> Option<String> + 'a;

impl Desk {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), process: AtomicU32::new(0) }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        command.args(words).current_dir(self.folder.path());
        command.env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG");
        command.env("XDG_CONFIG_HOME", self.path("config")).env("DOSE_STATE_DIR", self.path("state"));
        command.env("COLUMNS", "1000");
        command
    }

    /// Types a command that asks nothing.
    pub(crate) fn types(&self, words: &[&str]) -> Ended {
        self.answers(words, &mut |_| None)
    }

    pub(crate) fn json(&self, words: &[&str]) -> serde_json::Value {
        let ended = self.types(&[words, &["--format", "json"]].concat());
        assert_eq!(ended.code, 0, "{words:?}: {}", ended.err);
        serde_json::from_str(&ended.out).unwrap()
    }

    /// Types a command and answers its questions.
    pub(crate) fn answers(&self, words: &[&str], react: &mut Reaction<'_>) -> Ended {
        let mut command = self.command(words);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        self.process.store(child.id(), Ordering::SeqCst);
        let out = pieces(child.stdout.take().unwrap());
        let err = pieces(child.stderr.take().unwrap());
        let mut input = child.stdin.take();
        let (mut said, mut asked, mut seen) = (String::new(), Vec::new(), 0);
        let mut deadline = Instant::now() + LIMIT;
        loop {
            match err.recv_timeout(Duration::from_millis(20)) {
                Ok(piece) => said.push_str(&piece),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if Instant::now() > deadline {
                child.kill().unwrap();
                panic!("no end and no question: {said}");
            }
            if said.len() > seen && said.ends_with(": ") {
                let question = said.lines().next_back().unwrap().to_owned();
                seen = said.len();
                deadline = Instant::now() + LIMIT;
                match react(&question) {
                    Some(answer) => writeln!(input.as_mut().unwrap(), "{answer}").unwrap(),
                    None => drop(input.take()),
                }
                asked.push(question);
            }
        }
        drop(input);
        let code = wait(&mut child);
        Ended { code, out: out.iter().collect(), err: said, asked }
    }

    /// Text of a file of the configuration.
    pub(crate) fn configured(&self, name: &str) -> Option<String> {
        fs::read_to_string(self.path("config/pump-dose").join(name)).ok()
    }

    /// Text of the journal of a pump.
    pub(crate) fn journal(&self, pump: &str, driver: &str) -> Option<String> {
        fs::read_to_string(self.path("state").join(pump).join(driver).join("journal.jsonl")).ok()
    }
}

/// Answers by parts of questions. A question without an answer takes the one that is suggested.
pub(crate) fn by_part<'a>(answers: &'a [(&'a str, &'a str)]) -> impl FnMut(&str) -> Option<String> + 'a {
    |question| {
        let answer = answers.iter().find(|(part, _)| question.contains(part));
        Some(answer.map_or(String::new(), |(_, answer)| (*answer).to_owned()))
    }
}

pub(crate) fn pieces(mut from: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, pieces) = channel();
    thread::spawn(move || {
        let (mut buffer, mut rest) = ([0; 4096], Vec::new());
        while let Ok(count @ 1..) = from.read(&mut buffer) {
            rest.extend_from_slice(&buffer[..count]);
            let whole = match std::str::from_utf8(&rest) {
                Ok(text) => text.len(),
                Err(error) => error.valid_up_to(),
            };
            let text = String::from_utf8(rest.drain(..whole).collect()).unwrap();
            if sender.send(text).is_err() {
                return;
            }
        }
    });
    pieces
}

fn wait(child: &mut Child) -> i32 {
    child.wait().unwrap().code().unwrap_or(-1)
}
