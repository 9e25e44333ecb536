//! A line that several threads share. One of them waits at the wire at a time, and the others wait for its news.

use std::io;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use super::line::Line;
use crate::drives::wire::Wire;

/// Longest wait at the wire before the line looks at its times.
const LOOK: Duration = Duration::from_millis(5);

/// Longest wait at the wire of a line that others have something to send over.
const SHORT_LOOK: Duration = Duration::from_millis(1);

/// Line that the links of a board share, each from its own thread.
#[derive(Debug)]
pub(super) struct SharedLine {
    line: Mutex<Line>,
    /// Told whenever a link leaves the wire, and whenever a thread begins or ends to stream.
    news: Condvar,
    /// Held by the thread that meets the board: the board takes the configuration of one axis at a time.
    meeting: Mutex<()>,
}

impl SharedLine {
    /// Shares the line over `wire`.
    pub(super) fn new(wire: Box<dyn Wire>) -> Self {
        Self { line: Mutex::new(Line::new(wire)), news: Condvar::new(), meeting: Mutex::new(()) }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Line> {
        self.line.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets this thread meet the board, unless another one does.
    pub(super) fn try_meeting(&self) -> Option<MutexGuard<'_, ()>> {
        match self.meeting.try_lock() {
            Ok(meeting) => Some(meeting),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Notes that one thread more streams, or one less.
    pub(super) fn streams(&self, does: bool) {
        let mut line = self.lock();
        line.streaming = if does { line.streaming + 1 } else { line.streaming.saturating_sub(1) };
        self.news.notify_all();
    }

    /// Does something with the wire once no link waits at it. Returns `None` if the wire is closed.
    pub(super) fn with_wire<T>(&self, act: impl FnOnce(&mut dyn Wire) -> T) -> Option<T> {
        let line = self.lock();
        let mut line = self
            .news
            .wait_while(line, |line| line.wire().is_none() && !line.is_broken())
            .unwrap_or_else(PoisonError::into_inner);
        line.wire().map(|wire| act(wire.as_mut()))
    }

    /// Waits for bytes of the board, at the wire or for the news of the link that is there. Returns after a short time
    /// or at the first bytes, at `until` at the latest. `streams` tells that a thread waits that streams.
    pub(super) fn wait<'l>(
        &'l self,
        mut line: MutexGuard<'l, Line>,
        until: Duration,
        streams: bool,
    ) -> MutexGuard<'l, Line> {
        line.waiting += usize::from(streams);
        let mut line = if line.is_led {
            self.news.notify_all();
            self.news.wait(line).unwrap_or_else(PoisonError::into_inner)
        } else {
            self.lead(line, until)
        };
        line.waiting -= usize::from(streams);
        line
    }

    /// Waits at the wire for all links.
    fn lead<'l>(&'l self, mut line: MutexGuard<'l, Line>, until: Duration) -> MutexGuard<'l, Line> {
        line.is_led = true;
        let leads = Leads(self);
        // A board in virtual time stands while any thread works.
        let stands = line.wire().is_some_and(|wire| wire.stands_while_hosts_work());
        if stands {
            line = self
                .news
                .wait_while(line, |line| line.waiting < line.streaming)
                .unwrap_or_else(PoisonError::into_inner);
            line.send();
        }
        let look = if line.lanes.iter().filter(|lane| lane.is_taken).count() > 1 { SHORT_LOOK } else { LOOK };
        let left = until.saturating_sub(line.now());
        let wire = if left.is_zero() { None } else { line.take_wire() };
        drop(line);
        if let Some(mut wire) = wire {
            let mut buffer = [0; 512];
            let read = wire.read(&mut buffer, left.min(look));
            let mut line = self.lock();
            match read {
                Ok(count) => {
                    line.put_wire(wire);
                    line.take(buffer.get(..count).unwrap_or_default());
                    line.drain();
                    line.expire();
                    line.send();
                }
                Err(error) => line.breaks(&error),
            }
        }
        drop(leads);
        self.lock()
    }
}

/// Guard of a wait at the wire: however it ends, another link may wait there.
struct Leads<'a>(&'a SharedLine);

impl Drop for Leads<'_> {
    fn drop(&mut self) {
        let mut line = self.0.lock();
        line.is_led = false;
        if line.wire().is_none() {
            line.breaks(&io::Error::other("the wait for the board has failed"));
        }
        self.0.news.notify_all();
    }
}
