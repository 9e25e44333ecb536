//! Samples of an exact run at any rising times.

use crate::motion::flow::DEGREE;
use crate::motion::leg::Leg;

use crate::line::exact_run::{ExactRun, next_stretch};
use crate::line::line_state::LineState;
use crate::line::oscillator::{Balanced, Oscillator};
use crate::line::propagator::RECIPROCALS;

/// Number of samples that are computed together, each in a lane of its own.
const LANES: usize = 8;

/// Number of terms of a series: 2^32 9!/32! is below rounding.
const TERMS: usize = 32;

/// Number of what decides a series: a state, and the coefficients of a flow.
const CAUSES: usize = DEGREE + 3;

/// |A| h of the longest time for which a series is used. A longer one needs more terms, a shorter one more series.
const REACH: f64 = 2.0;

/// Samples of an [`ExactRun`] at any times that rise. Close together, each pressure costs some twenty multiplications.
///
/// One Taylor series serves all samples until the next edge, or until the line has swung on so far that it would need
/// more terms.
#[derive(Debug, Clone)]
pub struct ExactSeries<'a, M> {
    /// The run at the start of the series under way.
    run: ExactRun<'a, M>,
    basis: Basis,
    series: Series,
    /// Time of the last sample since the stretch's start, s.
    last_s: f64,
}

/// Taylor coefficients of x and y in turn, lowest order first.
type Series = [f64; 2 * TERMS];

/// Taylor coefficients of the line's states by each cause, over fractions of a fixed length of time.
#[derive(Debug, Clone)]
struct Basis {
    length_s: f64,
    per_length: f64,
    causes: [Series; CAUSES],
    /// Number of terms that are not below rounding. It is even.
    terms: usize,
}

impl Basis {
    /// Builds the series of z' = A z + b f(t): Z_(n+1) = H (A Z_n + b f_n H^n) / (n + 1).
    fn new(oscillator: &Oscillator) -> Self {
        // A line that cannot move has no time of its own.
        let length_s = (REACH / oscillator.norm()).min(1e300);
        let mut causes = [[0.0; 2 * TERMS]; CAUSES];
        let mut terms = 1;
        for (cause, series) in causes.iter_mut().enumerate() {
            let mut term: Balanced = [[1.0, 0.0], [0.0, 1.0]].get(cause).copied().unwrap_or_default();
            // The flow of order k enters behind the term k, and decides none before.
            let enters = cause.checked_sub(2);
            for (n, place) in series.as_chunks_mut().0.iter_mut().enumerate() {
                *place = term;
                if term[0].abs() + term[1].abs() > 1e-18 {
                    terms = terms.max(n + 1);
                }
                let factor =
                    length_s * RECIPROCALS.get(n + 1).copied().unwrap_or_else(|| 1.0 / (n + 1) as f64);
                term = oscillator.times(term).map(|x| factor * x);
                if enters == Some(n) {
                    // In units of the flow that moves the line by as much as a state of 1 does.
                    term[0] += RECIPROCALS[n + 1];
                }
            }
        }
        Self { length_s, per_length: 1.0 / length_s, causes, terms: terms.next_multiple_of(2) }
    }

    /// Makes `series` that of a run from its state on.
    fn begin<M>(&self, run: &ExactRun<'_, M>, series: &mut Series) {
        let ExactRun { oscillator, state, flow, .. } = run;
        *series = [0.0; 2 * TERMS];
        let mut add = |effects: &Series, cause: f64| {
            for (sum, effect) in series.iter_mut().zip(effects) {
                *sum += cause * effect;
            }
        };
        let [by_x, by_y, by_flow @ ..] = &self.causes;
        add(by_x, state[0]);
        add(by_y, state[1]);
        let mut power = self.length_s * oscillator.rate * oscillator.impedance;
        for (effects, c) in by_flow.iter().zip(flow.shifted(run.reached_s).terms()) {
            if c != 0.0 {
                add(effects, power * c);
            }
            power *= self.length_s;
        }
    }

