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
    /// It knows no question.
    Refuses,
    /// It sends lines that answer no question, without end.
    Flood,
    /// It answers with bytes that end no line, as another speed of the line makes of an answer.
    Noise,
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
            let deadline = Instant::now() + Duration::from_secs(600);
            while !stop.load(Ordering::Relaxed) && Instant::now() < deadline {
                if speech == Speech::Flood {
                    let _ = line.write_all(&b"I4 A \"0123456789\"\r\n\r\n".repeat(50));
                }
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
        (Speech::Noise, _) => "\u{1}\u{2}~x".to_owned(),
        // A balance of SBI knows no other question, and says nothing.
        (Speech::Silent | Speech::Flood | Speech::Sbi, _) => String::new(),
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
        let run = ["calibrate", "run", "--speeds", "10rpm,14rpm,100rpm", "--runs", "1", "--volume", "20mL"];
        let found = user.json(&[&run[..], &["--scale-port", &balance.path], &options].concat());
        let factor = number(&found["displacement"], "factor");
        assert!((factor - KAPPA).abs() < 6e-4, "{factor}");
        // The digits of the balance say how sure a reading of 21.3 mL is.
        let reading = number(&found["displacement"], "reading");
        assert!((reading - 0.01 * (2.0_f64 / 12.0).sqrt() / (KAPPA * 21.3185)).abs() < 2e-6, "{reading}");
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
    // One that never ends to talk is not listened to for ever.
    let balance = SimulatedBalance::start(journal(&user), Speech::Flood);
    let said = user.is_refused(&[&run[..], &["--scale-port", &balance.path, "--scale-wait", "2s"]].concat());
    assert!(said.contains("within 2 s") && said.contains("I4 A"), "{said}");
    let journal = fs::read_to_string(journal(&user)).unwrap_or_default();
    assert!(!journal.contains("intent"), "{journal}");
}

#[test]
fn a_part_of_a_line_that_another_program_left_at_the_balance_spoils_one_question_alone() {
    let user = User::new();
    user.json(&["213mL"]);
    let balance = SimulatedBalance::start(journal(&user), Speech::MtSics);
    fs::File::options().write(true).open(&balance.path).unwrap().write_all(b"?\x18$I").unwrap();
    let last = ["calibrate", "last", "--scale-port", &balance.path, "--anyway", "--dry-run"];
    let said = user.types(&last);
    assert!(said.code == 0 && said.err.contains("the balance shows"), "{}", said.err);
    // A balance that refuses each question is told, with what to do.
    let refuses = SimulatedBalance::start(journal(&user), Speech::Refuses);
    let said = user.is_refused(&["calibrate", "last", "--scale-port", &refuses.path]);
    assert!(said.contains("refused the question twice: it said `ES`"), "{said}");
    assert!(said.contains("--scale-protocol and --scale-line"), "{said}");
}

#[test]
fn a_balance_that_does_not_speak_the_protocol_is_told_within_seconds() {
    let run = ["calibrate", "run", "--speeds", "10rpm", "--runs", "1", "--scale-port"];
    let check = "--scale-protocol and --scale-line";
    for (speech, parts) in [
        (Speech::Sbi, ["asked in mt-sics and said `+", "which is sbi; name the balance's own protocol"]),
        (Speech::Silent, ["said nothing within 5 s when it was asked in mt-sics", check]),
        (Speech::Flood, ["within 5 s it sent only `I4 A", check]),
        (Speech::Noise, ["within 5 s it sent only `\\x01\\x02~x`", check]),
    ] {
        let user = User::new();
        let balance = SimulatedBalance::start(journal(&user), speech);
        let begins = Instant::now();
        let said = user.is_refused(&[&run[..], &[&balance.path]].concat());
        let took = begins.elapsed();
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        // A busy computer adds to the 5 s, and not up to the 60 s for which a balance may move.
        assert!(took < Duration::from_secs(30), "{took:?}");
    }
}

#[test]
fn a_dose_by_weight_ends_where_the_balance_says_on_the_simulated_motor() {
    let user = User::new();
    let balance = SimulatedBalance::start(journal(&user), Speech::MtSics);
    let scale = ["--until-scale", "--scale-port", &balance.path];
    let found = user.json(&[&["25g"][..], &scale].concat());
    let weighed = &found["by_weight"];
    assert!((number(weighed, "mass_g") - 25.0).abs() <= 0.035, "{found}");
    assert_eq!(found["volume_basis"], "weighed");
    // The pump delivers 4 % more than its model: 25 g are 25.096 mL, and the model turned for 24.13.
    assert!((number(&found, "delivered_ml") - number(weighed, "mass_g") * Z_ML_G).abs() < 1e-3, "{found}");
    assert!((number(weighed, "turned_ml") - 25.096 / KAPPA).abs() < 0.05, "{found}");
    assert!(number(weighed, "turned_ml") <= number(weighed, "most_ml"));
    assert!(number(weighed, "stretches") >= 2.0 && number(&found, "carry_ml") == 0.0);
    assert!(number(&found, "expanded_uncertainty_ml") < 0.06, "{found}");
    // The next dose starts afresh, and its balance is the same.
    let again = user.json(&[&["5mL"][..], &scale].concat());
    assert!((number(&again, "delivered_ml") - 5.0).abs() <= 0.04, "{again}");
    let text = user.types(&[&["3g"][..], &scale].concat());
    assert!(
        text.code == 0 && text.out.contains("by weight: ") && text.out.contains(" g of 3.00 g"),
        "{}",
        text.out
    );
}

