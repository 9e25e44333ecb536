//! Samples of a run with derivatives at equal intervals.

use crate::motion::leg::Leg;

use super::augmented::{STATES, physical, units};
use super::interval::Interval;
use super::parameter::SensitivityParameter;
use super::run::SensitiveRun;
use super::state::SensitiveState;

/// Samples of a [`SensitiveRun`] at equal intervals, as [`crate::ExactSamples`] are those of an exact run. Inside a
/// stretch at constant speed each costs some 50 multiplications.
#[derive(Debug, Clone)]
pub struct SensitiveSamples<'a, M> {
    run: SensitiveRun<'a, M>,
    /// Units of the pressure and of its derivatives.
    units: [f64; STATES],
    start_s: f64,
    dt_s: f64,
    interval: Interval,
    /// True if the interval has the inputs of the stretch under way.
    ready: bool,
    /// Number of the next sample.
    number: u64,
}

/// Columns for the samples of a port. They should be of one length; the excess of a longer one is left as it is.
#[derive(Debug)]
pub struct SensitiveColumns<'a> {
    /// Pressures above the reservoir, kPa.
    pub kpa: &'a mut [f64],
    /// Derivatives of the pressure, kPa over the unit of each parameter, in the order of
    /// [`SensitivityParameter::ALL`].
    pub kpa_by: [&'a mut [f64]; SensitivityParameter::COUNT],
    /// Flow at the rollers per radian, mL/rad, on the side of an edge on which the derivatives are.
    pub flow_ml_rad: &'a mut [f64],
}

impl<'a, M: Iterator<Item = Leg>> SensitiveRun<'a, M> {
    /// Returns the states at n `dt_s` from the time reached on, n = 0, 1, 2 ... without end. `dt_s` must be
    /// positive.
    pub fn every(self, dt_s: f64) -> SensitiveSamples<'a, M> {
        let [by_0, by_1, by_2, by_3, by_4] = units(self.line, &self.oscillator);
        SensitiveSamples {
            units: [1.0, by_0, by_1, by_2, by_3, by_4],
            start_s: self.time_s(),
            dt_s,
            interval: Interval::new(&self.oscillator, dt_s),
            run: self,
            ready: false,
            number: 0,
        }
    }
}

impl<M: Iterator<Item = Leg>> SensitiveSamples<'_, M> {
    /// Writes the pressures of the next samples and their derivatives, for less than asking for them one by one.
    pub fn fill(&mut self, columns: SensitiveColumns<'_>) {
        let SensitiveColumns { kpa, kpa_by, flow_ml_rad } = columns;
        let count =
            kpa_by.iter().map(|column| column.len()).fold(kpa.len().min(flow_ml_rad.len()), usize::min);
        let [by_0, by_1, by_2, by_3, by_4] = kpa_by.map(|column| column.iter_mut());
        let units = self.units;
        let mut places = kpa.iter_mut().zip(flow_ml_rad).zip(by_0).zip(by_1).zip(by_2).zip(by_3).zip(by_4);
        self.go(count, |x, flow| {
            if let Some(((((((kpa, flow_ml_rad), by_0), by_1), by_2), by_3), by_4)) = places.next() {
                *kpa = x[0];
                *by_0 = units[1] * x[1];
                *by_1 = units[2] * x[2];
                *by_2 = units[3] * x[3];
                *by_3 = units[4] * x[4];
                *by_4 = units[5] * x[5];
                *flow_ml_rad = flow;
            }
        });
    }

    /// Goes over the next `count` samples, and reports the pressures of the augmented state and the flow per radian
    /// at each.
    fn go(&mut self, count: usize, mut note: impl FnMut(&[f64; STATES], f64)) {
        let mut left = count;
        while left > 0 {
            left -= match (self.ready, self.interval.is_even()) {
                (false, _) => 0,
                (true, true) => self.go_inside::<true>(left, &mut note),
                (true, false) => self.go_inside::<false>(left, &mut note),
            };
            if left > 0 {
                // The next sample lies beyond an edge, or the rotor speeds up or down.
                self.run.go_to(self.next_s());
                self.number += 1;
                left -= 1;
                note(&self.run.state.map(|[x, _]| x), self.run.flow_ml_rad());
                self.ready = self.interval.take(&self.run.flows);
            }
        }
    }

    /// Goes over the next samples, `most` at most, that lie inside the stretch under way. Returns their number.
    #[inline]
    fn go_inside<const EVEN: bool>(
        &mut self,
        most: usize,
        note: &mut impl FnMut(&[f64; STATES], f64),
    ) -> usize {
        let (stretch_s, length_s) =
            (self.run.stretch.start_s, self.run.stretch.end_s - self.run.stretch.start_s);
        let (mut x, mut y) = (self.run.state.map(|[x, _]| x), self.run.state.map(|[_, y]| y));
        let mut reached_s = self.run.reached_s;
        let even_ml_rad = self.run.flow_ml_rad();
        let mut count = 0;
        while count < most {
            let next_s = self.next_s() - stretch_s;
            if next_s > length_s {
                break;
            }
            (x, y) = self.interval.after::<EVEN>(&x, &y, reached_s);
            let flow_ml_rad =
                if EVEN { even_ml_rad } else { self.run.stretch.flow_ml_rad(stretch_s + next_s) };
            note(&x, flow_ml_rad);
            reached_s = next_s;
            self.number += 1;
            count += 1;
        }
        for (state, (x, y)) in self.run.state.iter_mut().zip(x.into_iter().zip(y)) {
            *state = [x, y];
        }
        self.run.reached_s = reached_s;
        count
    }

    /// Returns the time of the next sample, s.
    fn next_s(&self) -> f64 {
        self.start_s + self.number as f64 * self.dt_s
    }
}

impl<M: Iterator<Item = Leg>> Iterator for SensitiveSamples<'_, M> {
    type Item = SensitiveState;

    fn next(&mut self) -> Option<SensitiveState> {
        self.go(1, |_, _| ());
        Some(physical(self.run.line, &self.run.oscillator, &self.run.state))
    }
}
