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
    /// Told whenever a link leaves the wire.
    news: Condvar,
    /// Told whenever a thread begins or ends to stream, and whenever one waits for the link at the wire. Only the link
    /// at the wire of a board in virtual time hears it: others that heard it would wake each other without end.
    work: Condvar,
    /// Held by the thread that meets the board: the board takes the configuration of one axis at a time.
    meeting: Mutex<()>,
}

impl SharedLine {
    /// Shares the line over `wire`.
    pub(super) fn new(wire: Box<dyn Wire>) -> Self {
        let (line, meeting) = (Mutex::new(Line::new(wire)), Mutex::new(()));
        Self { line, news: Condvar::new(), work: Condvar::new(), meeting }
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
        self.work.notify_all();
    }

    /// Does something with the wire once no link waits at it. Returns `None` if the wire is closed.
    pub(super) fn with_wire<T>(&self, act: impl FnOnce(&mut dyn Wire) -> T) -> Option<T> {
        self.with_free(|line| line.wire().map(|wire| act(wire.as_mut())))
    }

    /// Does something with the line once no link waits at its wire.
    pub(super) fn with_free<T>(&self, act: impl FnOnce(&mut Line) -> T) -> T {
        let line = self.lock();
        let mut line = self
            .news
            .wait_while(line, |line| line.wire().is_none() && !line.is_broken())
            .unwrap_or_else(PoisonError::into_inner);
        act(&mut line)
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
            self.work.notify_all();
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
                .work
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Instant;

    use super::*;

    /// Wire in real time to a board that says nothing. It counts the waits at it.
    #[derive(Debug)]
    struct Silent {
        began: Instant,
        waits: Arc<AtomicUsize>,
    }

    impl Wire for Silent {
        fn read(&mut self, _buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
            self.waits.fetch_add(1, Ordering::Relaxed);
            thread::sleep(wait);
            Ok(0)
        }

        fn write(&mut self, _bytes: &[u8]) -> io::Result<()> {
            Ok(())
        }

        fn now(&mut self) -> Duration {
            self.began.elapsed()
        }

        fn sleep(&mut self, time: Duration) {
            thread::sleep(time);
        }
    }

    #[test]
    fn links_of_one_board_wake_once_for_each_wait_at_the_wire() {
        for links in [2, 3, 4] {
            let (waits, wakes) = (Arc::new(AtomicUsize::new(0)), AtomicUsize::new(0));
            let wire = Silent { began: Instant::now(), waits: Arc::clone(&waits) };
            let shared = SharedLine::new(Box::new(wire));
            let until = Duration::from_millis(200);
            thread::scope(|scope| {
                for _ in 0..links {
                    scope.spawn(|| {
                        shared.streams(true);
                        let mut line = shared.lock();
                        while line.now() < until {
                            line = shared.wait(line, until, true);
                            wakes.fetch_add(1, Ordering::Relaxed);
                        }
                        drop(line);
                        shared.streams(false);
                    });
                }
            });
            let (waits, wakes) = (waits.load(Ordering::Relaxed), wakes.load(Ordering::Relaxed));
            // The last waits of all links end after the time, without one at the wire.
            assert!(
                (1..=(waits + links) * links).contains(&wakes),
                "{links} links, {waits} waits: {wakes} wakes"
            );
        }
    }
}
