//! Standard output and standard error: results, warnings and progress, wrapped at the width of the terminal.

use std::borrow::Cow;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use console::Term;
use indicatif::ProgressBar;
use pump_bench::catalogue::overlap_warning;
use pump_bench::notice::Notice;
use pump_bench::{Bench, DoseError, Session};

use crate::advice;
use crate::failure::Failure;
use crate::shown::{json_shown, shown};
use crate::told_commands::completed;

/// True once nobody reads standard output any more.
static READER_GONE: AtomicBool = AtomicBool::new(false);

/// Prints to standard output, to a file or a program as it is. A terminal is shown control characters. A reader that
/// went away is no failure of the dose.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let text = if io::stdout().is_terminal() { shown(text) } else { Cow::Borrowed(text) };
    match io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {
            READER_GONE.store(true, Ordering::Relaxed);
            Ok(())
        }
        Err(error) => {
            let refused = Failure::refused(format!("the report could not be printed: {error}"));
            Err(refused.kind(pump_bench::report::ErrorKind::Output))
        }
    }
}

/// True if the reader of standard output went away.
pub(crate) fn is_reader_gone() -> bool {
    READER_GONE.load(Ordering::Relaxed)
}

/// Prints a report for programs to standard output.
pub(crate) fn print_json(json: &str) -> Result<(), Failure> {
    print(&json_shown(json))
}

/// Prints words for people to standard output. On a terminal, and where COLUMNS gives a width, lines end at words.
/// A file or a program gets whole lines.
pub(crate) fn tell(text: &str) -> Result<(), Failure> {
    let text = completed(text);
    let text = &*shown(&text);
    let told = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = Term::stdout().size_checked().map(|(_, columns)| usize::from(columns));
    match terminal.or_else(told) {
        Some(width) => print(&wrapped(text, width)),
        None => print(text),
    }
}

/// Says something to a person beside the results, on standard error.
pub(crate) fn say(text: &str) {
    say_as_it_is(&completed(text));
}

fn say_as_it_is(text: &str) {
    // If standard error is closed nobody reads it.
    let _ = io::stderr().write_all(shown(text).as_bytes());
    let _ = io::stderr().flush();
}

/// Says a message of one line, wrapped if standard error is a terminal; logs keep one line a message.
fn say_line(line: &str) {
    let width = Term::stderr().size_checked().map(|(_, columns)| usize::from(columns));
    match width.filter(|_| io::stderr().is_terminal()) {
        Some(width) => say_as_it_is(&wrapped(&completed(line), width)),
        None => say(line),
    }
}

/// Says a line to a person who is led through questions. It is wrapped on a terminal, and where COLUMNS gives a width.
pub(crate) fn say_wrapped(line: &str) {
    let told = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = Term::stderr().size_checked().map(|(_, columns)| usize::from(columns));
    match terminal.or_else(told) {
        Some(width) => say_as_it_is(&wrapped(&completed(line), width)),
        None => say(line),
    }
}

/// Says why the command failed: in words, or as one line of JSON if a program reads the report.
pub(crate) fn say_error(failure: &Failure, json: bool) {
    if json {
        // Words that are put into JSON must be escaped: `Failure::json` completes its message itself.
        say_as_it_is(&(failure.json() + "\n"));
    } else {
        say_line(&format!("error: {}\n", failure.message()));
    }
}

/// Warns a person beside the results.
pub(crate) fn warn<N: Clone + Into<Notice>>(warnings: &[N]) {
    for warning in warnings {
        let notice: Notice = warning.clone().into();
        say_line(&format!("warning: {}\n", notice.worded(advice::words)));
    }
}

/// Warns before guided doses of rollers that overlap, and of a fluid that the lines' resistance does not follow. Before
/// a real motor moves, each dose warns of its own.
pub(crate) fn warn_of_pump(bench: &Bench) {
    if bench.is_simulated() {
        let overlap = overlap_warning(bench.model().geometry()).map(Notice::from);
        let of_fluid = bench.file().resistance_warning();
        overlap.into_iter().chain(of_fluid).for_each(|warning| warn(&[warning]));
    }
}

/// Passes the result of a session on. A failure has no report that could tell the session's notes, so they are warned
/// of here.
pub(crate) fn noted<T>(session: &mut Session<'_>, result: Result<T, DoseError>) -> Result<T, DoseError> {
    if result.is_err() {
        warn(&session.notes());
    }
    result
}

