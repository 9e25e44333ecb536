//! The stream: the segments of a move on their way to the node.

use pump_ctl::step::Segment;
use thiserror::Error;

use crate::packing::{Codec, Grain, PackError, Rounder};

/// The refusal of a segment or of a node's word. The stream is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StreamError {
    /// As many segments wait for the node as the stream holds.
    #[error("as many segments wait for the board as the stream holds; wait for an answer")]
    Full,
    /// The segment cannot be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The node asks for a segment that was never sent, or that it has taken before.
    #[error("the board asks for segment {next}, and holds those from {taken} to {sent}")]
    Astray {
        /// Number of the segment that the node asks for.
        next: u32,
        /// Number of segments that the node has confirmed.
        taken: u32,
        /// Number of segments that were sent.
        sent: u32,
    },
}

/// Segments for one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chunk {
    /// Number of the first segment in the move.
    pub first: u32,
    /// Number of segments.
    pub segments: u32,
    /// Number of bytes that they take.
    pub bytes: usize,
    /// Position after the last step of the last segment, signed steps.
    pub end: i64,
}

/// The segments of a move on their way to the node: rounded, numbered, and held until the node has taken them. Up to
/// `N` are held.
#[derive(Debug, Clone)]
pub struct Stream<const N: usize> {
    rounder: Rounder,
    held: [Segment; N],
    /// Number of segments that the node has taken, which are held no more.
    taken: u32,
    /// Number of segments that were sent.
    sent: u32,
    /// Number of segments that were pushed.
    pushed: u32,
    /// Number of segments that the node has room for, those taken included.
    limit: u32,
    /// Position after the segments that the node has taken, signed steps.
    taken_end: i64,
    /// Number of segments that were ever sent. It stays when some are sent again.
    reached: u32,
    /// Number of the first segment of a new plan that the node has not accepted yet.
    held_from: Option<u32>,
}

/// The segment at which a new plan takes over from the old one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Takeover {
    /// Number of the first segment of the new plan.
    pub first: u32,
    /// Position after the last step of the old plan, signed steps.
    pub position: i64,
}

impl<const N: usize> Stream<N> {
    /// Makes the stream of a move that begins at position `from`, signed steps. No segment is sent before
    /// [`Self::accepted`] has told the node's room.
    pub fn new(from: i64) -> Self {
        Self {
            rounder: Rounder::default(),
            held: [Segment::default(); N],
            taken: 0,
            sent: 0,
            pushed: 0,
            limit: 0,
            taken_end: from,
            reached: 0,
            held_from: None,
        }
    }

    /// Takes the next segment of the plan. Returns it as the node will make it.
    ///
    /// # Errors
    ///
    /// Fails with [`StreamError::Full`] if there is no room now, and with [`StreamError::Pack`] if the segment
    /// cannot be made.
    pub fn push(&mut self, segment: Segment) -> Result<Segment, StreamError> {
        if (self.pushed - self.taken) as usize >= N {
            return Err(StreamError::Full);
        }
        let segment = self.rounder.round(segment)?;
        if let Some(place) = self.held.get_mut(self.pushed as usize % N) {
            *place = segment;
        }
        self.pushed += 1;
        Ok(segment)
    }

    /// Returns the number of segments that can be pushed now.
    pub fn room(&self) -> usize {
        N - (self.pushed - self.taken) as usize
    }

    /// Returns the number of segments that the node has confirmed.
    pub fn taken(&self) -> u32 {
        self.taken
    }

    /// Returns the number of segments that were sent.
    pub fn sent(&self) -> u32 {
        self.sent
    }

