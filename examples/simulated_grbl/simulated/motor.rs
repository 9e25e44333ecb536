//! The planner's queue and the motors that follow it: one way with ramps of one acceleration, which looks ahead over
//! the queue. Each block's way is that of the first axis that it moves, in steps; the others go along on the line of
//! the block.

use std::collections::VecDeque;

/// Number of blocks that grbl plans ahead.
const BLOCKS: usize = 15;

/// Number of axes that go along with the first.
pub(super) const OTHERS: usize = 2;

/// Longest step of the integration, s.
const STEP_S: f64 = 2e-4;

/// Way to go at one speed.
#[derive(Debug, Clone, Copy)]
struct Block {
    /// End of the block along the way, steps.
    end: i64,
    /// Fastest speed of the block, steps/s.
    steps_s: f64,
    /// End of the block for the first axis, steps.
    first: i64,
    /// Ends of the block for the other axes, steps.
    others: [i64; OTHERS],
}

/// Motor with its queue.
#[derive(Debug, Default)]
pub(super) struct Motor {
    blocks: VecDeque<Block>,
    /// Place along the way, in steps and parts of a step.
    at: f64,
    /// Place along the way at the begin of the first block, in steps.
    begin: i64,
    /// Places of all axes there, in steps.
    from: (i64, [i64; OTHERS]),
    /// Speed of the motor along the way, steps/s.
    speed: f64,
    /// Acceleration of the ramps, steps/s².
    pub acceleration: f64,
    /// True if the motor decelerates to rest, wherever that is.
    pub stopping: bool,
    /// Fastest speed of the motor so far, steps/s.
    pub peak: f64,
    /// Number of starts from rest so far.
    pub starts: u64,
}

impl Motor {
    /// Returns the step at which the first motor stands.
    pub(super) fn step(&self) -> i64 {
        match self.blocks.front() {
            Some(block) if block.first == self.from.0 => self.from.0,
            _ => self.from.0 + (self.at - self.begin as f64).round() as i64,
        }
    }

    /// Returns the speed of the motor along its way, steps/s.
    pub(super) fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns the step at which the queue ends.
    pub(super) fn planned(&self) -> i64 {
        self.blocks.back().map_or(self.step(), |block| block.first)
    }

    /// Returns the steps at which the other motors stand.
    pub(super) fn others(&self) -> [i64; OTHERS] {
        let mut others = self.from.1;
        if let Some(block) = self.blocks.front() {
            let part = (self.at - self.begin as f64) / (block.end - self.begin) as f64;
            for (place, end) in others.iter_mut().zip(block.others) {
                *place += ((end - *place) as f64 * part.clamp(0.0, 1.0)).round() as i64;
            }
        }
        others
    }

    /// Returns the steps at which the queue ends for the other motors.
    pub(super) fn planned_others(&self) -> [i64; OTHERS] {
        self.blocks.back().map_or(self.from.1, |block| block.others)
    }

    pub(super) fn is_full(&self) -> bool {
        self.blocks.len() >= BLOCKS
    }

    pub(super) fn is_done(&self) -> bool {
        self.blocks.is_empty() && self.speed == 0.0
    }

    /// Returns true if the motor stands, however much there is to do.
    pub(super) fn stands(&self) -> bool {
        self.speed == 0.0
    }

    /// Returns the number of blocks that have room.
    pub(super) fn room(&self) -> usize {
        BLOCKS - self.blocks.len().min(BLOCKS)
    }

    /// Queues a way to these places of the first axis and of the others, unless the queue ends there already.
    pub(super) fn push(&mut self, first: i64, steps_s: f64, others: [i64; OTHERS]) {
        let ways = others.iter().zip(self.planned_others()).map(|(end, planned)| end - planned);
        let way = std::iter::once(first - self.planned()).chain(ways).find(|way| *way != 0);
        let Some(way) = way else { return };
        if self.blocks.is_empty() {
            self.stand();
        }
        let end = self.blocks.back().map_or(self.begin, |block| block.end) + way;
        self.blocks.push_back(Block { end, steps_s, first, others });
    }

    /// Has the first block begin where the motors stand.
    fn stand(&mut self) {
        self.from = (self.step(), self.others());
        self.at = self.at.round();
        self.begin = self.at as i64;
    }

    /// Forgets the queue and stands at once.
    pub(super) fn halt(&mut self) {
        self.stand();
        self.blocks.clear();
        self.speed = 0.0;
        self.stopping = false;
    }

    /// Forgets the queue and starts the counters anew.
    pub(super) fn zero(&mut self) {
        self.halt();
        (self.at, self.begin, self.from) = (0.0, 0, (0, [0; OTHERS]));
    }

    /// Moves on for `time_s`, or until `each` returns false at a new step.
    pub(super) fn advance(&mut self, time_s: f64, mut each: impl FnMut(i64) -> bool) {
        let mut left_s = time_s;
        while left_s > 0.0 {
            let step_s = left_s.min(STEP_S);
            left_s -= step_s;
            let before = self.step();
            let along = self.begin - self.from.0;
            self.integrate(step_s);
            let after = self.step();
            let direction = (after - before).signum();
            let mut step = before;
            while step != after {
                step += direction;
                if !each(step) {
                    self.at = (step + along) as f64;
                    return;
                }
            }
        }
    }

    fn integrate(&mut self, step_s: f64) {
        let Some(block) = self.blocks.front().copied() else {
            self.speed = 0.0;
            return;
        };
        let was_at_rest = self.speed == 0.0;
        if self.stopping {
            self.speed = (self.speed - self.acceleration * step_s).max(0.0);
            if self.speed == 0.0 {
                self.at = self.at.round();
                return;
            }
        } else {
            self.speed = (self.speed + self.acceleration * step_s).min(self.allowed());
            if was_at_rest {
                self.starts += 1;
            }
        }
        self.peak = self.peak.max(self.speed);
        let direction = (block.end as f64 - self.at).signum();
        self.at += direction * self.speed * step_s;
        while let Some(block) = self.blocks.front() {
            let left = (block.end as f64 - self.at) * direction;
            if left > 1e-3 {
                break;
            }
            let turns =
                self.blocks.get(1).is_none_or(|next| ((next.end - block.end) as f64).signum() != direction);
            if turns {
                self.at = block.end as f64;
                self.speed = 0.0;
            }
            (self.begin, self.from) = (block.end, (block.first, block.others));
            self.blocks.pop_front();
            if turns {
                break;
            }
        }
    }

    /// Returns the fastest speed here from which every later block's speed, and rest at the end, can be
    /// kept.
    fn allowed(&self) -> f64 {
        let mut fastest = f64::INFINITY;
        let (mut from, mut way) = (self.at, 0.0);
        let mut heading = 0.0;
        for block in &self.blocks {
            let length = block.end as f64 - from;
            if heading != 0.0 && length.signum() != heading {
                break;
            }
            heading = length.signum();
            let speed = block.steps_s;
            fastest = fastest.min((speed * speed + 2.0 * self.acceleration * way).sqrt());
            way += length.abs();
            from = block.end as f64;
        }
        fastest.min((2.0 * self.acceleration * way).sqrt())
    }
}
