//! The offsets and drifts that a clock may have: a convex polygon.

/// Point of the plane: an offset and a drift of the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Offset of the clock at the reference time, s.
    pub(super) offset: f64,
    /// Relative deviation of the clock's rate from its nominal one.
    pub(super) drift: f64,
}

/// Condition on a clock: offset + lever · drift is `most` at most, with `sign` 1, or `-most` at least, with `sign` -1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Condition {
    pub(super) sign: f64,
    /// Time after the reference time at which the condition was seen, s. It is negative for the past.
    pub(super) lever: f64,
    pub(super) most: f64,
}

impl Condition {
    /// Returns how far a point is from the border, s. It is negative for a point that fails the condition.
    pub(super) fn room(&self, point: Point) -> f64 {
        self.most - self.sign * (point.offset + self.lever * point.drift)
    }
}

/// Offsets and drifts that a clock may have. It is never empty.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Region {
    /// Corners in order.
    corners: Vec<Point>,
}

impl Region {
    /// Makes the region of offsets from `least` to `most`, in s, and of drifts up to `drift` either way.
    pub(super) fn new(least: f64, most: f64, drift: f64) -> Self {
        let corners = [(least, -drift), (most, -drift), (most, drift), (least, drift)];
        Self { corners: corners.map(|(offset, drift)| Point { offset, drift }).to_vec() }
    }

    /// Returns the part of the region that satisfies a condition. `None` if no part does.
    ///
    /// Each edge that crosses the border is cut there (Sutherland and Hodgman, Reentrant polygon clipping, 1974).
    pub(super) fn cut(&self, condition: Condition) -> Option<Self> {
        let mut corners = Vec::with_capacity(self.corners.len() + 1);
        let before = self.corners.iter().cycle().skip(self.corners.len().saturating_sub(1));
        for (&from, &to) in before.zip(&self.corners) {
            let (room_from, room_to) = (condition.room(from), condition.room(to));
            if (room_from < 0.0) != (room_to < 0.0) {
                let share = room_from / (room_from - room_to);
                let between = |from: f64, to: f64| from + share * (to - from);
                corners.push(Point {
                    offset: between(from.offset, to.offset),
                    drift: between(from.drift, to.drift),
                });
            }
            if room_to >= 0.0 {
                corners.push(to);
            }
        }
        (!corners.is_empty()).then_some(Self { corners })
    }

    /// Returns the least and the most of a quantity that has both at corners.
    pub(super) fn range(&self, quantity: impl Fn(Point) -> f64) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.corners
            .iter()
            .map(|point| quantity(*point))
            .fold(start, |(least, most), now| (least.min(now), most.max(now)))
    }
}