#[test]
fn what_does_not_go_with_a_dose_by_weight_is_refused() {
    let user = User::new();
    for (words, part) in [
        (&["5mL", "--until-scale"][..], "--scale-port"),
        (&["5mL", "--scale-command", "echo 1 g"], "--until-scale"),
        (&["5mL", "--until-scale", "--scale-command", "echo 1 g", "--repeat", "3"], "one dose"),
        (&["-5mL", "--until-scale", "--scale-command", "echo 1 g"], "forward"),
        (&["5mL", "--until-scale", "--scale-command", "echo 1 oz"], "1 oz"),
        (&["5mL", "--until-scale", "--scale-command", "echo 1 g", "--steps", "a.csv"], "--steps"),
    ] {
        let said = user.is_refused(words);
        assert!(said.contains(part), "{words:?}: {said}");
    }
}

#[test]
fn a_balance_that_never_rises_is_a_fault_and_the_dose_is_left_unfinished() {
    let user = User::new();
    let answer = user.types(&["25mL", "--until-scale", "--scale-command", "echo 50.00 g"]);
    assert_eq!(answer.code, 1, "{}", answer.err);
    assert!(answer.err.contains("no motor moved") && answer.err.contains("by the model"), "{}", answer.err);
    assert_eq!(user.types(&["5mL"]).code, 4);
    let resumed = user.json(&["resume", "--dry-run"]);
    let warnings = resumed["warnings"].to_string();
    assert!(warnings.contains("made by volume") && warnings.contains("dose accept"), "{warnings}");
    assert_eq!(user.types(&["discard"]).code, 0);
}

#[test]
fn a_balance_that_shows_all_that_was_asked_for_ends_an_unfinished_dose_without_a_step() {
    let user = User::new();
    let mass = user.path("mass");
    fs::write(&mass, "50.00 g").unwrap();
    let read = format!("cat '{}'", mass.display());
    let scale = ["--until-scale", "--scale-command", &read];
    // The vessel was empty when the line was: nothing arrived before the balance was read.
    assert_eq!(user.types(&[&["5g"][..], &scale].concat()).code, 1);
    let turned_ml = number(&user.json(&["status"])["unfinished"], "delivered_most_ml");
    fs::write(&mass, "55.00 g").unwrap();
    let found = user.json(&[&["resume"][..], &scale].concat());
    assert_eq!(
        (found["steps_made"].as_i64(), found["completed"].as_bool()),
        (Some(0), Some(true)),
        "{found}"
    );
    let weighed = &found["by_weight"];
    assert!((number(weighed, "mass_g") - 5.0).abs() < 1e-9, "{found}");
    assert!((number(weighed, "turned_ml") - turned_ml).abs() < 1e-9, "{found}");
    let status = user.json(&["status"]);
    assert!(
        status["unfinished"].is_null() && status["last_by_weight"]["mass_g"] == weighed["mass_g"],
        "{status}"
    );
    // The dose is over: a full vessel is no rest of another.
    assert_eq!(user.types(&[&["resume"][..], &scale].concat()).code, 2);
}

#[test]
fn the_last_dose_is_calibrated_by_what_a_balance_shows() {
    let user = User::new();
    user.json(&["30mL"]);
    let found = user.json(&["calibrate", "last", "--scale-command", "echo 30.50 g"]);
    assert!((number(&found["displacement"], "factor") - 30.5 * Z_ML_G / 30.0).abs() < 2e-4, "{found}");
    let reading = number(&found["displacement"], "reading");
    // Two digits, and the density of water whose temperature is known to 0.8 degC: 2.57e-4 a degree (Kell 1975).
    let expected = (0.01 * (2.0_f64 / 12.0).sqrt() / 30.0).hypot(0.8 * 2.57e-4);
    assert!((reading - expected).abs() < 2e-6, "{reading}");
    let said = user.types(&["calibrate", "last", "--scale-command", "echo -0.02 g"]);
    assert!(said.code == 2 && said.err.contains("tare"), "{}", said.err);
    let said = user.types(&["calibrate", "last", "30g", "--scale-command", "echo 30 g"]);
    assert_eq!(said.code, 2, "{}", said.err);
}

#[test]
fn a_run_to_be_weighed_is_said_to_move_only_once_the_balance_was_read() {
    let user = User::new();
    let run = ["calibrate", "run", "--speeds", "60rpm", "--runs", "1", "--pitches", "1", "--scale-command"];
    let pounds = user.types(&[&run[..], &["echo 5 lb"]].concat());
    assert!(pounds.code == 2 && pounds.err.contains("`5 lb`, which is no mass"), "{}", pounds.err);
    assert!(!pounds.err.contains("moving"), "{}", pounds.err);
    let bare = user.types(&[&run[..], &["echo 5.00", "--anew"]].concat());
    assert!(bare.code == 2 && bare.err.contains("print `5.00 g`"), "{}", bare.err);
}
