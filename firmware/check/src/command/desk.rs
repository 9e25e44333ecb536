//! A computer with the command `dose`, a folder of records, and the emulated board at a port.

use std::error::Error;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::drives::wire::Wire;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tempfile::TempDir;

use super::bridge::Bridge;
use crate::board::emulator::{Edge, Emulator};
use crate::board::motor::Motor;

/// Longest time of a command, by the computer's clock. A dose of this part takes some seconds.
const LIMIT: Duration = Duration::from_secs(180);

/// Time between two looks at a process or at the board.
const LOOK: Duration = Duration::from_millis(5);

/// Time of the board without a step after which its motor stands, in ns.
const STANDS_NS: f64 = 1e9;

/// Computer with the command and a board.
pub(super) struct Desk {
    command: PathBuf,
    folder: TempDir,
    pub(super) bridge: Bridge,
    pub(super) emulator: Emulator,
    pub(super) motor: Motor,
    /// Edges of the board since they were taken.
    edges: Vec<Edge>,
}

/// Command that has ended.
#[derive(Debug)]
pub(super) struct Ended {
    /// Exit code. A killed process has none.
    pub(super) code: Option<i32>,
    /// Report.
    pub(super) report: Value,
    pub(super) error: String,
}

impl Desk {
    /// Makes a computer with a board that was just switched on, with these options of the emulator.
    pub(super) fn new(firmware: &Path, command: &Path, options: &[&str]) -> Result<Self, Box<dyn Error>> {
        let emulator = Emulator::with_options(firmware, options)?;
        let bridge = Bridge::new(emulator.clone())?;
        let (motor, folder) = (Motor::default(), tempfile::tempdir()?);
        Ok(Self { command: command.to_owned(), folder, bridge, emulator, motor, edges: Vec::new() })
    }

    /// Returns the path of a file in the folder.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Starts the command with these words.
    pub(super) fn start(&mut self, words: &[&str]) -> Result<Child, Box<dyn Error>> {
        let mut command = Command::new(&self.command);
        for name in ["DOSE_PUMP", "DOSE_CONFIG", "DOSE_STATE_DIR"] {
            command.env_remove(name);
        }
        command.env("XDG_CONFIG_HOME", self.folder.path());
        command.args(words).args(["--driver", "node", "--port"]).arg(self.bridge.port());
        command.arg("--state-dir").arg(self.file("records")).stdin(Stdio::null());
        command.stdout(File::create(self.file("report"))?).stderr(File::create(self.file("error"))?);
        let process = command.spawn()?;
        self.bridge.set_host(Some(process.id()));
        Ok(process)
    }

    /// Waits for the end of a command.
    pub(super) fn end(&mut self, mut process: Child) -> Result<Ended, Box<dyn Error>> {
        let until = Instant::now() + LIMIT;
        let status = loop {
            if let Some(status) = process.try_wait()? {
                break status;
            }
            if Instant::now() > until || !self.bridge.is_live() {
                let _ = process.kill();
                process.wait()?;
                return Err(format!("the command did not end: {}", self.said()).into());
            }
            thread::sleep(LOOK);
        };
        self.bridge.set_host(None);
        self.look();
        let report = serde_json::from_str(&fs::read_to_string(self.file("report"))?).unwrap_or_default();
        Ok(Ended { code: status.code(), report, error: fs::read_to_string(self.file("error"))? })
    }

    /// Runs the command to its end.
    pub(super) fn run(&mut self, words: &[&str]) -> Result<Ended, Box<dyn Error>> {
        let process = self.start(words)?;
        self.end(process)
    }

    /// Runs a command that must end well.
    pub(super) fn run_well(&mut self, words: &[&str]) -> Result<Value, Box<dyn Error>> {
        let ended = self.run(words)?;
        if ended.code == Some(0) {
            return Ok(ended.report);
        }
        Err(format!("`dose {}` ended with {:?}: {}", words.join(" "), ended.code, ended.error).into())
    }

    /// Waits until the motor has made so many steps more.
    pub(super) fn until_steps(&mut self, process: &mut Child, steps: i64) -> Result<(), Box<dyn Error>> {
        let (from, until) = (self.motor.count, Instant::now() + LIMIT);
        while self.motor.count < from + steps {
            let has_ended = process.try_wait()?.is_some();
            if has_ended || Instant::now() > until {
                let _ = process.kill();
                process.wait()?;
                return Err(format!("the motor does not come to {steps} steps: {}", self.said()).into());
            }
            thread::sleep(LOOK);
            self.look();
        }
        Ok(())
    }

    /// Waits until the motor stands.
    pub(super) fn until_it_stands(&mut self) -> Result<(), Box<dyn Error>> {
        let until = Instant::now() + LIMIT;
        while self.emulator.shared().machine.time_ns() < self.motor.turned_ns + STANDS_NS {
            if Instant::now() > until || !self.bridge.is_live() {
                return Err("the motor does not come to rest".into());
            }
            thread::sleep(LOOK);
            self.look();
        }
        Ok(())
    }

    /// Pulls the cable, without which the board goes on for so long.
    pub(super) fn pull(&mut self, time: Duration) {
        self.bridge.pull();
        self.emulator.sleep(time);
        self.look();
    }

    /// Plugs the cable in again. The computer gives the board a device of another name.
    pub(super) fn plug_in(&mut self) -> Result<(), Box<dyn Error>> {
        self.bridge = Bridge::new(self.emulator.clone())?;
        Ok(())
    }

    /// Takes the edges since the last call.
    pub(super) fn take_edges(&mut self) -> Vec<Edge> {
        self.look();
        std::mem::take(&mut self.edges)
    }

    /// Turns the motor by the edges that have come.
    fn look(&mut self) {
        let edges = self.emulator.take_edges();
        self.motor.turn(&edges);
        self.edges.extend(edges);
    }

    fn said(&self) -> String {
        fs::read_to_string(self.file("error")).unwrap_or_default()
    }
}

/// Sends a signal to a command.
pub(super) fn signal(process: &Child, signal: Signal) -> Result<(), Box<dyn Error>> {
    let id = i32::try_from(process.id()).ok().and_then(Pid::from_raw).ok_or("the process has no number")?;
    Ok(kill_process(id, signal)?)
}
