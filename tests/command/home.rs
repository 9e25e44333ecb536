//! A person at a terminal: the rotor is turned to its mark with the arrow keys.

use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::built_in;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, tcgetattr};

use crate::user::{User, number};

const RIGHT: &[u8] = b"\x1b[C";
const LEFT: &[u8] = b"\x1b[D";
const UP: &[u8] = b"\x1b[A";
const DOWN: &[u8] = b"\x1b[B";
const ENTER: &[u8] = b"\r";

/// Runs `dose home --mark` with these arguments in a terminal of its own and types `keys`. Returns the exit code, what
/// it printed and what the terminal showed.
fn at_terminal(user: &User, arguments: &[&str], keys: &[&[u8]]) -> (i32, String, String) {
    at_terminal_until(user, arguments, keys, |_, _| {})
}

/// Does as `at_terminal`. At the end `last` gets the terminal and the number of the process.
fn at_terminal_until(
    user: &User,
    arguments: &[&str],
    keys: &[&[u8]],
    last: impl FnOnce(&mut File, u32),
) -> (i32, String, String) {
    let terminal = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&terminal).unwrap();
    unlockpt(&terminal).unwrap();
    let path = ptsname(&terminal, Vec::new()).unwrap().into_string().unwrap();
    let line = || Stdio::from(OpenOptions::new().read(true).write(true).open(&path).unwrap());
    let dose = user.command(&[&["home", "--mark"], arguments].concat());
    // The shell ignores the signal of a file that may not grow, so that a write fails as on a full disk.
    let mut command = Command::new("bash");
    command.args(["-c", "trap '' XFSZ; exec \"$0\" \"$@\""]).arg(dose.get_program()).args(dose.get_args());
    command.envs(dose.get_envs().filter_map(|(name, value)| Some((name, value?)))).env_remove("DOSE_PUMP");
    command.current_dir(user.folder.path());
    let mut child = command.stdin(line()).stderr(line()).stdout(Stdio::piped()).spawn().unwrap();
    drop(command);

    let mut terminal = File::from(terminal);
    let mut screen = terminal.try_clone().unwrap();
    let shown = thread::spawn(move || {
        let (mut shown, mut bytes) = (Vec::new(), [0; 256]);
        // The end of the child is the end of the line: an error.
        while let Ok(count @ 1..) = screen.read(&mut bytes) {
            shown.extend_from_slice(&bytes[..count]);
        }
        String::from_utf8_lossy(&shown).into_owned()
    });
    // Keys that come before the terminal reads them one by one are lost on some systems.
    for key in keys {
        wait_for_single_keys(&terminal);
        terminal.write_all(key).unwrap();
        thread::sleep(Duration::from_millis(60));
    }
    last(&mut terminal, child.id());
    let deadline = Instant::now() + Duration::from_secs(120);
    while child.try_wait().unwrap().is_none() {
        assert!(Instant::now() < deadline, "it waits for more keys");
        thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    let out = String::from_utf8(output.stdout).unwrap();
    (output.status.code().unwrap(), out, shown.join().unwrap())
}

/// Waits until the program at a terminal reads single keys, as far as the terminal tells.
fn wait_for_single_keys(terminal: &File) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while tcgetattr(terminal).is_ok_and(|modes| modes.local_modes.contains(LocalModes::ICANON)) {
        assert!(Instant::now() < deadline, "it reads no keys");
        thread::sleep(Duration::from_millis(2));
    }
}

/// A pump whose marks meet at 40 deg.
fn marked(user: &User) -> String {
    let mut file = built_in("three-roller").unwrap();
    file.pump.mark_angle_deg = Some(40.0);
    let path = user.path("marked.toml");
    fs::write(&path, file.to_toml()).unwrap();
    path.display().to_string()
}

#[test]
fn arrow_keys_turn_the_rotor_and_enter_says_that_the_marks_meet() {
    let user = User::new();
    let pump = marked(&user);
    let pump = ["--pump", pump.as_str()];
    // Ten degrees on in two steps of five, one back, then finer by two sizes: half a degree, a tenth.
    let keys = [UP, RIGHT, RIGHT, DOWN, LEFT, DOWN, RIGHT, DOWN, RIGHT, ENTER];
    let (code, out, shown) = at_terminal(&user, &pump, &keys);
    assert_eq!(code, 0, "{shown}");
    assert!(shown.contains("at 40.00°") && shown.contains("a key turns by 0.1°"), "{shown}");
    assert!(out.contains("the rollers stand at 40.00° ± 0.55°"), "{out}");
    let status = user.json(&[&["status"], &pump[..]].concat());
    assert_eq!(status["angle_source"], "mark");
    let turned = number(&status["wear"], "revolutions") * 360.0;
    assert!((turned - 11.6).abs() < 0.1, "5 + 5 + 1 + 0.5 + 0.1 deg: {turned}");
    let dose = user.json(&[&["5mL"], &pump[..]].concat());
    assert_eq!(dose["phase"]["source"], "mark");
    assert!((number(&dose["phase"], "half_width_deg") - 0.55).abs() < 1e-9);
}