/// Makes a motion of a session. A real motor is announced just before it moves, with the warnings, once nothing refuses
/// the motion any more.
pub(crate) fn announced<'a, T>(
    session: &mut Session<'a>,
    json: bool,
    warnings: &[Notice],
    motion: impl FnOnce(&mut Session<'a>) -> T,
) -> Result<T, Failure> {
    announcing(session, json, warnings, motion).map(|(ended, _)| ended)
}

/// Makes a motion as [`announced`] does. Returns beside its end whether the warnings were told: a motion that was
/// refused has told none, and no motion of a simulated motor does.
pub(crate) fn announcing<'a, T>(
    session: &mut Session<'a>,
    json: bool,
    warnings: &[Notice],
    motion: impl FnOnce(&mut Session<'a>) -> T,
) -> Result<(T, bool), Failure> {
    let bench = session.bench();
    if bench.is_simulated() {
        return Ok((motion(session), false));
    }
    let untold = Arc::new(Mutex::new(None));
    let (failed, warnings) = (Arc::clone(&untold), warnings.to_vec());
    let told = Arc::new(AtomicBool::new(false));
    let tells = Arc::clone(&told);
    session.before_motion(move || {
        warn(&warnings);
        tells.store(true, Ordering::Relaxed);
        match announce(bench, json) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                *failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
                ControlFlow::Break(())
            }
        }
    });
    let ended = motion(session);
    // A motion that was refused has told nothing, and no later one of the session tells of it.
    session.before_motion(|| ControlFlow::Continue(()));
    let failed = untold.lock().unwrap_or_else(PoisonError::into_inner).take();
    failed.map_or(Ok((ended, told.load(Ordering::Relaxed))), Err)
}

/// Announces that a motor moves, before it does: on standard output, or on standard error if a program reads that.
pub(crate) fn announce(bench: &Bench, json: bool) -> Result<(), Failure> {
    let headline = bench.headline() + "\n";
    match json {
        _ if bench.is_simulated() => Ok(()),
        true => {
            say(&headline);
            Ok(())
        }
        false => tell(&headline),
    }
}

/// Words beside a sign that turns, on standard error, while nothing else can be said. Only a terminal shows it.
pub(crate) fn waiting(what: &str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Breaks lines that are too long between words. The rest of a line stands two columns further in than its beginning,
/// or under the text beside a name, as in `  speed   14 r/min`.
fn wrapped(text: &str, width: usize) -> String {
    text.split_inclusive('\n').map(|line| wrapped_line(line, width)).collect()
}

fn wrapped_line(line: &str, width: usize) -> String {
    let bare = line.trim_end_matches('\n');
    if bare.chars().count() <= width {
        return line.to_owned();
    }
    let indent = hanging_indent(bare).min(width / 2);
    let (mut out, mut column, mut rest) = (String::new(), 0, bare);
    while !rest.is_empty() {
        let spaces = rest.len() - rest.trim_start_matches(' ').len();
        let word_end = rest[spaces..].find(' ').map_or(rest.len(), |end| spaces + end);
        let (piece, after) = rest.split_at(word_end);
        let length = piece.chars().count();
        if column + length > width && column > indent {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            out.push_str(&piece[spaces..]);
            column = indent + length - spaces;
        } else {
            out.push_str(piece);
            column += length;
        }
        rest = after;
    }
    out + &line[bare.len()..]
}

/// Column at which the rest of a line begins.
fn hanging_indent(line: &str) -> usize {
    let start = line.len() - line.trim_start_matches(' ').len();
    let beside = line[start..].find("  ").filter(|at| start > 0 && *at <= 12).map(|at| {
        let gap = &line[start + at..];
        start + at + gap.len() - gap.trim_start_matches(' ').len()
    });
    beside.unwrap_or(start + 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_at_words_and_go_on_under_their_text() {
        assert_eq!(wrapped("one two three\nfour\n", 8), "one two\n  three\nfour\n");
        assert_eq!(wrapped("  speed   14 r/min, cruising", 20), "  speed   14 r/min,\n          cruising");
        assert_eq!(wrapped("short\n", 80), "short\n");
        assert_eq!(wrapped("averyverylongword\n", 5), "averyverylongword\n");
    }
}
