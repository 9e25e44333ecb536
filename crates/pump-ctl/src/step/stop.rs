//! A stop in the midst of a move.

use super::braking::WayDown;
use super::queue::Slot;
use super::segment::Segment;
use super::state::StepperState;
use super::stepper::Stepper;
use super::ticks::Ticks;

/// The end of a stop, known when the stop begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StopPlan {
    /// Time at which the last step is due, ticks. It is the start of the move if no step is made.
    pub last_step_at: u64,
    /// Position after the last step, signed steps.
    pub final_count: i64,
}

/// The planned steps up to the next turn-round or the end of the queue, and the way down from there if the
/// plan goes on.
struct PlannedEnd {
    steps: u64,
    ends: Ticks,
    /// Number of segments of these steps that are still to come.
    segments: usize,
    /// True if the steps end at rest. False if they end where the segments queued so far end.
    rests: bool,
}

impl<const Q: usize> Stepper<Q> {
    /// Decelerates from the next step on until the motor stands, and drops the queued segments. A motor slow
    /// enough stands at once.
    ///
    /// If the plan itself comes to rest as soon, the motor follows it to that rest. A stop never adds steps
    /// to a plan that is [`Self::finish`]ed. It may add one step to a plan that is not.
    ///
    /// If a step is overdue at `now` when the brake takes over, the way down begins at `now`. The delay is
    /// not made up for. A second call changes nothing.
    pub fn stop(&mut self, now: u64) -> StopPlan {
        match self.state {
            StepperState::Ready | StepperState::Stopped | StepperState::Starved => {
                self.refuse_what_is_queued()
            }
            StepperState::Ending { .. } => self.planned_end(&self.planned_run()),
            StepperState::Braking { way, .. } => {
                let (steps, span) = way.length(&self.brake);
                let current = self.queue.current().copied().unwrap_or_default();
                self.after_step(&current, current.segment.steps(), steps, span)
            }
            StepperState::Moving => self.stop_moving(now),
        }
    }

    fn refuse_what_is_queued(&mut self) -> StopPlan {
        self.queue.keep_pending(0);
        if self.state == StepperState::Ready {
            self.state = StepperState::Stopped;
        }
        StopPlan { last_step_at: self.next.whole, final_count: self.position }
    }

    fn stop_moving(&mut self, now: u64) -> StopPlan {
        // The motor stands before its first step and where it turns round, however short the interval to
        // come.
        let turning = self.last_direction == Some(self.direction);
        let descent = self.brake.descent_from(self.interval.fixed()).filter(|_| turning);
        let Some(descent) = descent else {
            return self.stand();
        };
        let (steps, span) = self.brake.length(&descent);
        let most = u64::from(steps) + 1;
        if !self.runs_beyond(most) {
            let run = self.planned_run();
            if run.steps <= most {
                self.queue.keep_pending(run.segments);
                self.state = StepperState::Ending { rests: run.rests };
                return self.planned_end(&run);
            }
        }

        self.state = StepperState::Braking { way: WayDown::Brake(descent), starved: false };
        self.queue.keep_pending(0);
        let made = self.made_of_current();
        if now > self.next.whole {
            self.queue.cut(made);
            self.next = Ticks::middle_of(now);
            let here = Slot { began: self.next, from: self.position, ..Slot::default() };
            self.load();
            return self.after_step(&here, 0, steps, span);
        }
        // The step that is due is made as planned; the brake takes over from it.
        self.queue.cut(made + 1);
        self.left = 1;
        let current = self.queue.current().copied().unwrap_or_default();
        self.after_step(&current, made + 1, steps, span)
    }

    /// Puts off the rest of a move that is ending, for a motor that has fallen behind. Its next step then
    /// comes an interval after `now`.
    pub(crate) fn put_off(&mut self, now: u64) {
        if self.left == 0 {
            return;
        }
        let rest = Segment {
            count: i32::try_from(self.left).unwrap_or(i32::MAX) * i32::from(self.direction.sign()),
            interval: self.interval.whole,
            frac: self.interval.frac,
            add: self.add,
        };
        self.queue.split(self.made_of_current(), rest);
        self.next = Ticks::middle_of(now);
        self.take();
    }

    /// Returns the end of a way down of `steps` over `span` that follows step `k` of `slot`.
    fn after_step(&self, slot: &Slot, k: u32, steps: u32, span: i128) -> StopPlan {
        let way = i64::from(self.direction.sign()) * i64::from(steps);
        StopPlan {
            last_step_at: Ticks::of_fixed(slot.due(k).fixed() + span).whole,
            final_count: slot.position_after(k).wrapping_add(way),
        }
    }

    /// Stops the motor where it is. The step that is due is not made.
    fn stand(&mut self) -> StopPlan {
        let made = self.made_of_current();
        self.next = self.queue.current().map_or(self.next, |slot| slot.due(made));
        self.queue.keep_pending(0);
        self.queue.cut(made);
        self.left = 0;
        self.state = StepperState::Stopped;
        StopPlan { last_step_at: self.next.whole, final_count: self.position }
    }

    /// Returns true if more than `most` of the queued steps come before a rest. It counts alone, because the times of a
    /// full queue would keep the interrupt off for too long.
    fn runs_beyond(&self, most: u64) -> bool {
        let mut steps = u64::from(self.left);
        for segment in self.queue.pending() {
            if steps > most || segment.direction() != self.direction {
                break;
            }
            steps += u64::from(segment.steps());
        }
        steps > most
    }

    /// Returns the planned steps up to a rest or the end of the queue.
    fn planned_run(&self) -> PlannedEnd {
        let mut last = self.queue.current().copied().unwrap_or_default();
        let mut run = PlannedEnd {
            steps: u64::from(self.left),
            ends: last.due(last.segment.steps()),
            segments: 0,
            rests: self.is_whole() || self.state == StepperState::Ending { rests: true },
        };
        for segment in self.queue.pending() {
            if segment.direction() != self.direction {
                run.rests = true;
                break;
            }
            last.segment = *segment;
            run.steps += u64::from(segment.steps());
            run.ends = Ticks::of_fixed(run.ends.fixed() + segment.span(segment.steps()));
            run.segments += 1;
        }
        if run.rests {
            return run;
        }
        let last_interval = last.segment.interval_of(last.segment.steps());
        let ends_at = self.after_steps(run.steps);
        if let Some(way) = self.way_down(last_interval, ends_at, self.direction) {
            let (steps, span) = way.length(&self.brake);
            run.steps += u64::from(steps);
            run.ends = Ticks::of_fixed(run.ends.fixed() + span);
        }
        run
    }

    fn planned_end(&self, run: &PlannedEnd) -> StopPlan {
        StopPlan { last_step_at: run.ends.whole, final_count: self.after_steps(run.steps) }
    }

    /// Returns the position after `steps` more steps in the direction of the motor.
    fn after_steps(&self, steps: u64) -> i64 {
        let way = i64::from(self.direction.sign()) * i64::try_from(steps).unwrap_or(i64::MAX);
        self.position.wrapping_add(way)
    }
}
