//! Claims about doses on real firmware that runs in a simulator on this machine.
//!
//! `GRBL_SIM` and `GRBLHAL_SIM` name the programs; otherwise `grbl_sim` and `grblHAL_sim` are looked for in
//! PATH. Such a program speaks on its standard input and output. It is put at the end of a pseudo-terminal here.

use std::env;
use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::built_in;
use pump_bench::drives::{Drive, Grbl, Leave, Opening};
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_ctl::plan::{Cruise, Doser, Phase, Request};
use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;

/// Environment variables and programs of the firmwares.
const SIMULATORS: [(&str, &str); 2] = [("GRBL_SIM", "grbl_sim"), ("GRBLHAL_SIM", "grblHAL_sim")];

/// Doses `runs` times on each simulator that this machine has, and stops every second dose on its way.
pub(crate) fn run(runs: u32) {
    for (variable, name) in SIMULATORS {
        match program(variable, name) {
            Some(program) if runs > 0 => doses(&program, runs),
            Some(program) => println!("{} is left to `make faults`", program.display()),
            None => println!("{name} is skipped: neither {variable} nor PATH has it"),
        }
    }
}

fn program(variable: &str, name: &str) -> Option<PathBuf> {
    if let Some(named) = env::var_os(variable) {
        return Some(named.into());
    }
    let folders = env::var_os("PATH")?;
    env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file())
}

/// Simulator at the end of a pseudo-terminal, until it is dropped.
struct Simulator {
    child: Child,
    path: PathBuf,
    /// Port that stays open, so that the line does not hang up between two programs.
    _open: OwnedFd,
}

impl Simulator {
    fn start(program: &Path) -> Self {
        let line =
            rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        rustix::pty::grantpt(&line).unwrap();
        rustix::pty::unlockpt(&line).unwrap();
        let name = rustix::pty::ptsname(&line, Vec::new()).unwrap();
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        let open = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty());
        let started = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = started.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let line = File::from(line);
        let answers = line.try_clone().unwrap();
        let (stdin, stdout) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        copy(stdout, answers);
        copy(line, stdin);
        Self { child, path, _open: open.unwrap() }
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Copies bytes as they come, in a thread of its own.
fn copy(mut from: impl Read + Send + 'static, mut to: impl Write + Send + 'static) {
    thread::spawn(move || {
        let mut bytes = [0; 256];
        while let Ok(count) = from.read(&mut bytes) {
            if count == 0 || to.write_all(&bytes[..count]).and_then(|()| to.flush()).is_err() {
                return;
            }
        }
    });
}

/// Longest wait for the version of a firmware.
const VERSION_LIMIT: Duration = Duration::from_secs(5);

/// Asks the firmware at a port for its version, `[VER:1.1h.20190830:]`.
fn version(port: &Path) -> Option<String> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
    let mut line = File::from(rustix::fs::open(port, flags, Mode::empty()).ok()?);
    let until = Instant::now() + VERSION_LIMIT;
    let mut said = String::new();
    line.write_all(b"\n$I\n").ok()?;
    while Instant::now() < until {
        let mut bytes = [0; 256];
        match line.read(&mut bytes) {
            Ok(count) if count > 0 => said.push_str(&String::from_utf8_lossy(&bytes[..count])),
            _ => thread::sleep(Duration::from_millis(10)),
        }
        if let Some(found) = said.lines().find(|line| line.starts_with("[VER:") && line.ends_with(']')) {
            return Some(found.to_owned());
        }
    }
    None
}

fn doses(program: &Path, runs: u32) {
    let simulator = Simulator::start(program);
    let firmware = version(&simulator.path).unwrap_or_else(|| "a firmware that tells no version".to_owned());
    println!("{} is {firmware}", program.display());
    let file = built_in("three-roller").unwrap();
    let table = DriveTable::of(DriverName::Grbl).with_port(&simulator.path);
    let opening = Opening { configure: true, ..Opening::default() };
    let mut grbl = Grbl::open(&table, &file.motor, &opening).unwrap();
    let mut limits = file.limits();
    let allowed = grbl.limits().unwrap();
    limits.motor.max_acceleration_rad_s2 = allowed.acceleration_rad_s2.unwrap();
    limits.motor.max_speed_rad_s = limits.motor.max_speed_rad_s.min(allowed.max_speed_rad_s);
    let mut count = grbl.count().unwrap();
    for run in 0..runs {
        let volume_ml = if run % 3 == 2 { -1.0 } else { 1.0 + 0.1 * f64::from(run % 7) };
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: 3.0 });
        let plan =
            Doser::new(&file.model().unwrap(), limits).unwrap().plan(Phase::known(0.4), &request).unwrap();
        let stops_at = if run % 2 == 1 { 50 * u64::from(1 + run) } else { u64::MAX };
        let made = grbl.run(&plan, &mut |made, _| {
            if made >= stops_at { Leave::Stop } else { Leave::Go }
        });
        let made = made.unwrap_or_else(|fault| panic!("{}: dose {run}: {fault:?}", program.display()));
        assert!(made == plan.steps().unsigned_abs() || stops_at < u64::MAX);
        count += plan.steps().signum() * made as i64;
        assert_eq!(grbl.count(), Some(count), "dose {run}");
        assert_eq!(grbl.disturbed(), None, "dose {run}");
    }
    println!("{runs} doses on {firmware} ({}): every step counted", program.display());
}
