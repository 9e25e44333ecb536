//! Samples of an exact run at any rising times.

use crate::motion::leg::Leg;

use super::block::{Block, Blocks, LANES, pressures};
use crate::line::exact_run::{ExactRun, next_stretch};
use crate::line::line_state::LineState;
use crate::line::oscillator::Balanced;

/// Number of blocks that cost less than one long step.
const FEW: f64 = 16.0;

/// Samples of an [`ExactRun`] at any times that rise. Close together, each pressure costs some twenty multiplications.
///
/// One polynomial serves all samples of a block of time, which ends at the next edge or where the line has swung on so
/// far that it would need more terms.
#[derive(Debug, Clone)]
pub struct ExactSeries<'a, M> {
    /// The run at the start of the block under way.
    run: ExactRun<'a, M>,
    blocks: Blocks,
    block: Block,
    /// Place of the last sample in the block.
    last: f64,
}

impl<'a, M: Iterator<Item = Leg>> ExactRun<'a, M> {
    /// Returns this run for samples at many times, which it computes several at once.
    ///
    /// ```
    /// use pump_model::{ExactRun, Leg, Port, Pump};
    /// let pump = Pump::three_roller();
    /// let run = || ExactRun::from_rest(&pump, Port::Outlet, [Leg::constant_speed(0.0, 10.0)]);
    /// let (times_s, mut kpa) = ([0.01, 0.5, 0.502, 2.0], [0.0; 4]);
    /// run().in_series().fill_kpa(&times_s, &mut kpa);
    /// assert!((kpa[2] - run().at(0.502).above_reservoir_kpa).abs() < 1e-12);
    /// ```
    pub fn in_series(self) -> ExactSeries<'a, M> {
        ExactSeries::new(self)
    }
}

impl<'a, M: Iterator<Item = Leg>> ExactSeries<'a, M> {
    fn new(run: ExactRun<'a, M>) -> Self {
        let blocks = Blocks::new(&run.oscillator);
        let mut series = Self { run, blocks, block: Block::new(), last: 0.0 };
        series.begin();
        series
    }

    /// Writes the pressures above the reservoir at `times_s`, kPa. The times must rise, and so must those of one call
    /// after another; a time in the past gives the state reached. The excess of a longer slice is left as it is.
    pub fn fill_kpa(&mut self, times_s: &[f64], kpa: &mut [f64]) {
        self.fill(0.0, times_s, kpa);
    }

    /// Writes the pressures at `times_s`, kPa absolute, as [`Self::fill_kpa`] does.
    pub fn fill_pressure_kpa(&mut self, times_s: &[f64], kpa: &mut [f64]) {
        self.fill(self.run.line.reservoir_kpa, times_s, kpa);
    }

    /// Writes the pressures at `times_s`, each `base_kpa` higher.
    fn fill(&mut self, base_kpa: f64, mut times_s: &[f64], mut kpa: &mut [f64]) {
        while times_s.len().min(kpa.len()) >= LANES {
            let count = self.fill_block(base_kpa, times_s, kpa);
            (times_s, kpa) =
                (times_s.get(count..).unwrap_or_default(), kpa.get_mut(count..).unwrap_or_default());
        }
        // Fewer than the lanes are left.
        while let Some(last_s) = times_s.iter().take(kpa.len()).next_back() {
            let (mut lanes_s, mut lanes) = ([*last_s; LANES], [0.0; LANES]);
            lanes_s.iter_mut().zip(times_s).for_each(|(lane_s, time_s)| *lane_s = *time_s);
            let count = self.fill_block(base_kpa, &lanes_s, &mut lanes);
            kpa.iter_mut().zip(lanes).take(count).for_each(|(kpa, lane)| *kpa = lane);
            (times_s, kpa) =
                (times_s.get(count..).unwrap_or_default(), kpa.get_mut(count..).unwrap_or_default());
        }
    }

