//! A stepper: its queue of moves, and the steps that it makes at their ticks.

use std::collections::VecDeque;

use super::super::dictionary::Reason;

/// Lateness, in parts of a second, of a step beyond which the board gives up: 1 ms.
const GIVES_UP: u64 = 1000;

/// Steps whose intervals change evenly, as `queue_step` names them.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Move {
    pub(in super::super) interval: u32,
    pub(in super::super) count: u16,
    pub(in super::super) add: i16,
}

/// Move under way.
#[derive(Debug, Clone, Copy)]
struct Running {
    due: u64,
    interval: u32,
    left: u16,
    add: i16,
}

/// Step that was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct Made {
    pub(in super::super) at: u64,
    pub(in super::super) is_forward: bool,
    /// Slots of the board's queue that became free.
    pub(in super::super) freed: u16,
    /// Whether the next step can follow.
    pub(in super::super) next: Result<(), Reason>,
}

/// Stepper.
#[derive(Debug)]
pub(in super::super) struct Stepper {
    pub(in super::super) step_pin: u32,
    /// Fewest ticks from one step to the next.
    least: u64,
    queue: VecDeque<(Move, bool)>,
    running: Option<Running>,
    /// Tick at which the last step was due, or that of a reset.
    base: u64,
    /// Tick at which the last step was made.
    made_at: Option<u64>,
    next_is_forward: bool,
    is_forward: bool,
    needs_reset: bool,
    pub(in super::super) position: i32,
    /// Trigger group on which it stops.
    pub(in super::super) stops_on: Option<usize>,
}

/// Returns the tick nearest to `near` of these lower 32 bits.
pub(in super::super) fn widened(clock: u32, near: u64) -> u64 {
    near.saturating_add_signed(i64::from(clock.wrapping_sub(near as u32).cast_signed()))
}

impl Stepper {
    pub(in super::super) fn new(step_pin: u32, least: u64) -> Self {
        Self {
            step_pin,
            least,
            queue: VecDeque::new(),
            running: None,
            base: 0,
            made_at: None,
            next_is_forward: false,
            is_forward: false,
            needs_reset: false,
            position: 0,
            stops_on: None,
        }
    }

    /// Returns true while a move is under way.
    pub(in super::super) fn is_moving(&self) -> bool {
        self.running.is_some()
    }

    /// Sets the direction of the moves that are queued from now on.
    pub(in super::super) fn face(&mut self, is_forward: bool) {
        self.next_is_forward = is_forward;
    }

    /// Sets the tick from which the next interval counts.
    pub(in super::super) fn reset_clock(&mut self, clock: u32, now: u64) -> Result<(), Reason> {
        if self.is_moving() {
            return Err(Reason::Active);
        }
        self.base = widened(clock, now);
        self.needs_reset = false;
        Ok(())
    }

    /// Takes a move. Returns the number of slots that it occupies: none if it runs at once, or is dropped after a stop.
    pub(in super::super) fn queue(&mut self, queued: Move, now: u64) -> Result<u16, Reason> {
        if queued.count == 0 {
            return Err(Reason::NoCount);
        }
        if self.is_moving() {
            self.queue.push_back((queued, self.next_is_forward));
            return Ok(1);
        }
        if !self.needs_reset {
            self.load(queued, self.next_is_forward, now)?;
        }
        Ok(0)
    }

    /// Begins a move. The board counts in 32 bits, so a step more than 2^31 ticks ahead lies in its past.
    fn load(&mut self, next: Move, is_forward: bool, now: u64) -> Result<(), Reason> {
        let due = widened((self.base as u32).wrapping_add(next.interval), now);
        if due < now {
            return Err(Reason::TooClose);
        }
        self.is_forward = is_forward;
        let interval = next.interval.wrapping_add_signed(next.add.into());
        self.running = Some(Running { due, interval, left: next.count, add: next.add });
        Ok(())
    }

    /// Returns the tick of the next step.
    pub(in super::super) fn next(&self) -> Option<u64> {
        let running = self.running?;
        let earliest = self.made_at.map_or(0, |made_at| made_at + self.least);
        Some(running.due.max(earliest))
    }

    /// Makes the step of tick `now`. `hz` are the ticks of a second.
    pub(in super::super) fn make(&mut self, now: u64, hz: u32) -> Result<Option<Made>, Reason> {
        let Some(running) = self.running else { return Ok(None) };
        if now - running.due > u64::from(hz) / GIVES_UP {
            return Err(Reason::TooFarInPast);
        }
        (self.base, self.made_at) = (running.due, Some(now));
        self.position += if self.is_forward { 1 } else { -1 };
        let mut made = Made { at: now, is_forward: self.is_forward, freed: 0, next: Ok(()) };
        let left = running.left - 1;
        if left > 0 {
            // An interval that fell below 0 is one of 2^32 ticks less something: in the board's past.
            if running.interval.cast_signed() < 0 {
                made.next = Err(Reason::TooClose);
                return Ok(Some(made));
            }
            let due = running.due + u64::from(running.interval);
            let interval = running.interval.wrapping_add_signed(running.add.into());
            self.running = Some(Running { due, interval, left, add: running.add });
        } else {
            self.running = None;
            if let Some((next, is_forward)) = self.queue.pop_front() {
                made.freed = 1;
                made.next = self.load(next, is_forward, running.due);
            }
        }
        Ok(Some(made))
    }

