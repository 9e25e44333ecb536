//! A search that its caller may stop.

use core::cell::Cell;

/// Number of steps of the model between two questions: a fraction of a millisecond.
const EVERY: u32 = 256;

/// Question whether a search goes on, asked now and then.
pub(super) struct Watch<'a> {
    goes_on: &'a dyn Fn() -> bool,
    steps: Cell<u32>,
    stopped: Cell<bool>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(goes_on: &'a dyn Fn() -> bool) -> Self {
        Self { goes_on, steps: Cell::new(0), stopped: Cell::new(false) }
    }

    /// Counts a step of the model. Returns false once the caller has stopped the search.
    pub(super) fn goes_on(&self) -> bool {
        let steps = self.steps.get() + 1;
        self.steps.set(steps % EVERY);
        if steps == EVERY && !self.stopped.get() {
            self.stopped.set(!(self.goes_on)());
        }
        !self.stopped.get()
    }

    /// Returns true if the caller has stopped the search, so that its numbers have no meaning.
    pub(super) fn is_stopped(&self) -> bool {
        self.stopped.get()
    }
}
