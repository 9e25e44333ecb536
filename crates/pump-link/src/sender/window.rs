//! The window: requests under way, and when to send them again.

use thiserror::Error;

use crate::frame::{Encoded, FrameError, RequestHeader};
use crate::message::Request;

/// Time after which a request without an answer is sent again, ns: 50 ms.
pub const RESEND_NS: u64 = 50_000_000;

/// Number of answers to one request, lost one after another with no other answer in between, that are a lost link.
pub const LOST_ANSWERS: u8 = 3;

/// Number of times that one request is sent at most, however well others are answered.
pub const MOST_SENDS: u8 = 20;

/// The refusal to take a request. Nothing has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WindowError {
    /// As many requests are under way as the window holds.
    #[error("as many requests are under way as the window holds; wait for an answer")]
    Full,
    /// The request makes no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// The loss of the link: a request stays without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the board did not answer a request that was sent {sends} times")]
pub struct LinkLost {
    /// Number of times that the request was sent.
    pub sends: u8,
}

/// A request that was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answered {
    /// Time at which the request was sent, ns. It is unknown for a request that was sent more than once, because
    /// either may have been answered (Karn and Partridge, SIGCOMM 1987).
    pub sent_at_ns: Option<u64>,
    /// Lane that the request was given to.
    pub lane: Option<u8>,
}

/// Up to `N` requests under way. Times are the host's, ns, and never fall.
///
/// Requests of one lane must be taken in order, as the segments of an axis. A request is sent again
/// [`RESEND_NS`] after it was sent last. Call [`Self::expire`] only after all bytes that have arrived were given to
/// the deframer: a host that was held up has answers waiting, and nothing is lost.
///
/// ```
/// use pump_link::message::Request;
/// use pump_link::sender::{LinkLost, Window};
///
/// const MS: u64 = 1_000_000;
/// let mut window = Window::<4>::new(17);
/// window.request(&Request::Identify, None)?;
/// for now in [0, 50 * MS, 100 * MS] {
///     assert_eq!(window.expire(now), Ok(()));
///     assert!(window.next_to_send(now).is_some());
/// }
/// assert_eq!(window.expire(150 * MS), Err(LinkLost { sends: 3 }));
/// # Ok::<(), pump_link::sender::WindowError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Window<const N: usize> {
    session: u64,
    next_number: u16,
    /// Order of the next request. It does not wrap, unlike its number.
    next_order: u64,
    pending: [Option<Pending>; N],
}

#[derive(Debug, Clone, Copy)]
struct Pending {
    number: u16,
    order: u64,
    lane: Option<u8>,
    frame: Encoded,
    sent_at_ns: u64,
    sends: u8,
    /// Number of answers lost since any request was answered.
    lost: u8,
    /// True if the frame is to be sent, for the first time or again.
    due: bool,
}

impl<const N: usize> Window<N> {
    /// Makes a window for the frames of a session.
    pub const fn new(session: u64) -> Self {
        Self { session, next_number: 0, next_order: 0, pending: [None; N] }
    }

    /// Returns the session number that the frames carry.
    pub fn session(&self) -> u64 {
        self.session
    }

    /// Returns the number of requests under way.
    pub fn len(&self) -> usize {
        self.pending.iter().flatten().count()
    }

    /// Returns true if no request is under way.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Takes a request. Returns the number that its answer will have.
    ///
    /// # Errors
    ///
    /// Fails with [`WindowError::Full`] if `N` requests are under way, and with [`WindowError::Frame`] if the
    /// request does not fit into a frame.
    pub fn request(&mut self, request: &Request<'_>, lane: Option<u8>) -> Result<u16, WindowError> {
        let place = self.pending.iter_mut().find(|place| place.is_none()).ok_or(WindowError::Full)?;
        let number = self.next_number;
        let frame = Encoded::request(RequestHeader { number, session: self.session }, request)?;
        let order = self.next_order;
        *place = Some(Pending { number, order, lane, frame, sent_at_ns: 0, sends: 0, lost: 0, due: true });
        self.next_number = number.wrapping_add(1);
        self.next_order += 1;
        Ok(number)
    }