    /// Packs segments into `bytes`, as many as fit and as the node has room for. The result is `None` if there are
    /// none to send now.
    ///
    /// The segments count as sent. Call [`super::Bracket::sent`] with the chunk's end before its bytes leave.
    pub fn chunk(&mut self, bytes: &mut [u8]) -> Option<Chunk> {
        let room = bytes.len();
        let mut rest = bytes;
        let mut codec = Codec::new(Grain::Fine);
        let first = self.sent;
        while self.sent < self.pushed.min(self.limit).min(self.held_from.unwrap_or(u32::MAX)) {
            let segment = self.held.get(self.sent as usize % N)?;
            if codec.write(segment, &mut rest).is_err() {
                break;
            }
            self.sent += 1;
        }
        self.reached = self.reached.max(self.sent);
        let segments = self.sent - first;
        (segments > 0).then(|| Chunk {
            first,
            segments,
            bytes: room - rest.len(),
            end: self.end_of(self.sent),
        })
    }

    /// Takes the node's word: segment `next` comes next, and `room` segments fit from there on. Both answers to
    /// segments and statuses of the move say so. A stream that has used its room learns of more from a status alone.
    ///
    /// # Errors
    ///
    /// Fails with [`StreamError::Astray`] if the node asks for a segment that was never sent.
    pub fn accepted(&mut self, next: u32, room: u16) -> Result<(), StreamError> {
        if next > self.sent {
            return Err(StreamError::Astray { next, taken: self.taken, sent: self.sent });
        }
        // Answers may come late, and out of order.
        if next > self.taken {
            self.taken_end = self.end_of(next);
            self.taken = next;
        }
        self.limit = self.limit.max(next.saturating_add(room.into()));
        Ok(())
    }

    /// Sends all segments from `next` on again, as after a new connection.
    ///
    /// # Errors
    ///
    /// Fails with [`StreamError::Astray`] if the node asks for a segment that was never sent, or that it has
    /// confirmed before.
    pub fn resume(&mut self, next: u32, room: u16) -> Result<(), StreamError> {
        if next < self.taken {
            return Err(StreamError::Astray { next, taken: self.taken, sent: self.sent });
        }
        self.accepted(next, room)?;
        self.sent = next;
        Ok(())
    }

    /// Drops the segments that were never sent, and returns where a new plan takes over: after all that were. Its
    /// segments are pushed from now on, and sent once the node has accepted the change ([`Self::go_on`]).
    ///
    /// ```
    /// use pump_ctl::step::Segment;
    /// use pump_link::sender::{Stream, Takeover};
    ///
    /// let mut stream = Stream::<8>::new(0);
    /// stream.accepted(0, 8)?;
    /// for _ in 0..3 {
    ///     stream.push(Segment { count: 5, interval: 500, add: 0, frac: 0 })?;
    /// }
    /// // One of them fits into the frame.
    /// let mut frame = [0; 5];
    /// assert_eq!(stream.chunk(&mut frame).map(|chunk| chunk.segments), Some(1));
    /// assert_eq!(stream.retarget(), Takeover { first: 1, position: 5 });
    /// stream.push(Segment { count: 9, interval: 500, add: 0, frac: 0 })?;
    /// assert_eq!(stream.chunk(&mut frame), None);
    /// stream.go_on();
    /// assert_eq!(stream.chunk(&mut frame).map(|chunk| chunk.end), Some(14));
    /// # Ok::<(), pump_link::sender::StreamError>(())
    /// ```
    pub fn retarget(&mut self) -> Takeover {
        self.pushed = self.reached.max(self.taken);
        self.rounder = Rounder::default();
        self.held_from = Some(self.pushed);
        Takeover { first: self.pushed, position: self.end_of(self.pushed) }
    }

    /// Lets the segments of a new plan go, since the node has accepted the change.
    pub fn go_on(&mut self) {
        self.held_from = None;
    }

    /// Returns the position after segment `number`, which is held or the last one taken.
    fn end_of(&self, number: u32) -> i64 {
        let steps = (self.taken..number).filter_map(|n| self.held.get(n as usize % N));
        steps.fold(self.taken_end, |end, segment| end.saturating_add(segment.count.into()))
    }
}