#[test]
fn the_tolerance_counts_and_leaving_sets_nothing_but_keeps_count() {
    let user = User::new();
    let pump = marked(&user);
    let pump = ["--pump", pump.as_str()];
    let (code, out, _) = at_terminal(&user, &[&pump[..], &["--mark-tolerance", "2deg"]].concat(), &[ENTER]);
    assert_eq!(code, 0);
    assert!(out.contains("40.00° ± 2.50°"), "{out}");
    let (code, out, _) = at_terminal(&user, &pump, &[RIGHT, RIGHT, b"q"]);
    assert_eq!(code, 0);
    assert!(out.contains("nothing was set"), "{out}");
    let status = user.json(&[&["status"], &pump[..]].concat());
    assert!((number(&status, "angle_deg") - 42.0).abs() < 0.05, "{status}");
}

#[test]
fn a_signal_while_it_waits_for_a_key_is_the_end_and_its_exit_code_says_so() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let user = User::new();
        let pump = marked(&user);
        let pump = ["--pump", pump.as_str()];
        for (keys, turned) in [(&[][..], false), (&[RIGHT][..], true)] {
            let (ended, out, shown) = at_terminal_until(&user, &pump, keys, |terminal, id| {
                wait_for_single_keys(terminal);
                let id = id.to_string();
                assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
            });
            assert_eq!((ended, out.as_str()), (code, ""), "{shown}");
            assert!(shown.contains("stopped by the user; the turns are on record"), "{shown}");
            assert_eq!(user.json(&[&["status"], &pump[..]].concat())["recorded"], turned, "{shown}");
        }
    }
    // The key Ctrl-C is the same wish.
    let user = User::new();
    let pump = marked(&user);
    assert_eq!(at_terminal(&user, &["--pump", &pump], &[b"\x03"]).0, 130);
}

#[test]
#[cfg(target_os = "linux")]
fn a_failure_after_a_turn_does_not_say_that_nothing_has_moved() {
    let user = User::new();
    let pump = marked(&user);
    let pump = ["--pump", pump.as_str()];
    for (turns, code) in [(&[][..], 2), (&[RIGHT][..], 1)] {
        assert_eq!(user.types(&[&["home", "--set", "0deg"], &pump[..]].concat()).code, 0);
        let (ended, out, shown) = at_terminal_until(&user, &pump, turns, |terminal, id| {
            wait_for_single_keys(terminal);
            // A turn cannot be recorded any more.
            let limit = Command::new("prlimit").args(["--fsize=10", "--pid", &id.to_string()]).status();
            assert!(limit.unwrap().success());
            terminal.write_all(RIGHT).unwrap();
        });
        assert_eq!((ended, out.as_str()), (code, ""), "{shown}");
        assert!(shown.contains("journal.jsonl"), "{shown}");
    }
}

#[test]
fn without_a_terminal_or_a_mark_nothing_turns() {
    let user = User::new();
    let message = user.is_refused(&["home", "--mark"]);
    assert!(message.contains("has no [pump] mark_angle_deg"), "{message}");
    let pump = marked(&user);
    let message = user.is_refused(&["home", "--mark", "--pump", &pump]);
    assert!(message.contains("run this in a terminal"), "{message}");
    let message = user.is_refused(&["home", "--mark", "--pump", &pump, "--mark-tolerance=-1deg"]);
    assert!(message.contains("is -1 deg; allowed: 0 to 180 deg"), "{message}");
}

#[test]
fn an_unknown_angle_is_no_number() {
    let user = User::new();
    assert!(number(&user.json(&["status"]), "angle_deg").abs() < 1e-9);
    assert_eq!(user.types(&["home", "--unknown"]).code, 0);
    let status = user.json(&["status"]);
    assert!(status["angle_deg"].is_null() && status["angle_known"] == false, "{status}");
}
