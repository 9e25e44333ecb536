//! A word before a motion, once nothing refuses it any more.

use std::fmt::{self, Debug, Formatter};
use std::ops::ControlFlow;

/// Function that a session calls just before a motion.
pub(in crate::bench) struct BeforeMotion<'a>(Box<dyn FnOnce() -> ControlFlow<()> + Send + 'a>);

impl<'a> BeforeMotion<'a> {
    pub(super) fn new(tell: impl FnOnce() -> ControlFlow<()> + Send + 'a) -> Self {
        Self(Box::new(tell))
    }

    /// Tells that the motor is about to move. A break calls the motion off.
    pub(in crate::bench) fn tell(self) -> ControlFlow<()> {
        (self.0)()
    }
}

impl Debug for BeforeMotion<'_> {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str("BeforeMotion")
    }
}