    /// Returns the terms that count, one of even and one of odd order together. Such two do not wait for each other.
    fn terms<'a>(&self, series: &'a Series) -> &'a [[f64; 4]] {
        let terms = series.as_chunks().0;
        terms.get(..self.terms / 2).unwrap_or(terms)
    }

    /// Returns the state at a part of the length.
    fn at(&self, series: &Series, part: f64) -> Balanced {
        let square = part * part;
        let mut sums = [0.0; 4];
        for terms in self.terms(series).iter().rev() {
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum = *sum * square + term;
            }
        }
        let [x, y, odd_x, odd_y] = sums;
        [x + part * odd_x, y + part * odd_y]
    }

    /// Returns the pressures at parts of the length, kPa.
    #[inline]
    fn kpa(&self, series: &Series, parts: &[f64; LANES]) -> [f64; LANES] {
        let squares = parts.map(|part| part * part);
        let (mut even, mut odd) = ([0.0; LANES], [0.0; LANES]);
        for [x, _, odd_x, _] in self.terms(series).iter().rev() {
            for ((even, odd), square) in even.iter_mut().zip(&mut odd).zip(squares) {
                *even = *even * square + x;
                *odd = *odd * square + odd_x;
            }
        }
        for ((even, odd), part) in even.iter_mut().zip(odd).zip(parts) {
            *even += part * odd;
        }
        even
    }
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
        let basis = Basis::new(&run.oscillator);
        let mut series = [0.0; 2 * TERMS];
        basis.begin(&run, &mut series);
        Self { last_s: run.reached_s, run, basis, series }
    }

    /// Writes the pressures above the reservoir at `times_s`, kPa. The times must rise, and so must those of one call
    /// after another; a time in the past gives the state reached. The excess of a longer slice is left as it is.
    pub fn fill_kpa(&mut self, mut times_s: &[f64], mut kpa: &mut [f64]) {
        while let (Some(first_s), false) = (times_s.first(), kpa.is_empty()) {
            self.reach(*first_s);
            let start_s = self.run.time_s();
            let room_s = self.basis.length_s.min(self.run.stretch.end_s - start_s);
            let last = (self.last_s - self.run.reached_s) * self.basis.per_length;
            let mut parts = [0.0; LANES];
            let mut count = 0;
            for (part, time_s) in parts.iter_mut().zip(times_s.iter().take(kpa.len())) {
                let since_s = time_s - start_s;
                // The first is inside, whatever the difference rounds to.
                if count > 0 && since_s > room_s {
                    break;
                }
                *part = (since_s * self.basis.per_length).max(last);
                count += 1;
            }
            let found = self.basis.kpa(&self.series, &parts);
            let (now, later) = kpa.split_at_mut(count);
            now.copy_from_slice(&found[..count]);
            self.last_s = self.run.reached_s + parts[count - 1] * self.basis.length_s;
            (times_s, kpa) = (&times_s[count..], later);
        }
    }

    /// Returns the state of the last sample, or that of the start.
    pub fn state(&self) -> LineState {
        LineState::of(self.run.oscillator.physical(self.within(self.last_s)))
    }

    /// Returns the run, which goes on from the last sample.
    pub fn into_run(mut self) -> ExactRun<'a, M> {
        self.go_to(self.last_s);
        self.run
    }

    /// Returns the state `since_s` after the stretch's start, which the series must reach.
    fn within(&self, since_s: f64) -> Balanced {
        self.basis.at(&self.series, (since_s - self.run.reached_s) * self.basis.per_length)
    }

    /// Makes a series that reaches `time_s`, unless the one under way does.
    fn reach(&mut self, time_s: f64) {
        while time_s > self.run.stretch.end_s {
            self.go_to(self.run.stretch.end_s - self.run.stretch.start_s);
            let next = next_stretch(&mut self.run.stretches);
            self.run.begin(next);
            self.last_s = 0.0;
            self.basis.begin(&self.run, &mut self.series);
        }
        let since_s = time_s - self.run.stretch.start_s;
        if since_s - self.run.reached_s > self.basis.length_s {
            // The next sample may be within reach of the last one.
            self.go_to(if since_s - self.last_s > self.basis.length_s { since_s } else { self.last_s });
            self.basis.begin(&self.run, &mut self.series);
        }
    }

    /// Takes the run to `since_s` after the stretch's start.
    fn go_to(&mut self, since_s: f64) {
        let is_near = since_s - self.run.reached_s <= self.basis.length_s;
        let by_series_s = if is_near { since_s } else { self.last_s };
        self.run.state = self.within(by_series_s);
        self.run.reached_s = by_series_s;
        self.run.go_on(since_s - by_series_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::line::Line;
    use crate::port::Port;
    use crate::pump::pump::Pump;

    #[test]
    fn few_terms_are_above_rounding() {
        let basis = Basis::new(&Oscillator::new(&Line::PUBLISHED, Port::Outlet));
        assert!(basis.terms < TERMS, "{}", basis.terms);
    }

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
}
