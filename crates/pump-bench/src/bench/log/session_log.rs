//! The log that a session keeps.

use crate::notice::Notice;
use crate::record::{
    Clock, Folder, Log, LogEntry, LogError, LogPlace, LogTail, Purpose, ShortText, Story, SystemClock,
    Unfinished, pending,
};

/// Log that a session keeps.
#[derive(Debug)]
pub(in crate::bench) struct SessionLog {
    log: Log,
    /// End of the file. `None` if it cannot be read or written: the journal keeps the doses.
    tail: Option<LogTail>,
    /// Clock that gives doses their times.
    pub(in crate::bench) clock: Box<dyn Clock>,
    /// Rack of which the motions are a part. `None` for a pump by itself.
    pub(in crate::bench) rack: Option<ShortText>,
    /// Number of the last dose that is on record.
    pub(in crate::bench) doses: u64,
    /// Dose that has ended and is not on record yet.
    pub(in crate::bench) ended: Option<LogEntry>,
    /// Dose that an earlier process left without an entry.
    pub(in crate::bench) unlogged: Option<Unfinished>,
}

impl SessionLog {
    /// Opens the log and copies the doses that only the journal has. The notice tells why it could not.
    pub(in crate::bench) fn open(folder: &Folder, story: &Story) -> (Self, Option<Notice>) {
        let recorded = story.last_logged();
        let log = folder.log();
        let mended = mended(&log, folder, recorded);
        let tail = mended.as_ref().ok().copied();
        let doses = recorded.number.max(tail.map_or(0, |tail| tail.place.number));
        let cut_off = story
            .cut_off
            .map(|(_, part)| part)
            .filter(|part| part.intent.told.is_some() || part.intent.purpose != Purpose::Jog);
        // The stretches of a dose by weight are one dose, whose end is not on record.
        let is_unlogged = |part: &Unfinished| {
            part.intent.terms.by_weight && part.intent.told.is_some_and(|told| told.number > doses)
        };
        let unlogged = cut_off.or(story.state.and_then(|state| state.unfinished).filter(is_unlogged));
        let clock = Box::new(SystemClock);
        let session = Self { log, tail, clock, rack: None, doses, ended: None, unlogged };
        (session, mended.err().map(|error| notice(&error)))
    }

    /// Copies a dose that the journal has to the log. The notice tells why it could not.
    pub(in crate::bench) fn copy(&mut self, entry: &LogEntry) -> Option<Notice> {
        let appended = self.log.append(self.tail?, entry);
        self.tail = appended.as_ref().ok().copied();
        appended.err().map(|error| notice(&error))
    }
}

/// Copies the entries up to the place `recorded` that only the journal has, and returns the end of the log.
fn mended(log: &Log, folder: &Folder, recorded: LogPlace) -> Result<LogTail, LogError> {
    let mut tail = log.tail()?;
    if recorded > tail.place {
        let copied = pending(&folder.journal(), tail.place, |entry| {
            tail = log.append(tail, &entry).map_err(|error| error.source)?;
            Ok(())
        });
        let failed = |source| LogError { action: "mend", path: log.path().to_owned(), source };
        copied.map_err(failed)?;
    }
    Ok(tail)
}

/// Returns the notice of a log that is behind its journal.
fn notice(error: &LogError) -> Notice {
    format!("{error}: {}; the journal has the doses, and the next start copies them", error.source).into()
}
