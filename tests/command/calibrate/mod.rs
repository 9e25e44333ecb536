//! Calibrations as a user makes and uses them.

mod guided;
mod using;
mod verifying;

use std::fs;
use std::io::Write;
use std::process::Stdio;

use crate::user::{Answer, User};

/// Volume of a revolution by the model, mL.
const REVOLUTION_ML: f64 = 21.318_486_6;

/// A table of runs of three revolutions at these speeds and factors.
fn table(user: &User, name: &str, runs: &[(f64, f64)]) -> String {
    let mut text = "speed_rpm,revolutions,volume_ml\n".to_owned();
    for (rpm, factor) in runs {
        text.push_str(&format!("{rpm},3,{}\n", 3.0 * REVOLUTION_ML * factor));
    }
    fs::write(user.path(name), text).unwrap();
    name.to_owned()
}

/// Types a command and then these lines.
fn answers(user: &User, arguments: &[&str], lines: &str) -> Answer {
    let mut command = user.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A command that was refused reads nothing.
    let _ = child.stdin.take().unwrap().write_all(lines.as_bytes());
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}
