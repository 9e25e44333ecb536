//! The blocks under way: sent, and not confirmed.

use std::collections::VecDeque;
use std::time::Duration;

use super::resend_timer::ResendTimer;
use crate::drives::klipper::protocol::{BLOCK_MOST, SYNC, block};

/// Number of sequence numbers.
///
/// Source: Klipper3d/klipper, `docs/Protocol.md`, "Message Blocks": 4 bits.
const SEQUENCES: u64 = 16;

/// Most blocks under way. A confirmation tells which blocks it is for as long as they are fewer than the sequence
/// numbers. The rest shows a board that is at another block altogether.
const BLOCKS_MOST: usize = 12;

/// Bytes under way before the board has told how many it holds: one block of any length.
const BYTES_FIRST: usize = BLOCK_MOST;

/// Number of sent blocks whose times are kept.
const TIMES_MOST: usize = 64;

/// Block under way.
#[derive(Debug)]
struct Sent {
    bytes: Vec<u8>,
    /// Time of the first sending.
    first: Duration,
    /// True if the block was sent more than once.
    is_repeated: bool,
}

/// Finding of a block that came from the board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Heard {
    /// Number of the last block that the board has taken. `None` if it is none of this window.
    pub(super) taken: Option<u64>,
    /// True if the board asks for the blocks under way again.
    pub(super) asks_again: bool,
}

/// Blocks under way, numbered without end. Their low 4 bits are the sequence numbers.
#[derive(Debug)]
pub(super) struct Window {
    /// Number of the oldest block under way, or of the next one if none is.
    oldest: u64,
    sent: VecDeque<Sent>,
    bytes_most: usize,
    timer: ResendTimer,
    resend_at: Duration,
    /// Number from which on the board's refusals count again. Refusals before are echoes of the last repetition.
    echoes_until: u64,
    /// Time of the last confirmation, or of the first block after a pause.
    progress_at: Duration,
    /// Sequence number that the board told last, if it is none of this window.
    astray: Option<u8>,
    /// Times of the first sending of the last blocks.
    times: VecDeque<(u64, Duration)>,
}

impl Window {
    /// Makes a window of a board that takes the block `sequence` next.
    pub(super) fn new(sequence: u8) -> Self {
        Self {
            // The number before is a number too.
            oldest: SEQUENCES + u64::from(sequence),
            sent: VecDeque::new(),
            bytes_most: BYTES_FIRST,
            timer: ResendTimer::new(),
            resend_at: Duration::ZERO,
            echoes_until: 0,
            progress_at: Duration::ZERO,
            astray: None,
            times: VecDeque::new(),
        }
    }

    /// Makes the window of a board that is found anew, and takes the block `sequence` next. Numbers go on from those
    /// of this window, so that an old number is that of no new block.
    pub(super) fn anew(&self, sequence: u8) -> Self {
        let next = self.next();
        let ahead = u64::from(sequence).wrapping_sub(next) % SEQUENCES;
        Self { oldest: next + ahead, bytes_most: self.bytes_most, ..Self::new(sequence) }
    }

    /// Sets the most bytes under way. A block is always sent if none is under way.
    pub(super) fn set_bytes_most(&mut self, bytes: usize) {
        self.bytes_most = bytes;
    }

    /// Returns the number of the next block.
    pub(super) fn next(&self) -> u64 {
        self.oldest + self.sent.len() as u64
    }

    /// Returns the number of blocks under way.
    pub(super) fn under_way(&self) -> usize {
        self.sent.len()
    }

    /// Sends a block of this content, if there is room. Returns its bytes.
    pub(super) fn send(&mut self, content: &[u8], now: Duration, steady: Duration) -> Option<&[u8]> {
        let bytes = block(self.next() as u8, content);
        let under_way: usize = self.sent.iter().map(|sent| sent.bytes.len()).sum();
        let has_room = self.sent.len() < BLOCKS_MOST && under_way + bytes.len() <= self.bytes_most;
        if !self.sent.is_empty() && !has_room {
            return None;
        }
        if self.sent.is_empty() {
            self.progress_at = now;
            self.resend_at = now + self.timer.wait();
        }
        if self.times.len() == TIMES_MOST {
            self.times.pop_front();
        }
        self.times.push_back((self.next(), steady));
        self.sent.push_back(Sent { bytes, first: now, is_repeated: false });
        self.sent.back().map(|sent| sent.bytes.as_slice())
    }

    /// Returns the time at which a block was sent first. `None` if it was not sent yet, or long ago.
    pub(super) fn sent_at(&self, number: u64) -> Option<Duration> {
        self.times.iter().find(|(sent, _)| *sent == number).map(|(_, at)| *at)
    }

    /// Takes the sequence number of a block that came from the board: that of the block which the board takes next. A
    /// bare block has no content.
    pub(super) fn hear(&mut self, sequence: u8, is_bare: bool, now: Duration) -> Heard {
        let confirmed = u64::from(sequence).wrapping_sub(self.oldest) % SEQUENCES;
        if confirmed > self.sent.len() as u64 {
            self.astray = Some(sequence);
            return Heard { taken: None, asks_again: false };
        }
        for _ in 0..confirmed {
            if let Some(sent) = self.sent.pop_front()
                && !sent.is_repeated
            {
                self.timer.take(now.saturating_sub(sent.first));
            }
        }
        self.oldest += confirmed;
        self.astray = None;
        if confirmed > 0 {
            (self.progress_at, self.resend_at) = (now, now + self.timer.wait());
        }
        // The board refuses a block by the number that it has told before, without content.
        let refuses = confirmed == 0 && is_bare && !self.sent.is_empty();
        let asks_again = refuses && self.oldest >= self.echoes_until;
        Heard { taken: Some(self.oldest - 1), asks_again }
    }

    /// Returns true if the blocks under way have waited for too long.
    pub(super) fn is_due(&self, now: Duration) -> bool {
        !self.sent.is_empty() && now >= self.resend_at
    }

    /// Returns the time at which [`Self::is_due`] will be true. `None` without blocks under way.
    pub(super) fn wakes_at(&self) -> Option<Duration> {
        (!self.sent.is_empty()).then_some(self.resend_at)
    }

    /// Returns the bytes of all blocks under way, to be sent again.
    ///
    /// An end mark before them ends what the board may have of a torn block. A board that has not answered at all may
    /// wait for the rest of a block whose length was damaged, so it is sent as many end marks as the longest has bytes.
    pub(super) fn repeat(&mut self, now: Duration) -> Vec<u8> {
        let mut bytes = vec![SYNC];
        if self.is_due(now) {
            self.timer.double();
            bytes = vec![SYNC; BLOCK_MOST];
        }
        self.resend_at = now + self.timer.wait();
        self.echoes_until = self.next();
        for sent in &mut self.sent {
            sent.is_repeated = true;
            bytes.extend_from_slice(&sent.bytes);
        }
        bytes
    }

    /// Returns the time for which blocks under way were not confirmed.
    pub(super) fn waited(&self, now: Duration) -> Duration {
        if self.sent.is_empty() { Duration::ZERO } else { now.saturating_sub(self.progress_at) }
    }

    /// Returns the sequence number that the board told last, if it is none of this window.
    pub(super) fn astray(&self) -> Option<u8> {
        self.astray
    }
}
