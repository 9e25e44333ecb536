//! A command of the user that the service runs, and its end.

use std::io::{self, BufRead, BufReader, Read, Write, pipe, sink};
use std::process::{ExitStatus, Stdio};
use std::sync::mpsc::channel;
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::shell::{end_with_its_group, shell_command};

/// Longest time that a command has.
pub(crate) const LONGEST: Duration = Duration::from_secs(10);

/// Time between two looks at a command.
const LOOK: Duration = Duration::from_millis(10);

/// Longest line of its output that is heard, in bytes.
const LONGEST_LINE: u64 = 4096;

/// Longest wait for the first line once the command has ended.
const LAST_LINE: Duration = Duration::from_millis(200);

/// End of a command.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Status of the command. `None` if it was ended because it took too long, or because the service ends.
    pub(crate) status: Option<ExitStatus>,
    /// First line of its output or of its errors; empty without one.
    pub(crate) line: String,
}

/// Runs a command of the shell with further variables and `input` on its standard input. It is ended after 10 s, and as
/// soon as `is_ending` says so.
///
/// # Errors
///
/// The system's error if the command cannot be started or looked at.
pub(crate) fn run(
    command: &str,
    variables: &[(&str, &str)],
    input: &str,
    is_ending: impl Fn() -> bool,
) -> io::Result<Ended> {
    let (output, writer) = pipe()?;
    let mut shell = shell_command(command);
    shell.envs(variables.iter().copied());
    shell.stdin(Stdio::piped()).stdout(writer.try_clone()?).stderr(writer);
    let mut child = shell.spawn()?;
    // The output ends with the command: this process keeps no end of it open.
    drop(shell);
    if let Some(mut to) = child.stdin.take() {
        // A command that reads nothing may have ended. The input is shorter than what a pipe holds.
        let _ = to.write_all(input.as_bytes());
    }
    let (give, line) = channel();
    thread::spawn(move || {
        let mut output = BufReader::new(output);
        let mut first = Vec::new();
        let _ = output.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut first);
        let _ = give.send(String::from_utf8_lossy(&first).trim().to_owned());
        // A command that says more than a line is not held up.
        let _ = io::copy(&mut output, &mut sink());
    });
    let until = Instant::now() + LONGEST;
    let status = loop {
        match child.try_wait()? {
            Some(status) => break Some(status),
            None if Instant::now() >= until || is_ending() => {
                end_with_its_group(&mut child);
                break None;
            }
            None => thread::sleep(LOOK),
        }
    };
    Ok(Ended { status, line: line.recv_timeout(LAST_LINE).unwrap_or_default() })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_heard_by_its_first_line_whatever_it_leaves_running() {
        let begun = Instant::now();
        let command = "cat; echo \"water $WHERE\" >&2; yes | head -c 300000; sleep 5 & exit 3";
        let ended = run(command, &[("WHERE", "below")], "said: ", || false).unwrap();
        assert_eq!((ended.status.unwrap().code(), ended.line.as_str()), (Some(3), "said: water below"));
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    }

    #[test]
    fn a_command_ends_with_the_service() {
        let begun = Instant::now();
        let ended = run("sleep 5", &[], "", || begun.elapsed() > Duration::from_millis(50)).unwrap();
        assert!(ended.status.is_none() && begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    }
}