    /// Stops at once and forgets all moves. Returns the number of slots that became free.
    pub(in super::super) fn stop(&mut self) -> u16 {
        let freed = self.queue.len() as u16;
        self.queue.clear();
        (self.running, self.stops_on) = (None, None);
        (self.next_is_forward, self.is_forward, self.needs_reset) = (false, false, true);
        freed
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::dictionary::Reason;
    use super::{Move, Stepper, widened};

    const HZ: u32 = 1_000_000;

    fn run(stepper: &mut Stepper) -> Result<Vec<u64>, Reason> {
        let mut ticks = Vec::new();
        while let Some(at) = stepper.next() {
            let Some(made) = stepper.make(at, HZ)? else { break };
            ticks.push(made.at);
            made.next?;
        }
        Ok(ticks)
    }

    #[test]
    fn the_documentations_commands_make_its_steps() {
        // docs/Protocol.md: interval=7458 count=10 add=331, then interval=11717 count=4 add=1281.
        let mut stepper = Stepper::new(0, 1);
        stepper.reset_clock(1000, 0).unwrap();
        stepper.face(true);
        assert_eq!(stepper.queue(Move { interval: 7458, count: 10, add: 331 }, 0), Ok(0));
        assert_eq!(stepper.queue(Move { interval: 11_717, count: 4, add: 1281 }, 0), Ok(1));
        let ticks = run(&mut stepper).unwrap();
        assert_eq!(ticks[..3], [8458, 8458 + 7789, 8458 + 7789 + 8120]);
        let first = 1000 + 10 * 7458 + 45 * 331;
        assert_eq!(ticks[9], first);
        assert_eq!(ticks[10..], [11_717, 24_715, 38_994, 54_554].map(|after| first + after));
        assert_eq!(stepper.position, 14);
    }

    #[test]
    fn late_moves_and_moves_that_the_board_cannot_count_are_refused() {
        let mut stepper = Stepper::new(0, 1);
        stepper.reset_clock(1000, 0).unwrap();
        let one = |interval| Move { interval, count: 1, add: 0 };
        assert_eq!(stepper.queue(one(10), 1011), Err(Reason::TooClose));
        assert_eq!(stepper.queue(one(1 << 31), 1000), Err(Reason::TooClose));
        assert_eq!(stepper.queue(Move { count: 0, ..one(10) }, 0), Err(Reason::NoCount));
        assert_eq!(stepper.queue(one(11), 1011), Ok(0));
        assert_eq!(stepper.reset_clock(5000, 1011), Err(Reason::Active));
        // The second interval is negative.
        let mut stepper = Stepper::new(0, 1);
        assert_eq!(stepper.queue(Move { interval: 100, count: 3, add: -101 }, 0), Ok(0));
        assert_eq!(run(&mut stepper), Err(Reason::TooClose));
    }

    #[test]
    fn steps_that_are_too_fast_fall_behind_until_the_board_gives_up() {
        let mut stepper = Stepper::new(0, 10);
        stepper.queue(Move { interval: 9, count: 500, add: 0 }, 0).unwrap();
        let ticks = run(&mut stepper).unwrap();
        assert_eq!(ticks[..3], [9, 19, 29]);
        stepper.stop();
        stepper.reset_clock(10_000, 10_000).unwrap();
        stepper.queue(Move { interval: 9, count: 1100, add: 0 }, 10_000).unwrap();
        assert_eq!(run(&mut stepper), Err(Reason::TooFarInPast));
    }

    #[test]
    fn a_stop_forgets_moves_and_drops_later_ones_until_the_clock_is_reset() {
        let mut stepper = Stepper::new(0, 1);
        let some = Move { interval: 10, count: 5, add: 0 };
        for _ in 0..3 {
            stepper.queue(some, 0).unwrap();
        }
        stepper.make(10, HZ).unwrap();
        assert_eq!(stepper.stop(), 2);
        assert_eq!((stepper.position, stepper.next()), (-1, None));
        assert_eq!(stepper.queue(some, 100), Ok(0));
        assert!(!stepper.is_moving());
        stepper.reset_clock(100, 90).unwrap();
        stepper.queue(some, 90).unwrap();
        assert_eq!(stepper.next(), Some(110));
    }

    #[test]
    fn a_clock_of_32_bits_is_the_tick_nearest_to_now() {
        let now = (7 << 32) + 5;
        assert_eq!(widened(3, now), (7 << 32) + 3);
        assert_eq!(widened(u32::MAX, now), (7 << 32) - 1);
        assert_eq!(widened(1 << 31, (7 << 32) + 1), (7 << 32) + (1 << 31));
        assert_eq!(widened((1 << 31) + 1, 0), 0);
    }
}