    /// Writes the next pressures as far as one block reaches and all lanes have places, and returns their number.
    fn fill_block(&mut self, base_kpa: f64, times_s: &[f64], kpa: &mut [f64]) -> usize {
        if let Some(first_s) = times_s.first() {
            self.reach(*first_s);
        }
        let (start_s, reached_s) = (self.run.stretch.start_s, self.run.reached_s);
        let place = |time_s: f64| self.block.place((time_s - start_s) - reached_s);
        let room = place(self.run.stretch.end_s).min(1.0);
        let mut terms = self.block.kpa;
        terms[0] += base_kpa;
        let (mut last, mut done) = (self.last, 0);
        while let (Some(times_s), Some(kpa)) = (
            times_s.get(done..).and_then(|times_s| times_s.first_chunk::<LANES>()),
            kpa.get_mut(done..).and_then(|kpa| kpa.first_chunk_mut()),
        ) {
            let places = times_s.map(|time_s| {
                let place = place(time_s);
                if place > last { place } else { last }
            });
            // The next samples overwrite those beyond the block.
            *kpa = pressures(&terms, &places);
            let [.., latest] = places;
            if latest <= room {
                (last, done) = (latest, done + LANES);
                continue;
            }
            let inside = places.map(|place| usize::from(place <= room)).iter().sum::<usize>();
            // The first is inside, whatever its place rounds to.
            let count = if done == 0 { inside.max(1) } else { inside };
            last = places.into_iter().take(count).next_back().unwrap_or(last);
            done += count;
            break;
        }
        self.last = last;
        done
    }

    /// Returns the state of the last sample, or that of the start.
    pub fn state(&self) -> LineState {
        LineState::of(self.run.oscillator.physical(self.within(self.last)))
    }

    /// Returns the run, which goes on from the last sample.
    pub fn into_run(mut self) -> ExactRun<'a, M> {
        (self.run.state, self.run.reached_s) =
            (self.within(self.last), self.run.reached_s + self.block.since_s(self.last));
        self.run
    }

    /// Returns the state at a place of the block.
    fn within(&self, place: f64) -> Balanced {
        if place > self.block.start { self.blocks.at(&self.block, place) } else { self.run.state }
    }

    /// Goes on to the block that reaches `time_s`.
    fn reach(&mut self, time_s: f64) {
        while time_s > self.run.stretch.end_s {
            self.go_near(self.run.stretch.end_s);
            let end_s = self.run.stretch.end_s - self.run.stretch.start_s;
            self.run.state = self.within(self.block.place(end_s - self.run.reached_s));
            let next = next_stretch(&mut self.run.stretches);
            self.run.begin(next);
            self.begin();
        }
        self.go_near(time_s);
    }

    /// Goes on to the block that reaches `time_s`, which must be inside the stretch.
    fn go_near(&mut self, time_s: f64) {
        let since_s = time_s - self.run.stretch.start_s;
        while since_s - self.run.reached_s > self.block.length_s {
            self.run.state = self.block.end();
            self.run.reached_s += self.block.length_s;
            let left_s = since_s - self.run.reached_s;
            if left_s > FEW * self.block.length_s {
                self.run.go_on(left_s);
            }
            self.begin();
        }
    }

    /// Begins a block in the state reached.
    fn begin(&mut self) {
        let ExactRun { oscillator, stretch, state, flow, reached_s, .. } = &self.run;
        let room_s = (stretch.end_s - stretch.start_s) - reached_s;
        self.blocks.begin(&mut self.block, oscillator, *state, (flow, *reached_s), room_s);
        self.last = self.block.start;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::port::Port;
    use crate::pump::pump::Pump;

    #[test]
    fn a_time_in_the_past_gives_the_state_reached() {
        let pump = Pump::three_roller();
        let run = || ExactRun::from_rest(&pump, Port::Inlet, [Leg::constant_speed(0.0, 7.0)]);
        let mut series = run().in_series();
        let mut kpa = [0.0; 3];
        series.fill_kpa(&[-1.0, 0.0, 0.3], &mut kpa);
        assert_eq!(kpa[..2], [0.0; 2]);
        series.fill_kpa(&[0.1], &mut kpa);
        assert!((kpa[0] - run().at(0.3).above_reservoir_kpa).abs() < 1e-12);
    }

    #[test]
    fn absolute_pressures_lie_above_the_reservoir_by_the_others() {
        let pump = Pump::three_roller();
        let run = || ExactRun::from_rest(&pump, Port::Outlet, [Leg::constant_speed(0.0, 7.0)]);
        let times_s: [f64; 100] = core::array::from_fn(|n| 3e-3 * n as f64);
        let [mut above_kpa, mut kpa, mut every_kpa] = [[0.0; 100]; 3];
        run().in_series().fill_kpa(&times_s, &mut above_kpa);
        run().in_series().fill_pressure_kpa(&times_s, &mut kpa);
        run().every(3e-3).fill_pressure_kpa(&mut every_kpa);
        for ((above_kpa, kpa), every_kpa) in above_kpa.iter().zip(kpa).zip(every_kpa) {
            assert!((above_kpa + pump.outlet().reservoir_kpa - kpa).abs() < 1e-12);
            assert!((every_kpa - kpa).abs() < 1e-12);
        }
    }
}
