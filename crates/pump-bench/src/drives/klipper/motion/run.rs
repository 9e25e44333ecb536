//! A motion in one thread, while another one asks its gate.

use std::panic::resume_unwind;
use std::thread;
use std::time::Duration;

use pump_ctl::plan::PlannedMotion;

use super::motion::Motion;
use super::outcome::{Ended, Fault};
use super::task::Task;
use crate::drives::klipper::board::Board;
use crate::drives::sent_lead::{Ahead, Ends, SentLead};
use crate::drives::stepped::Lead;
use crate::drives::wire::AskClock;
use crate::drives::{BeginPlace, Gate};

/// Times for which there is leave ahead of a motor, and for which the board has steps. What is in the board's queue
/// cannot be taken back, so it is short. The thread that asks for leave may be held up for 1 s.
pub(super) const AHEAD: Ahead = Ahead { leave_s: 1.3, sent_s: 0.3 };

/// Longest time between two questions to the gate, and longest wait for an answer.
const LOOK: Duration = Duration::from_millis(5);

/// Longest time without a confirmation in motion. The queue has ended by then, and the board is searched for.
const QUIET: Duration = Duration::from_secs(1);

/// Makes the steps of `plan` in a thread of its own. This thread asks the gate for leave meanwhile, and may be held up.
/// The motor stands at the count `start`. A motion with a place begins together with those of the other places. Returns
/// the outcome, and the most steps by which the motor may have slipped beside it.
pub(in crate::drives::klipper) fn run(
    board: &mut Board,
    plan: PlannedMotion<'_>,
    task: Task,
    start: i64,
    (seeks, place): (bool, Option<BeginPlace>),
    gate: &mut Gate<'_>,
) -> (Result<Ended, Fault>, u32) {
    let (leads, free) = ([SentLead::new(plan, AHEAD, task.brake_steps)], Lead::free());
    let [lead] = &leads;
    board.talk.link.set_quiet(QUIET);
    let clock = board.talk.link.ask_clock();
    let clock = clock.as_ref();
    let mut motion = Motion::new(board, plan, task, (lead, &free), start, seeks);
    motion.place = place;
    thread::scope(|scope| {
        let _ends = Ends(&leads, clock);
        // The thread begins with the leave that there is.
        lead.ask(gate);
        let streams = scope.spawn(move || {
            let _told = Told(clock);
            loop {
                if let Some(outcome) = motion.turn(LOOK) {
                    lead.end();
                    return (outcome, motion.slipped);
                }
            }
        });
        while clock.wait(LOOK) {
            lead.ask(gate);
        }
        streams.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Guard of the thread that streams: however it ends, the other thread hears of it.
struct Told<'a>(&'a dyn AskClock);

impl Drop for Told<'_> {
    fn drop(&mut self) {
        self.0.end();
    }
}
