//! Samples of an exact run at equal intervals.

use crate::motion::flow::Flow;
use crate::motion::leg::Leg;

use super::exact_run::ExactRun;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator};
use super::propagator::Propagator;

/// Number of samples that are computed together, independent of one another.
const LANES: usize = 4;

/// Samples of an [`ExactRun`] at equal intervals. Inside a stretch at constant speed each costs a dozen
/// multiplications.
///
/// Sample n + 4 follows from sample n by a step of four intervals, so four samples at a time are independent.
#[derive(Debug, Clone)]
pub struct ExactSamples<'a, M> {
    run: ExactRun<'a, M>,
    start_s: f64,
    dt_s: f64,
    one: Interval,
    four: Interval,
    /// States (x, y) of the samples under way, and their times since the stretch's start.
    x: [f64; LANES],
    y: [f64; LANES],
    time_s: [f64; LANES],
    /// Number of the first sample under way.
    first: u64,
    /// Index of the next sample to hand out, and the number of samples inside the stretch.
    next: usize,
    valid: usize,
}

/// Effect of a step of fixed length inside the stretch under way.
#[derive(Debug, Clone)]
pub(crate) struct Interval {
    propagator: Propagator,
    /// The matrix e^(A h) by columns.
    decay: [Balanced; 2],
    /// Input that the flow adds to both states, as polynomials in the time since the stretch's start.
    input: [[f64; 5]; 2],
}

impl Interval {
    pub(crate) fn new(oscillator: &Oscillator, step_s: f64) -> Self {
        let propagator = Propagator::new(oscillator, step_s, 4);
        let decay = [propagator.moved([1.0, 0.0]), propagator.moved([0.0, 1.0])];
        Self { propagator, decay, input: [[0.0; 5]; 2] }
    }

    /// Takes the flow of the stretch under way, of degree 4 at most.
    pub(crate) fn drive(&mut self, flow: &Flow) {
        self.input = self.propagator.input(flow);
    }

    /// Returns the states an interval after (x, y) at times t, each independent of the others.
    #[inline]
    pub(crate) fn after<const K: usize>(
        &self,
        x: [f64; K],
        y: [f64; K],
        t: [f64; K],
    ) -> ([f64; K], [f64; K]) {
        let ([xx, yx], [xy, yy]) = (self.decay[0], self.decay[1]);
        let (mut to_x, mut to_y) = ([self.input[0][4]; K], [self.input[1][4]; K]);
        for order in (0..4).rev() {
            for n in 0..K {
                to_x[n] = to_x[n] * t[n] + self.input[0][order];
                to_y[n] = to_y[n] * t[n] + self.input[1][order];
            }
        }
        for n in 0..K {
            to_x[n] += xx * x[n] + xy * y[n];
            to_y[n] += yx * x[n] + yy * y[n];
        }
        (to_x, to_y)
    }
}

impl<'a, M: Iterator<Item = Leg>> ExactRun<'a, M> {
    /// Returns the states at n `dt_s` from the start on, n = 0, 1, 2 ... without end. `dt_s` must be
    /// positive.
    pub fn every(self, dt_s: f64) -> ExactSamples<'a, M> {
        ExactSamples::new(self, dt_s)
    }
}

impl<'a, M: Iterator<Item = Leg>> ExactSamples<'a, M> {
    fn new(run: ExactRun<'a, M>, dt_s: f64) -> Self {
        let one = Interval::new(&run.oscillator, dt_s);
        let four = Interval::new(&run.oscillator, LANES as f64 * dt_s);
        let start_s = run.time_s();
        let zeros = [0.0; LANES];
        Self { run, start_s, dt_s, one, four, x: zeros, y: zeros, time_s: zeros, first: 0, next: 0, valid: 0 }
    }

    /// Writes the pressures of the next samples above the reservoir, kPa, for less than asking for them one
    /// by one.
    pub fn fill_kpa(&mut self, mut kpa: &mut [f64]) {
        while !kpa.is_empty() {
            if self.next == self.valid {
                self.fill();
            }
            // A state's x is the pressure.
            let ready = &self.x[self.next..self.valid];
            let count = ready.len().min(kpa.len());
            let (now, later) = kpa.split_at_mut(count);
            now.copy_from_slice(&ready[..count]);
            self.next += count;
            kpa = later;
        }
    }

    /// Returns the state of the last sample that was handed out, or that of the start.
    pub fn state(&self) -> LineState {
        let last = self.next.checked_sub(1).map(|n| [self.x[n % LANES], self.y[n % LANES]]);
        LineState::of(self.run.oscillator.physical(last.unwrap_or(self.run.state)))
    }

    /// Computes the next samples, at least one.
    fn fill(&mut self) {
        self.first += self.valid as u64;
        self.next = 0;
        if self.valid == LANES && self.run.flow.degree <= 4 {
            (self.x, self.y) = self.four.after(self.x, self.y, self.time_s);
            self.settle_lanes(0);
        } else {
            self.valid = 0;
        }
        if self.valid == 0 {
            self.cross();
        }
    }

    /// Goes on to the next sample over one or more edges, and starts the lanes from there.
    fn cross(&mut self) {
        let run = &mut self.run;
        run.at(self.start_s + self.first as f64 * self.dt_s);
        [self.x[0], self.y[0]] = run.state;
        self.time_s[0] = run.reached_s;
        if run.flow.degree > 4 {
            self.valid = 1;
            return;
        }
        for interval in [&mut self.one, &mut self.four] {
            interval.drive(&run.flow);
        }
        for n in 1..LANES {
            let t = self.time_s[0] + (n - 1) as f64 * self.dt_s;
            let ([x], [y]) = self.one.after([self.x[n - 1]], [self.y[n - 1]], [t]);
            (self.x[n], self.y[n]) = (x, y);
        }
        self.settle_lanes(1);
    }

    /// Places the lanes in time from sample `known` on, and counts those inside the stretch. Leaves the run
    /// at the last of them.
    fn settle_lanes(&mut self, known: usize) {
        let stretch = &self.run.stretch;
        let first = self.first as f64;
        for (n, t) in self.time_s.iter_mut().enumerate().skip(known) {
            *t = self.start_s + (first + n as f64) * self.dt_s - stretch.start_s;
        }
        let length_s = stretch.end_s - stretch.start_s;
        self.valid = if self.time_s[LANES - 1] <= length_s {
            LANES
        } else {
            // The sample that crossed the edge is inside by construction.
            known.max(self.time_s.iter().take_while(|t| **t <= length_s).count())
        };
        if let Some(last) = self.valid.checked_sub(1) {
            self.run.state = [self.x[last % LANES], self.y[last % LANES]];
            self.run.reached_s = self.time_s[last % LANES];
        }
    }
}

impl<M: Iterator<Item = Leg>> Iterator for ExactSamples<'_, M> {
    type Item = LineState;

    #[inline]
    fn next(&mut self) -> Option<LineState> {
        if self.next == self.valid {
            self.fill();
        }
        let n = self.next;
        self.next += 1;
        Some(LineState::of(self.run.oscillator.physical([self.x[n % LANES], self.y[n % LANES]])))
    }
}
