//! A running process, the lines that it tells, and the word that stops it.

use std::io;
use std::path::PathBuf;

use pump_bench::shell::ask_to_end;
use serde_json::Value;
use tokio::io::{AsyncBufReadExt, AsyncRead, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStdin};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::{Instant, MissedTickBehavior, interval};

use super::line::Line;
use super::program::Program;
use super::report::{ended_by_service, killed, message_of};
use super::watch::{LOOK, Sign, Watch};

/// Longest line that a process may tell, in bytes.
const LONGEST_LINE: usize = 4 << 20;

/// End of a process.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// Exit code of the command; 1 if the process was killed.
    pub code: i32,
    /// Reason of the failure, `error/1`, if the command told one or was killed.
    pub error: Option<Value>,
    /// True if a signal has ended the process, so that it did nothing more.
    pub was_killed: bool,
}

/// Where a command is typed, and whether a person is there.
#[derive(Debug, Clone, Default)]
pub struct Seat {
    /// Folder of the files that its words name; that of the service without one.
    pub folder: Option<PathBuf>,
    /// True if a person sits at the terminal.
    pub is_attended: bool,
    /// True if the one who ordered is told of a refusal: the command of the configuration hears of faults alone.
    pub is_answered: bool,
    /// True if a dry run leaves the pump's record out: the order comes later.
    pub is_trial: bool,
    /// Order by which the process moves a pump, as the pump's log names it.
    pub order: Option<String>,
}

/// Word that stops a motion.
#[derive(Debug, Clone)]
pub struct Stop {
    /// Reason, as the log keeps it.
    pub reason: String,
    /// True if whoever stops is a person who sees the end: nobody else is told of it.
    pub is_seen: bool,
}

/// A line, and its text.
type Told = (Line, String);

/// Process that carries out an order.
#[derive(Debug)]
pub struct Worker {
    child: Child,
    input: Option<ChildStdin>,
    lines: UnboundedReceiver<Told>,
}

impl Worker {
    /// Starts the process of these words, typed at `seat`. It tells its progress.
    ///
    /// # Errors
    ///
    /// The system's error if the program cannot be started.
    pub fn start(program: &Program, words: &[String], seat: &Seat) -> io::Result<Self> {
        let mut command = program.command(words);
        if let Some(folder) = &seat.folder {
            command.current_dir(folder);
        }
        if seat.is_attended {
            command.env("DOSE_ATTENDED", "1");
        }
        if seat.is_answered {
            command.env("DOSE_ANSWERED", "1");
        }
        if seat.is_trial {
            command.env("DOSE_TRIAL", "1");
        }
        if let Some(order) = &seat.order {
            command.env("DOSE_ORDER", order);
        }
        let mut child = command.env("DOSE_SUPERVISED", "1").spawn()?;
        let (tell, lines) = unbounded_channel();
        if let Some(output) = child.stdout.take() {
            tokio::spawn(read(output, tell.clone(), Line::of_output));
        }
        if let Some(errors) = child.stderr.take() {
            tokio::spawn(read(errors, tell, Line::of_errors));
        }
        let input = child.stdin.take();
        Ok(Self { child, input, lines })
    }

    /// Returns the number of the process.
    pub fn process(&self) -> Option<u32> {
        self.child.id()
    }

    /// Carries the order out. `tell` hears each line, and its text; each of `stops` stops the motion for its
    /// reason.
    ///
    /// # Errors
    ///
    /// The system's error if the end of the process cannot be learned.
    pub async fn run(
        self,
        stops: UnboundedReceiver<Stop>,
        tell: impl FnMut(&Line, &str),
    ) -> io::Result<Ended> {
        self.run_watched(stops, tell, |_| {}).await
    }

    /// Carries the order out as [`Worker::run`] does. `sign` hears that the process is silent or does not answer a
    /// stop; such a one is ended.
    pub(crate) async fn run_watched(
        mut self,
        mut stops: UnboundedReceiver<Stop>,
        mut tell: impl FnMut(&Line, &str),
        mut sign: impl FnMut(Sign),
    ) -> io::Result<Ended> {
        let mut error = None;
        let mut can_stop = true;
        let mut watch = Watch::new(Instant::now());
        let mut looks = interval(LOOK);
        looks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                // Lines that wait are heard before the clock.
                biased;
                stop = stops.recv(), if can_stop => match stop {
                    Some(stop) => {
                        watch.stop(Instant::now());
                        self.stop(&stop).await;
                    }
                    None => can_stop = false,
                },
                line = self.lines.recv() => match line {
                    Some((line, text)) => {
                        watch.hear(&line, Instant::now()).into_iter().for_each(&mut sign);
                        tell(&line, &text);
                        if let Line::Error(value) | Line::Failed(value) = line {
                            error = Some(value);
                        }
                    }
                    None => break,
                },
                _ = looks.tick() => {
                    if let Some(told) = watch.look(Instant::now()) {
                        self.heed(told);
                        sign(told);
                    }
                }
            }
        }
        let status = self.child.wait().await?;
        let was_killed = status.code().is_none();
        if was_killed {
            let report = if watch.has_ended_it() { ended_by_service() } else { killed(status) };
            tell(&Line::Error(report.clone()), &format!("error: {}", message_of(&report)));
            error = Some(report);
        }
        Ok(Ended { code: status.code().unwrap_or(1), error, was_killed })
    }

    /// Ends a process that does not answer.
    fn heed(&mut self, sign: Sign) {
        match sign {
            Sign::Unanswered => self.child.id().into_iter().for_each(ask_to_end),
            // One that has ended meanwhile cannot be killed.
            Sign::Killed => drop(self.child.start_kill()),
            Sign::Silent(_) | Sign::Speaks | Sign::GoesOn => {}
        }
    }

    /// Stops the motion. A process that has ended hears nothing.
    async fn stop(&mut self, stop: &Stop) {
        let reason: String = stop.reason.chars().filter(|c| !c.is_control()).collect();
        if let Some(input) = &mut self.input {
            let seen = if stop.is_seen { "seen\n" } else { "" };
            let word = format!("{seen}stop {reason}\n");
            let written = input.write_all(word.as_bytes()).await;
            if written.is_err() || input.flush().await.is_err() {
                // The end of its input stops a process that reads no line.
                self.input = None;
            }
        }
    }
}

/// Tells each line until the end. A line that is too long is cut into pieces.
async fn read(from: impl AsyncRead + Unpin, tell: UnboundedSender<Told>, read: fn(&str) -> Line) {
    let mut from = BufReader::new(from);
    let mut line = Vec::new();
    loop {
        line.clear();
        let mut limited = tokio::io::AsyncReadExt::take(&mut from, LONGEST_LINE as u64);
        match limited.read_until(b'\n', &mut line).await {
            Ok(0) | Err(_) => return,
            Ok(_) => {
                let text = String::from_utf8_lossy(&line);
                let text = text.trim_end_matches(['\r', '\n']);
                if tell.send((read(text), text.to_owned())).is_err() {
                    return;
                }
            }
        }
    }
}
