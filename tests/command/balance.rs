//! Calibrations and verifications with a balance under the vessel, at a pseudo-terminal or read by a program.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use crate::user::{User, number};

/// True volume over the model's of the pump whose fluid is weighed.
const KAPPA: f64 = 1.04;

/// Volume of 1 g on a balance in air, as in `calibrate_last`, mL.
const Z_ML_G: f64 = 1.003_84;

/// How the balance speaks.
#[derive(Clone, Copy, PartialEq)]
enum Speech {
    MtSics,
    Sbi,
    Garbage,
    Silent,
    NeverStill,
}

/// A balance at a pseudo-terminal. It shows the volume that the record of the pump counts, times [`KAPPA`].
struct SimulatedBalance {
    path: String,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedBalance {
    fn start(journal: PathBuf, speech: Speech) -> Self {
        let terminal = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&terminal).unwrap();
        unlockpt(&terminal).unwrap();
        let path = ptsname(&terminal, Vec::new()).unwrap().into_string().unwrap();
        // An open handle keeps the terminal alive between two commands.
        let held = fs::File::options().read(true).write(true).open(&path).unwrap();
        let mut attributes = rustix::termios::tcgetattr(&held).unwrap();
        attributes.make_raw();
        rustix::termios::tcsetattr(&held, rustix::termios::OptionalActions::Now, &attributes).unwrap();
        rustix::io::ioctl_fionbio(&terminal, true).unwrap();
        let ends = Arc::new(AtomicBool::new(false));
        let (stop, mut line) = (Arc::clone(&ends), fs::File::from(terminal));
        let thread = spawn(move || {
            let _held = held;
            let (mut said, mut moves) = (Vec::new(), 1);
            let deadline = Instant::now() + Duration::from_secs(60);
            while !stop.load(Ordering::Relaxed) && Instant::now() < deadline {
                let mut buffer = [0; 64];
                let count = line.read(&mut buffer).unwrap_or(0);
                said.extend_from_slice(&buffer[..count]);
                let Some(end) = said.iter().position(|byte| *byte == b'\n') else {
                    std::thread::sleep(Duration::from_millis(2));
                    continue;
                };
                let question: Vec<u8> = said.drain(..=end).collect();
                // It needs two questions to come to rest.
                let is_still = moves % 3 == 0;
                moves += 1;
                let answer = answer(&question, speech, weighed_g(&journal), is_still);
                let _ = line.write_all(answer.as_bytes());
            }
        });
        Self { path, ends, thread: Some(thread) }
    }
}

impl Drop for SimulatedBalance {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn answer(question: &[u8], speech: Speech, mass_g: f64, is_still: bool) -> String {
    match (speech, question) {
        (Speech::MtSics, b"SI\r\n") => format!("S {} {mass_g:>10.2} g\r\n", if is_still { 'S' } else { 'D' }),
        (Speech::NeverStill, b"SI\r\n") => format!("S D {mass_g:>10.2} g\r\n"),
        (Speech::Sbi, b"\x1bP\r\n") => {
            format!("+{mass_g:>10.2} {}\r\n", if is_still { "g  " } else { "   " })
        }
        (Speech::Garbage, _) => "S S  \u{fffd}\u{7}12,3,4 oz\r\n".to_owned(),
        (Speech::Silent, _) => String::new(),
        _ => "ES\r\n".to_owned(),
    }
}

/// Returns what stands on the balance: a vessel of 50 g and what the pump has delivered.
fn weighed_g(journal: &Path) -> f64 {
    let text = fs::read_to_string(journal).unwrap_or_default();
    let volume = text.rfind("\"volume_ml\":").map(|at| &text[at + 12..]);
    let volume_ml = volume.and_then(|text| text.split([',', '}']).next()?.parse::<f64>().ok()).unwrap_or(0.0);
    50.0 + volume_ml * KAPPA / Z_ML_G
}

fn journal(user: &User) -> PathBuf {
    user.path("state/three-roller/sim/journal.jsonl")
}

#[test]
fn a_balance_at_a_serial_port_calibrates_without_a_hand() {
    for (speech, options) in
        [(Speech::MtSics, vec![]), (Speech::Sbi, vec!["--scale-protocol", "sbi", "--scale-line", "9600,8N1"])]
    {
        let user = User::new();
        let balance = SimulatedBalance::start(journal(&user), speech);
        let run = ["calibrate", "run", "--speeds", "10rpm,40rpm,100rpm", "--runs", "1", "--volume", "20mL"];
        let found = user.json(&[&run[..], &["--scale-port", &balance.path], &options].concat());
        let factor = number(&found["displacement"], "factor");
        assert!((factor - KAPPA).abs() < 6e-4, "{factor}");
        assert_eq!(found["runs"].as_array().unwrap().len(), 3);
    }
}

#[test]
fn a_program_that_prints_the_mass_serves_as_a_balance() {
    let user = User::new();
    // The program finds the volume on record and turns it into grams.
    let path = journal(&user);
    let script = format!(
        "v=$(grep -o '\"volume_ml\":[0-9.e-]*' {} 2>/dev/null | tail -1 | cut -d: -f2); \
         awk \"BEGIN {{ printf \\\"%.3f g\\\\n\\\", ${{v:-0}} * {KAPPA} / {Z_ML_G} }}\"",
        path.display()
    );
    let verify =
        ["calibrate", "verify", "--volume", "5mL", "--runs", "3", "--systematic", "5%", "--random", "1%"];
    let found = user.json(&[&verify[..], &["--scale-command", &script]].concat());
    assert!((number(&found, "systematic_percent") - 100.0 * (KAPPA - 1.0)).abs() < 0.1, "{found}");
}

#[test]
fn a_balance_that_cannot_be_read_moves_nothing() {
    let run = ["calibrate", "run", "--speeds", "10rpm", "--runs", "1"];
    for (speech, part) in [(Speech::Garbage, "which is no mass"), (Speech::Silent, "said nothing")] {
        let user = User::new();
        let balance = SimulatedBalance::start(journal(&user), speech);
        let patience = ["--scale-wait", "1s"];
        let said = user.is_refused(&[&run[..], &["--scale-port", &balance.path], &patience].concat());
        assert!(said.contains(part), "{said}");
    }
    let user = User::new();
    let balance = SimulatedBalance::start(journal(&user), Speech::NeverStill);
    let said = user.is_refused(&[&run[..], &["--scale-port", &balance.path, "--scale-wait", "1s"]].concat());
    assert!(said.contains("did not stand still") && said.contains("50.00 g"), "{said}");
    let said = user.is_refused(&[&run[..], &["--scale-port", "/dev/no-balance"]].concat());
    assert!(said.contains("/dev/no-balance"), "{said}");
    let said = user.is_refused(&[&run[..], &["--scale-command", "echo twelve"]].concat());
    assert!(said.contains("twelve"), "{said}");
    let journal = fs::read_to_string(journal(&user)).unwrap_or_default();
    assert!(!journal.contains("intent"), "{journal}");
}
