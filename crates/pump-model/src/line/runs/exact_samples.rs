//! Samples of an exact run at equal intervals.

use crate::motion::leg::Leg;
use crate::motion::stretches::Stretch;

use super::onset::Onset;
use crate::line::exact_run::{ExactRun, next_stretch};
use crate::line::line_state::LineState;
use crate::line::oscillator::Balanced;
use crate::line::reach::{CAUSES, LANES, Reach, reached};

/// Number of rows of samples that follow from one sample.
const ROWS: usize = 8;

/// Number of samples that follow from one, itself included.
const COUNT: usize = ROWS * LANES;

/// Samples of an [`ExactRun`] at equal intervals. Inside a stretch at constant speed each pressure costs seven
/// multiplications.
///
/// Every lane follows from the first by an interval of its own, so that none waits for another. The sample behind an
/// edge follows from the one before it, as if there were no edge, and from what the flow changes there (see
/// `onset.rs`).
#[derive(Debug, Clone)]
pub struct ExactSamples<'a, M> {
    /// The run at the sample of the first lane.
    run: ExactRun<'a, M>,
    start_s: f64,
    dt_s: f64,
    reach: Reach<ROWS>,
    /// Effect of a change of the flow within an interval; none if the line swings faster than that.
    onset: Option<Onset>,
    /// Causes of the samples in the lanes; none where the flow's degree is above 4, and the first lane alone is known.
    causes: Option<[f64; CAUSES]>,
    /// Number of the sample in the first lane.
    first: f64,
    /// Lane of the next sample to hand out, and the number of lanes to hand out.
    next: usize,
    valid: usize,
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
        let mut samples = Self {
            start_s: run.time_s(),
            dt_s,
            reach: Reach::new(&run.oscillator, dt_s),
            onset: Onset::new(&run.oscillator, dt_s),
            run,
            causes: None,
            first: 0.0,
            next: 0,
            valid: 1,
        };
        samples.fill_lanes();
        samples
    }

    /// Writes the pressures of the next samples above the reservoir, kPa, for less than asking for them one
    /// by one.
    pub fn fill_kpa(&mut self, kpa: &mut [f64]) {
        self.fill(0.0, kpa);
    }

    /// Writes the pressures of the next samples, kPa absolute, as [`Self::fill_kpa`] does.
    pub fn fill_pressure_kpa(&mut self, kpa: &mut [f64]) {
        self.fill(self.run.line.reservoir_kpa, kpa);
    }

    /// Writes the pressures of the next samples, each `base_kpa` higher.
    fn fill(&mut self, base_kpa: f64, mut kpa: &mut [f64]) {
        while !kpa.is_empty() {
            if self.next == self.valid {
                self.go_on();
            }
            let count = (self.valid - self.next).min(kpa.len());
            match self.causes {
                // The next samples overwrite the excess of a row.
                Some(causes) if self.next == 0 && kpa.len() >= COUNT => {
                    let (places, _) = kpa.as_chunks_mut();
                    self.reach.write_kpa(&causes, base_kpa, &mut places[..count.div_ceil(LANES)]);
                }
                _ => {
                    for (n, kpa) in kpa.iter_mut().take(count).enumerate() {
                        *kpa = self.sample(self.next + n)[0] + base_kpa;
                    }
                }
            }
            self.next += count;
            kpa = &mut kpa[count..];
        }
    }

    /// Returns the state of the last sample that was handed out, or that of the start.
    pub fn state(&self) -> LineState {
        let state = self.sample(self.next.saturating_sub(1));
        LineState::of(self.run.oscillator.physical(state))
    }

    /// Returns the state of a lane that is handed out, or of the one after it as if there were no edge.
    #[inline]
    fn sample(&self, lane: usize) -> Balanced {
        match &self.causes {
            Some(causes) => self.reach.state(lane, causes),
            None if lane == 0 => self.run.state,
            None => {
                let run = &self.run;
                run.oscillator.after(lane as f64 * self.dt_s, run.state, &run.flow.shifted(run.reached_s))
            }
        }
    }

    /// Returns the time of the sample in a lane, s.
    fn time_s(&self, lane: usize) -> f64 {
        self.start_s + (self.first + lane as f64) * self.dt_s
    }

    /// Goes on to the first sample that was not computed yet, and fills the lanes from there.
    fn go_on(&mut self) {
        let time_s = self.time_s(self.valid);
        if time_s <= self.run.stretch.end_s {
            self.run.state = self.sample(self.valid);
            self.run.reached_s = time_s - self.run.stretch.start_s;
        } else {
            self.cross(time_s);
        }
        self.first += self.valid as f64;
        self.next = 0;
        self.fill_lanes();
    }

    /// Takes the run over one or more edges to the sample at `time_s`.
    fn cross(&mut self, time_s: f64) {
        let Stretch { start_s, end_s, .. } = self.run.stretch;
        let (length_s, after_s) = (end_s - start_s, time_s - end_s);
        let next = next_stretch(&mut self.run.stretches);
        let flow = next.flow();
        match &self.onset {
            // The flow of a stretch goes on a little beyond its end, not far.
            Some(onset)
                if after_s <= length_s
                    && time_s <= next.end_s
                    && self.run.flow.degree.max(flow.degree) <= 4 =>
            {
                let [x, y] = self.sample(self.valid);
                let [change_x, change_y] = onset.after(after_s, &flow.less(&self.run.flow, length_s));
                self.run.state = [x + change_x, y + change_y];
                (self.run.stretch, self.run.flow, self.run.reached_s) = (next, flow, after_s);
            }
            _ => {
                // The last sample inside is nearer to the edge than the run.
                self.run.state = self.sample(self.valid - 1);
                self.run.reached_s = self.time_s(self.valid - 1) - start_s;
                self.run.enter(next);
                self.run.at(time_s);
            }
        }
    }

    /// Computes the lanes from the run on, and counts those inside the stretch.
    fn fill_lanes(&mut self) {
        let run = &self.run;
        if run.flow.degree > 4 {
            (self.causes, self.valid) = (None, 1);
            return;
        }
        self.causes = Some(self.reach.causes(run.state, &run.flow, run.reached_s));
        self.valid = self.inside();
    }

    /// Returns the number of lanes inside the stretch, without the last one, from which the next lanes follow.
    fn inside(&self) -> usize {
        reached(COUNT - 1, self.run.stretch.end_s, self.dt_s, |n| self.time_s(n))
    }
}

impl<M: Iterator<Item = Leg>> Iterator for ExactSamples<'_, M> {
    type Item = LineState;

    #[inline]
    fn next(&mut self) -> Option<LineState> {
        if self.next == self.valid {
            self.go_on();
        }
        let state = self.sample(self.next);
        self.next += 1;
        Some(LineState::of(self.run.oscillator.physical(state)))
    }
}
