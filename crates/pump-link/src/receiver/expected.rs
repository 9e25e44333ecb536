//! The segments that come next.

/// A segment that has arrived, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// The segment comes next.
    Next,
    /// The segment came before, and is ignored.
    Repeated,
    /// Segments before it are missing.
    Gap,
}

/// The number of the segment that comes next, so that each is taken once and in order.
///
/// ```
/// use pump_link::receiver::{Arrival, Expected};
///
/// let mut expected = Expected::default();
/// assert_eq!(expected.arrival(0), Arrival::Next);
/// expected.taken();
/// assert_eq!(expected.arrival(0), Arrival::Repeated);
/// assert_eq!(expected.arrival(2), Arrival::Gap);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Expected {
    next: u32,
}

impl Expected {
    /// Returns the number of the segment that comes next, from 0.
    pub fn next(self) -> u32 {
        self.next
    }

    /// Says if a segment of this number is the next.
    pub fn arrival(self, number: u32) -> Arrival {
        match number.cmp(&self.next) {
            core::cmp::Ordering::Less => Arrival::Repeated,
            core::cmp::Ordering::Equal => Arrival::Next,
            core::cmp::Ordering::Greater => Arrival::Gap,
        }
    }

    /// Notes that the next segment was taken.
    pub fn taken(&mut self) {
        self.next = self.next.saturating_add(1);
    }
}