    /// Returns the frame to send now, the oldest first, or `None` if there is none. The frame counts as sent at
    /// `now_ns`.
    pub fn next_to_send(&mut self, now_ns: u64) -> Option<Encoded> {
        let due = self.pending.iter_mut().flatten().filter(|pending| pending.due);
        let next = due.min_by_key(|pending| pending.order)?;
        next.due = false;
        next.sends = next.sends.saturating_add(1);
        next.sent_at_ns = now_ns;
        Some(next.frame)
    }

    /// Takes note of a valid answer. Returns the request that it answers, or `None` if that was answered before.
    pub fn answered(&mut self, number: u16) -> Option<Answered> {
        self.heard();
        let place =
            self.pending.iter_mut().find(|place| place.is_some_and(|pending| pending.number == number))?;
        let pending = place.take()?;
        let once = pending.sends == 1 && !pending.due;
        Some(Answered { sent_at_ns: once.then_some(pending.sent_at_ns), lane: pending.lane })
    }

    /// Takes note of an answer that says that requests before this one of its lane are missing. They are sent again,
    /// and this one after them.
    pub fn gap(&mut self, number: u16) {
        self.heard();
        let asked =
            self.pending.iter().flatten().find(|pending| pending.number == number && pending.sends > 0);
        let Some(Pending { order, lane, sent_at_ns, .. }) = asked.copied() else {
            return;
        };
        for pending in self.pending.iter_mut().flatten() {
            // An earlier request that was sent since then may have closed the gap.
            let before = pending.order < order && pending.sent_at_ns <= sent_at_ns;
            if pending.order == order || (pending.lane == lane && before) {
                pending.due = true;
            }
        }
    }

    /// Finds the requests whose answers are overdue, and sends them again. Call it after all input was read.
    ///
    /// # Errors
    ///
    /// Fails with [`LinkLost`] if [`LOST_ANSWERS`] of one request were lost with no answer in between, or if a
    /// request was sent [`MOST_SENDS`] times.
    pub fn expire(&mut self, now_ns: u64) -> Result<(), LinkLost> {
        for pending in self.pending.iter_mut().flatten() {
            if pending.due || now_ns.saturating_sub(pending.sent_at_ns) < RESEND_NS {
                continue;
            }
            pending.lost = pending.lost.saturating_add(1);
            if pending.lost >= LOST_ANSWERS || pending.sends >= MOST_SENDS {
                return Err(LinkLost { sends: pending.sends });
            }
            pending.due = true;
        }
        Ok(())
    }

    /// Has the requests under way sent again after a lost link, in the same session. Answers are counted anew.
    ///
    /// ```
    /// use pump_link::message::Request;
    /// use pump_link::sender::Window;
    ///
    /// let mut window = Window::<4>::new(17);
    /// let number = window.request(&Request::Identify, None)?;
    /// assert!(window.next_to_send(0).is_some());
    /// window.renew();
    /// assert!(window.next_to_send(1).is_some());
    /// // Either of two frames may have been answered.
    /// assert_eq!(window.answered(number).unwrap().sent_at_ns, None);
    /// # Ok::<(), pump_link::sender::WindowError>(())
    /// ```
    pub fn renew(&mut self) {
        for pending in self.pending.iter_mut().flatten() {
            pending.due = true;
            pending.lost = 0;
            pending.sends = pending.sends.min(1);
        }
    }

    /// Returns the time at which to call [`Self::expire`] next, ns, or `None` if no request waits for its answer.
    pub fn next_expiry_ns(&self) -> Option<u64> {
        let waiting = self.pending.iter().flatten().filter(|pending| !pending.due);
        waiting.map(|pending| pending.sent_at_ns.saturating_add(RESEND_NS)).min()
    }

    /// Forgets the requests under way, as before a new connection. Their numbers are not used again.
    pub fn clear(&mut self) {
        self.pending = [None; N];
    }

    /// Forgets one request under way, by its number. An answer to it counts as late.
    pub fn forget(&mut self, number: u16) {
        for place in &mut self.pending {
            if place.is_some_and(|pending| pending.number == number) {
                *place = None;
            }
        }
    }

    /// Takes note of the node: the link lives.
    fn heard(&mut self) {
        self.pending.iter_mut().flatten().for_each(|pending| pending.lost = 0);
    }
}
