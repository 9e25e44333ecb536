//! The task of a plan for the board, and the check that the board and the line can do it.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use pump_ctl::plan::PlannedMotion;

use super::ramp;
use super::run::AHEAD;
use crate::drives::BoardShare;
use crate::drives::klipper::board::Board;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::refit::{Refit, RefitError, StepTimer};

/// Turns of a cruise after which its commands repeat.
const TOLD_TURNS: f64 = 2.0;

/// Part of the line that commands of steps may take. The rest is for the clock, the dead-man time, and blocks that are
/// sent again.
const SHARE: f64 = 0.7;

/// Most bytes of a command of steps: its number and those of its object, interval, count and addition (5, 3 and 3 bytes
/// at most), of which intervals below 2^26 ticks take a byte less. With its part of a block's 5 bytes of 64 it is 11.
const COMMAND_BYTES: u32 = 11;

/// Slots of the queue that no plan fills.
const SPARE_SLOTS: u16 = 16;

/// Task of a plan for the board.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::klipper) struct Task {
    /// Most steps in which the motor comes to rest by its ramp.
    pub(in crate::drives::klipper) brake_steps: u64,
    /// Deceleration of that ramp, in steps/s².
    pub(in crate::drives::klipper) deceleration: f64,
    /// Commands that the queue may hold of the plan.
    pub(in crate::drives::klipper) slots: usize,
    /// Most steps by which the motor may slip if it is stopped without a ramp. 0 if the plan is slow enough to be.
    pub(in crate::drives::klipper) slip_steps: u32,
    /// Most steps a second of the plan, and most bytes a second of its commands.
    pub(in crate::drives::klipper) steps_s: u32,
    pub(in crate::drives::klipper) bytes_s: u32,
}

impl Task {
    /// Returns the task of `plan`, or refuses it before anything moves.
    pub(in crate::drives::klipper) fn new(
        plan: PlannedMotion<'_>,
        board: &Board,
        full_steps: u32,
    ) -> Result<Self, KlipperError> {
        let speed = plan.peak_rad_s() / plan.step_rad();
        let deceleration = plan.acceleration_rad_s2() / plan.step_rad();
        let brake_steps = ramp::steps(speed, deceleration);
        // Motors that share the board share its queue, those too that are still to meet it.
        let links = board.talk.link.links().max(board.motors);
        let links = u16::try_from(links).unwrap_or(u16::MAX).max(1);
        let slots = (board.slots / links).saturating_sub(SPARE_SLOTS);
        let (commands, needed) = commands_ahead(plan, board.timer)?;
        if commands > usize::from(slots) {
            let (within_s, room) = (AHEAD.sent_s, slots);
            return Err(KlipperError::Queue { commands, within_s, slots: board.slots, room });
        }
        let allowed_bytes_s = (f64::from(board.bytes_s) * SHARE) as u32;
        let needed_bytes_s = needed.saturating_mul(COMMAND_BYTES);
        if needed_bytes_s > allowed_bytes_s {
            return Err(KlipperError::Line { needed_bytes_s, allowed_bytes_s });
        }
        // A motor that is torn from its field falls into place again after whole periods of four full steps.
        let period = u64::from(4 * full_steps).max(1);
        let slip = if brake_steps == 0 { 0 } else { brake_steps.div_ceil(period) * period };
        let slip_steps = u32::try_from(slip).unwrap_or(u32::MAX);
        Ok(Self {
            brake_steps: brake_steps + 2,
            deceleration,
            slots: slots.into(),
            slip_steps,
            steps_s: speed.ceil() as u32,
            bytes_s: needed_bytes_s,
        })
    }

    /// Returns what the motion takes of a board that several motors share.
    pub(in crate::drives::klipper) fn share(&self, board: &Board) -> BoardShare {
        BoardShare {
            steps_s: self.steps_s,
            all_steps_s: board.all_steps_s as u32,
            bytes_s: self.bytes_s,
            all_bytes_s: (f64::from(board.bytes_s) * SHARE) as u32,
        }
    }
}

/// Returns the most steps a second to which a plan is made. The board's own limit is a little higher, since the whole
/// ticks of a refit may come as much closer.
pub(in crate::drives::klipper) fn most_steps_s(timer: StepTimer) -> f64 {
    0.95 * timer.most_steps_s()
}

/// Returns the most commands of a plan within the time for which the queue is filled, and the most within a second.
/// A long cruise repeats, so that its middle tells nothing more.
fn commands_ahead(plan: PlannedMotion<'_>, timer: StepTimer) -> Result<(usize, u32), RefitError> {
    let told = match plan {
        PlannedMotion::Dose(dose) => {
            dose.cruise_steps().start + (TOLD_TURNS * TAU / dose.step_rad()).ceil() as u64
        }
        PlannedMotion::Flow(_) => u64::MAX,
    };
    let told = usize::try_from(told).unwrap_or(usize::MAX);
    let mut refit = Refit::new(times_of(plan).take(told), timer);
    let hz = timer.hz();
    let ahead = (AHEAD.sent_s * hz) as u64;
    let mut within: VecDeque<u64> = VecDeque::new();
    let (mut most, mut most_s) = (0, 0);
    while let Some(run) = refit.next(u64::MAX)? {
        within.push_back(run.end());
        while within.front().is_some_and(|end| end + ahead < run.end()) {
            within.pop_front();
        }
        most = most.max(within.len());
        // A command that is done within less than the time for which the queue is filled may come later than it.
        most_s = most_s.max((within.len() as f64 / AHEAD.sent_s) as u32);
    }
    Ok((most, most_s))
}

/// Returns the times of the steps of a plan, in s since its begin.
pub(super) fn times_of<'a>(plan: PlannedMotion<'a>) -> Box<dyn Iterator<Item = f64> + Send + 'a> {
    match plan {
        PlannedMotion::Dose(plan) => Box::new(plan.each_step().map(|step| step.time_s)),
        PlannedMotion::Flow(flow) => Box::new(flow.each_step().map(|step| step.time_s)),
    }
}
