//! The bracket: where the motor may be when the node cannot say.

/// The positions that a motor may have reached, from what the node has reported and what was sent to it.
///
/// While a node keeps its session, its own count is the truth. A node that was reset has lost it, and the true
/// position is in the bracket. All positions are in signed steps.
///
/// ```
/// use pump_link::sender::Bracket;
///
/// let mut bracket = Bracket::new(1_000, -500, 20);
/// bracket.sent(400);
/// bracket.reported(900);
/// assert_eq!(bracket.range(), (380, 900));
/// // Nothing makes the motor go beyond the end of its move.
/// bracket.sent(-490);
/// assert_eq!(bracket.range(), (-500, 900));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bracket {
    from: i64,
    /// Position farthest back at which the motor may be.
    reported: i64,
    /// Position at the end of the segments that were sent.
    sent: i64,
    last: i64,
    brake_steps: u32,
    /// True if the move goes forward.
    forward: bool,
}

impl Bracket {
    /// Makes the bracket of a move from the position `from` to `last`. Its brake takes `brake_steps` at most.
    pub const fn new(from: i64, last: i64, brake_steps: u32) -> Self {
        Self { from, reported: from, sent: from, last, brake_steps, forward: last >= from }
    }

    /// Notes a position that the node has reported.
    pub fn reported(&mut self, position: i64) {
        self.reported = self.farther(self.reported, position);
    }

    /// Notes the position at the end of segments that were sent, before they are sent.
    pub fn sent(&mut self, end: i64) {
        self.sent = self.farther(self.sent, end);
    }

    /// Notes that the move is to end at `last`, before the node is told. The farther of both ends counts from now on.
    ///
    /// ```
    /// use pump_link::sender::Bracket;
    ///
    /// let mut bracket = Bracket::new(0, 100, 20);
    /// bracket.sent(90);
    /// bracket.retargeted(200);
    /// bracket.sent(150);
    /// assert_eq!(bracket.range(), (0, 170));
    /// ```
    pub fn retargeted(&mut self, last: i64) {
        self.last = self.farther(self.last, last);
    }

    /// Returns the least and the largest position at which the motor may be.
    ///
    /// A motor that runs out of segments at speed needs steps to come to rest. They count as long as the move has
    /// any.
    pub fn range(&self) -> (i64, i64) {
        let way = i64::from(self.brake_steps);
        let stopped = if self.sent == self.from {
            // No segment was sent.
            self.from
        } else if self.forward {
            self.sent.saturating_add(way).min(self.last)
        } else {
            self.sent.saturating_sub(way).max(self.last)
        };
        (self.reported.min(stopped), self.reported.max(stopped))
    }

    /// Returns whichever position is farther on the way to the move's end.
    fn farther(&self, one: i64, other: i64) -> i64 {
        if self.forward { one.max(other) } else { one.min(other) }
    }
}
