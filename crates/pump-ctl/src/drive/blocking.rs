//! The blocking driver: a whole move in one call.

use super::actuator::{Actuator, Timer};
use super::clock::Clock;
use super::error::Fault;
use super::step_motor::StepMotor;
use crate::step::{Feed, PushError, Segment, StartError};

impl<M: StepMotor, const Q: usize> Actuator<M, Q> {
    /// Makes all steps of `segments` and returns when the motor stands.
    ///
    /// The call asks `stop` over and over. Once `stop` returns true, the motor decelerates. A segment that is
    /// refused on the way makes the motor decelerate too.
    ///
    /// Segments that do not fit into the queue are computed between steps. On a processor without f64 in
    /// hardware, choose `Q` large enough for all of them, or steps come late.
    ///
    /// # Errors
    ///
    /// Fails with [`Fault::NotEnabled`], [`Fault::Push`] or [`Fault::Start`] if the move cannot begin. A move
    /// under way ends early with [`Fault::Motor`], [`Fault::Starved`], [`Fault::Late`] or [`Fault::Push`].
    pub fn run(
        &mut self,
        clock: &mut impl Clock,
        segments: &mut Feed<impl Iterator<Item = Segment>>,
        mut stop: impl FnMut() -> bool,
    ) -> Result<(), Fault<M::Error>> {
        let mut due = self.begin(clock, segments)?;
        let mut stopping = false;
        let mut refused = None;
        loop {
            let now = clock.now();
            if !stopping && stop() {
                stopping = true;
                self.stop(now);
                due = self.stepper().next_deadline().unwrap_or(now);
            }
            if now >= due {
                match self.on_timer(now)? {
                    Timer::At(next) => due = next,
                    Timer::Done => return refused.map_or(Ok(()), |error| Err(Fault::Push(error))),
                }
            } else if !stopping && let Err(error) = self.stepper().fill(segments) {
                // A motor that was late or starved refuses segments too. Its own fault is told at the end.
                refused = Some(error);
                stopping = true;
                self.stop(now);
                due = self.stepper().next_deadline().unwrap_or(now);
            }
        }
    }

    /// Queues the first segments and starts the move. A segment that is refused leaves nothing queued.
    fn begin(
        &mut self,
        clock: &mut impl Clock,
        segments: &mut Feed<impl Iterator<Item = Segment>>,
    ) -> Result<u64, Fault<M::Error>> {
        if !self.enabled {
            return Err(Fault::NotEnabled);
        }
        let begun = match self.stepper().fill(segments) {
            Ok(_) => self.start(clock.now()),
            Err(error) => Err(error.into()),
        };
        if let Err(Fault::Push(PushError::Segment(_)) | Fault::Start(StartError::Empty)) = begun {
            // The motor stands: nothing has begun.
            let _ = self.stepper().clear();
        }
        begun
    }
}
