//! The notes of a service on standard error, one line each. Who reads it has the time of each line, as journald does.

use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use pump_service::history::EventRecord;
use tokio::sync::mpsc::{UnboundedSender, unbounded_channel};

use crate::terminal::say;

/// Longest wait for a reader of standard error at the end.
const LONGEST: Duration = Duration::from_secs(1);

/// Time between two looks at the thread.
const LOOK: Duration = Duration::from_millis(5);

/// Thread that says each note: a reader of standard error that stops reading holds up no pump.
#[derive(Debug)]
pub(super) struct Notes(JoinHandle<()>);

impl Notes {
    /// Begins to say what the sender is told, until the last copy of the sender is dropped.
    pub(super) fn begin() -> (UnboundedSender<EventRecord>, Self) {
        let (tell, mut told) = unbounded_channel::<EventRecord>();
        let saying = thread::spawn(move || {
            while let Some(note) = told.blocking_recv() {
                say(&line(&note));
            }
        });
        (tell, Self(saying))
    }

    /// Waits 1 s at most until the last note was said.
    pub(super) fn end(self) {
        let begun = Instant::now();
        while !self.0.is_finished() && begun.elapsed() < LONGEST {
            thread::sleep(LOOK);
        }
    }
}

/// A note as one line: its kind, its pump and its words.
fn line(note: &EventRecord) -> String {
    let pump = note.pump.as_ref().map_or(String::new(), |pump| format!(" {pump}:"));
    let text: Vec<&str> = note.text.lines().map(str::trim).collect();
    format!("{}:{pump} {}\n", note.kind, text.join(" "))
}
