//! Output of a command that reads and moves nothing.

use std::io;
use std::process::Stdio;

use axum::body::Bytes;
use serde::Deserialize;
use tokio::io::AsyncReadExt;
use tokio::sync::mpsc::{Receiver, channel};

use super::line::Line;
use super::program::Program;
use super::report::killed;
use super::worker::Ended;
use crate::order::{OrderError, option, plain_text};

/// Bytes that are passed on at a time.
const PIECE: usize = 64 << 10;

/// Pieces that wait for a slow reader. The command waits with them.
const WAITING: usize = 4;

/// Form of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum LogFormat {
    /// One `log/1` a line.
    Json,
    /// A table.
    Csv,
    /// Words.
    Text,
}

/// Returns the words of `dose log`.
pub(crate) fn log_words(
    pump: &str,
    since: Option<&str>,
    until: Option<&str>,
    format: LogFormat,
) -> Result<Vec<String>, OrderError> {
    let mut words = vec!["log".to_owned(), option("pump", pump)];
    for (name, text) in [("since", since), ("until", until)] {
        if let Some(text) = text {
            words.push(option(name, plain_text("a time", text)?));
        }
    }
    let format = match format {
        LogFormat::Json => "json",
        LogFormat::Csv => "csv",
        LogFormat::Text => "text",
    };
    words.push(option("format", format));
    Ok(words)
}

/// Starts a command, and returns its output piece by piece once the first has come. A command that ends without output
/// returns its end, if it failed.
///
/// # Errors
///
/// The system's error if the command cannot be started or read.
pub(crate) async fn output(
    program: &Program,
    words: &[String],
) -> io::Result<Result<Receiver<Bytes>, Ended>> {
    let mut child = program.command(words).stdin(Stdio::null()).kill_on_drop(true).spawn()?;
    let (Some(mut output), Some(mut errors)) = (child.stdout.take(), child.stderr.take()) else {
        return Err(io::Error::other("the command has no output"));
    };
    let mut first = vec![0; PIECE];
    let length = output.read(&mut first).await?;
    first.truncate(length);
    if first.is_empty() {
        let mut told = String::new();
        errors.read_to_string(&mut told).await?;
        let status = child.wait().await?;
        if !status.success() {
            let error = told.lines().rev().map(Line::of_errors).find_map(|line| match line {
                Line::Error(error) => Some(error),
                _ => None,
            });
            let was_killed = status.code().is_none();
            let error = if was_killed { Some(killed(status)) } else { error };
            return Ok(Err(Ended { code: status.code().unwrap_or(1), error, was_killed }));
        }
    }
    let (give, take) = channel(WAITING);
    tokio::spawn(async move {
        let mut piece = first;
        loop {
            // A reader that has gone ends the command, as the process is dropped.
            if piece.is_empty() || give.send(Bytes::from(piece)).await.is_err() {
                return drop(child);
            }
            piece = vec![0; PIECE];
            let length = output.read(&mut piece).await.unwrap_or(0);
            piece.truncate(length);
        }
    });
    Ok(Ok(take))
}
