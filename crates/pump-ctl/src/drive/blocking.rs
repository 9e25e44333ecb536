//! A whole move in one call.

use core::iter::Peekable;

use super::actuator::{Actuator, Timer};
use super::clock::Clock;
use super::error::Fault;
use super::motion::Motion;
use crate::step::Segment;

impl<M: Motion, const Q: usize> Actuator<M, Q> {
    /// Makes all steps of `segments` and returns when the motor stands. `stop` is asked over and over between steps;
    /// once it says true the motor decelerates.
    ///
    /// Segments that do not fit into the queue are computed between steps: on a processor without f64 in hardware choose
    /// `Q` large enough for all of them, or steps come late.
    pub fn run(
        &mut self,
        clock: &mut impl Clock,
        segments: &mut Peekable<impl Iterator<Item = Segment>>,
        mut stop: impl FnMut() -> bool,
    ) -> Result<(), Fault<M::Error>> {
        self.stepper().fill(segments)?;
        let mut due = self.start(clock.now())?;
        let mut stopping = false;
        loop {
            let now = clock.now();
            if now >= due {
                match self.on_timer(now)? {
                    Timer::At(next) => due = next,
                    Timer::Done => return Ok(()),
                }
            } else if stopping {
                continue;
            } else if stop() {
                stopping = true;
                self.stop(now);
                due = self.stepper().next_deadline().unwrap_or(now);
            } else {
                self.stepper().fill(segments)?;
            }
        }
    }
}
