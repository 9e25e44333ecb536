//! The end of a motion whose board is out of reach, was reset, or has shut down.

use std::sync::Arc;
use std::time::Duration;

use super::motion::Motion;
use super::outcome::Fault;
use crate::drives::klipper::board::{be_still, reason};
use crate::drives::klipper::error::KlipperError;

/// Time for which a silent board is asked at once.
const ASK: Duration = Duration::from_millis(500);

impl Motion<'_> {
    /// Returns the fault of a motion that ended so: with the board's count if it still runs, and otherwise with the
    /// steps that it may have made.
    pub(super) fn lost(&mut self, error: KlipperError) -> Fault {
        let sent = self.made + self.feed.as_ref().map_or(0, |feed| feed.pushed);
        let heard = self.heard.min(sent);
        if matches!(error, KlipperError::Shutdown { .. }) {
            // The shutdown has taken the current away, and another motor's thread may end it. If the disk cannot note
            // it, the board's record does, or the next meeting finds the board shut down.
            let _ = self.board.note_cut(false);
        }
        let found = match &error {
            KlipperError::Reset | KlipperError::Gone(_) => None,
            KlipperError::Shutdown { .. } => self.search(false),
            _ => self.search(true),
        };
        self.feed = None;
        if matches!(error, KlipperError::Reset) {
            // The motor stopped where it was, without current. The next meeting notes what the disk cannot.
            self.note_slip(heard);
            let _ = self.board.note_reset();
        }
        match found {
            Some(counted) => {
                self.note_slip(counted);
                Fault::at(counted, error)
            }
            // The next meeting may find the count, and tells of the slip then.
            None => Fault { error, least: heard, most: sent },
        }
    }

    /// Searches for a board that has fallen silent. Returns its count if it still runs in the same session.
    fn search(&mut self, connects: bool) -> Option<u64> {
        let began = self.board.talk.link.now();
        loop {
            match self.count_again(connects) {
                Ok(counted) => return counted,
                Err(KlipperError::Gone(_)) => return None,
                Err(_) if self.board.talk.link.now().saturating_sub(began) > self.board.search => {
                    return None;
                }
                Err(_) => self.board.talk.link.sleep(ASK / 10),
            }
        }
    }

    /// Returns the count of a board that stands, or `None` if it has lost it.
    fn count_again(&mut self, connects: bool) -> Result<Option<u64>, KlipperError> {
        let shared = Arc::clone(&self.board.talk.shared);
        // Another motor may be at it. The search asks again, and ends in its time.
        let Some(_meeting) = shared.try_meeting() else {
            return Err(KlipperError::NoAnswer { question: "get_config".to_owned(), waited_s: 0.0 });
        };
        let talk = &mut self.board.talk;
        if !talk.link.takes_over() && connects {
            talk.link.connect(ASK)?;
        }
        talk.forget();
        let state = talk.config()?;
        if !state.is_configured || state.checksum != self.board.record.checksum {
            return Ok(None);
        }
        if state.is_shut_down {
            // Nothing but the record tells that afterwards.
            self.board.note_cut(true)?;
            if !self.board.talk.clear_shutdown()? {
                return Ok(None);
            }
        }
        let talk = &mut self.board.talk;
        be_still(talk)?;
        talk.end_dead_man(reason::MET)?;
        self.counted().map(Some)
    }
}
