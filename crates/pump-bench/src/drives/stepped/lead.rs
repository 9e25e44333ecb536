//! The leave for steps, as the thread that asks the gate hands it to the thread that makes the steps.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::drives::{Gate, Leave};

/// No step, in place of a step's number.
const NONE: u64 = u64::MAX;

/// Leave for the steps of a motion, and the steps made.
#[derive(Debug)]
pub(in crate::drives) struct Lead {
    /// Last step that has leave. It never falls.
    left: AtomicU64,
    /// Steps made.
    made: AtomicU64,
    /// True once the motion is to end before its plan.
    stops: AtomicBool,
    /// Step at which the index sensor became active.
    index_at: AtomicU64,
}

impl Lead {
    /// Begins with no step made, and none that has leave.
    pub(in crate::drives) fn new() -> Self {
        Self {
            left: AtomicU64::new(0),
            made: AtomicU64::new(0),
            stops: AtomicBool::new(false),
            index_at: AtomicU64::new(NONE),
        }
    }

    /// Begins with leave for all steps.
    #[cfg(any(feature = "node", feature = "klipper"))]
    pub(in crate::drives) fn free() -> Self {
        let free = Self::new();
        free.left.store(NONE, Ordering::Release);
        free
    }

    /// Returns the last step that has leave.
    pub(in crate::drives) fn left(&self) -> u64 {
        self.left.load(Ordering::Acquire)
    }

    /// Returns true once the motion is to end before its plan.
    pub(in crate::drives) fn stops(&self) -> bool {
        self.stops.load(Ordering::Acquire)
    }

    /// Has the motion end.
    pub(in crate::drives) fn stop(&self) {
        self.stops.store(true, Ordering::Release);
    }

    /// Counts a step that was made. Returns its number.
    pub(in crate::drives) fn count(&self) -> u64 {
        self.made.fetch_add(1, Ordering::AcqRel) + 1
    }

    /// Notes that the index sensor became active at step `number`, where the motion is to end.
    pub(in crate::drives) fn found(&self, number: u64) {
        self.index_at.store(number, Ordering::Release);
        self.stop();
    }

    /// Returns the step at which the index sensor became active.
    pub(in crate::drives) fn index_at(&self) -> Option<u64> {
        Some(self.index_at.load(Ordering::Acquire)).filter(|number| *number != NONE)
    }

    /// Asks `gate` for leave up to `ahead` steps before the motor, of `all`, some steps at a time. If nothing is to be
    /// asked for, the gate may still say stop.
    pub(in crate::drives) fn ask(&self, gate: &mut Gate<'_>, all: u64, ahead: u64) {
        let some = ahead.div_ceil(8).max(1);
        loop {
            let (made, left) = (self.made.load(Ordering::Acquire), self.left());
            let wants = left < all && left.saturating_sub(made) < ahead;
            let about_to = if wants { (left + some).min(all) } else { left };
            match gate(made, about_to) {
                Leave::Go => self.left.store(about_to, Ordering::Release),
                Leave::Wait => return,
                Leave::Stop => return self.stop(),
            }
            if !wants {
                return;
            }
        }
    }
}

/// Guard of a motion: however the thread that asks the gate ends, the motor stops.
#[derive(Debug)]
pub(in crate::drives) struct Ends<'a>(pub(in crate::drives) &'a Lead);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.stop();
    }
}
