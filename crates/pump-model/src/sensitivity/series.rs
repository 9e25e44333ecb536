//! Pressures with their derivatives at any rising times, several at once.

use crate::line::oscillator::{Balanced, Oscillator};
use crate::line::propagator::RECIPROCALS;
use crate::motion::leg::Leg;

use super::augmented::{ANGLE, ByLine, LINE, units};
use super::parameter::SensitivityParameter;
use super::run::SensitiveRun;

/// Number of samples that are computed together, each in a lane of its own.
pub(crate) const LANES: usize = 8;

/// Number of terms of a series: 2^30 9!/30! is below rounding.
const TERMS: usize = 30;

/// |A| h of the longest time for which a series is used.
const REACH: f64 = 2.0;

/// Longest time of a series of a line that hardly moves, s.
const LONGEST_S: f64 = 1e3;

/// Number of states in a series: that of the line, and its derivatives by R, C, L and the angle.
const SERIES: usize = 2 + LINE;

/// Pressures above the reservoir, kPa, their derivatives by R, C, L and the angle, and their rates of change, kPa/s, of
/// samples in lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensitiveLanes {
    pub(crate) kpa: [f64; LANES],
    pub(crate) kpa_by: [[f64; LANES]; SERIES - 1],
    pub(crate) rate_kpa_s: [f64; LANES],
}

/// Samples of a [`SensitiveRun`] at any times that rise, without the derivative by the roller volume.
///
/// One Taylor series serves all samples until the next edge, or until the line has swung on so far that it would need
/// more terms.
#[derive(Debug)]
pub(crate) struct SensitiveSeries<'a, M> {
    /// The run at the start of the series under way.
    run: SensitiveRun<'a, M>,
    length_s: f64,
    /// Taylor coefficients of the states over parts of the length, lowest order first.
    terms: [[Balanced; SERIES]; TERMS],
    /// Part of the length at which the last sample stands.
    last: f64,
    units: [f64; SensitivityParameter::COUNT],
}

impl<'a, M: Iterator<Item = Leg>> SensitiveRun<'a, M> {
    /// Returns this run for samples at many times.
    pub(crate) fn in_series(self) -> SensitiveSeries<'a, M> {
        let mut series = SensitiveSeries {
            length_s: (REACH / self.oscillator.norm()).min(LONGEST_S),
            units: units(self.line, &self.oscillator),
            terms: [[[0.0; 2]; SERIES]; TERMS],
            last: 0.0,
            run: self,
        };
        series.begin();
        series
    }
}

impl<M: Iterator<Item = Leg>> SensitiveSeries<'_, M> {
    /// Computes the next samples, at the first of these times. The times must rise, from call to call too. Returns
    /// their number, one at least unless there is no time.
    pub(crate) fn next(&mut self, times_s: &[f64]) -> (usize, SensitiveLanes) {
        if let Some(first_s) = times_s.first() {
            self.reach(*first_s);
        }
        let start_s = self.run.time_s();
        let room_s = self.length_s.min(self.run.stretch.end_s - start_s);
        let mut parts = [self.last; LANES];
        let mut count = 0;
        for (part, time_s) in parts.iter_mut().zip(times_s) {
            let since_s = time_s - start_s;
            // The first is inside, whatever the difference rounds to.
            if count > 0 && since_s > room_s {
                break;
            }
            *part = (since_s / self.length_s).max(self.last);
            self.last = *part;
            count += 1;
        }
        (count, self.lanes(&parts))
    }

    /// Returns the samples at parts of the length.
    fn lanes(&self, parts: &[f64; LANES]) -> SensitiveLanes {
        let (mut sums, mut rate) = ([[0.0; LANES]; SERIES], [0.0; LANES]);
        for term in self.terms.iter().rev() {
            let [kpa, ..] = &sums;
            for ((rate, kpa), part) in rate.iter_mut().zip(kpa).zip(parts) {
                *rate = *rate * part + kpa;
            }
            for (sums, [x, _]) in sums.iter_mut().zip(term) {
                for (sum, part) in sums.iter_mut().zip(parts) {
                    *sum = *sum * part + x;
                }
            }
        }
        let [kpa, mut kpa_by @ ..] = sums;
        for (by, unit) in kpa_by.iter_mut().zip(self.units) {
            *by = by.map(|by| unit * by);
        }
        SensitiveLanes { kpa, kpa_by, rate_kpa_s: rate.map(|rate| rate / self.length_s) }
    }

    /// Makes a series that reaches `time_s`, unless the one under way does.
    fn reach(&mut self, time_s: f64) {
        let is_inside = time_s <= self.run.stretch.end_s;
        if is_inside && time_s - self.run.time_s() <= self.length_s {
            return;
        }
        // The last sample is nearer than the start of the series.
        let mut states = [[0.0; 2]; SERIES];
        for term in self.terms.iter().rev() {
            for ([x, y], [c, d]) in states.iter_mut().zip(term) {
                (*x, *y) = (*x * self.last + c, *y * self.last + d);
            }
        }
        for (state, found) in self.run.state.iter_mut().zip(states) {
            *state = found;
        }
        self.run.reached_s += self.last * self.length_s;
        self.run.go_to(time_s);
        self.begin();
    }

    /// Begins a series in the state of the run.
    fn begin(&mut self) {
        let SensitiveRun { oscillator, state, .. } = &self.run;
        let flows = self.run.flows.shifted(self.run.reached_s);
        let input = oscillator.rate * oscillator.impedance;
        let [mut line, by_resistance, by_compliance, by_inertance, ..] = *state;
        let mut by_line: ByLine<Balanced> = [by_resistance, by_compliance, by_inertance];
        let mut by_angle = state[ANGLE];
        let mut pushes = flows.line.c.iter().zip(&flows.by_angle.c);
        let mut power = input;
        for (n, term) in self.terms.iter_mut().enumerate() {
            let [by_resistance, by_compliance, by_inertance] = by_line;
            *term = [line, by_resistance, by_compliance, by_inertance, by_angle];
            // The flow of order n enters behind the term n.
            let (push, angle_push) = pushes.next().map_or((0.0, 0.0), |(c, by)| (power * c, power * by));
            power *= self.length_s;
            let factor =
                self.length_s * RECIPROCALS.get(n + 1).copied().unwrap_or_else(|| 1.0 / (n + 1) as f64);
            let [x, y] = oscillator.times(line);
            let rate = [x + push, y];
            let forced = oscillator.by_line(line, rate);
            by_line = next_by_line(oscillator, factor, &by_line, &forced);
            let [x, y] = oscillator.times(by_angle);
            by_angle = [factor * (x + angle_push), factor * y];
            line = rate.map(|x| factor * x);
        }
        self.last = 0.0;
    }
}

/// Returns the next term of the derivatives by R, C and L, which these parts force.
fn next_by_line(
    oscillator: &Oscillator,
    factor: f64,
    by_line: &ByLine<Balanced>,
    forced: &ByLine<Balanced>,
) -> ByLine<Balanced> {
    let mut next = *by_line;
    for (next, [forced_x, forced_y]) in next.iter_mut().zip(forced) {
        let [x, y] = oscillator.times(*next);
        *next = [factor * (x + forced_x), factor * (y + forced_y)];
    }
    next
}
