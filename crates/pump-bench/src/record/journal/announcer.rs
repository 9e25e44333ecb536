//! The announcements of a motion: a thread of the journal's own syncs each while the motor turns.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::{Entry, Journal, JournalError};

/// Announcements of a motion under way. The journal's thread writes each and tells when the disk has it.
#[derive(Debug)]
pub(crate) struct Announcer {
    entries: Sender<Entry>,
    told: Receiver<Result<Duration, JournalError>>,
}

impl Announcer {
    /// Gives an entry to the journal's thread.
    pub(crate) fn announce(&self, entry: Entry) {
        // A thread that has ended takes no entry and tells of none: nothing more is on disk.
        let _ = self.entries.send(entry);
    }

    /// Waits for at most `wait` until the disk has the entry that was given first of those not told of yet.
    /// Returns the time that the disk took.
    pub(crate) fn told(&self, wait: Duration) -> Option<Result<Duration, JournalError>> {
        self.told.recv_timeout(wait).ok()
    }
}

impl Journal {
    /// Makes a motion while a thread writes its announcements. The journal is this thread's again once the
    /// last announcement is on the disk, or has failed.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the system has no thread left. The motion was not begun.
    pub(crate) fn announcing<T>(&mut self, motion: impl FnOnce(&Announcer) -> T) -> Result<T, JournalError> {
        let path = self.path().to_owned();
        let (entries, given) = channel::<Entry>();
        let (tell, told) = channel();
        thread::scope(|scope| {
            let write = move || {
                for entry in given {
                    let began = Instant::now();
                    let written = self.append(&entry).map(|()| began.elapsed());
                    if tell.send(written).is_err() {
                        return;
                    }
                    // The announcement is on the disk whatever becomes of the ones before it.
                    let _ = self.compact();
                }
            };
            thread::Builder::new().name("journal".to_owned()).spawn_scoped(scope, write).map_err(
                |source| JournalError::File { action: "start the thread that writes", path, source },
            )?;
            Ok(motion(&Announcer { entries, told }))
        })
    }
}
