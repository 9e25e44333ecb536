//! Samples of a run with derivatives at equal intervals.

use crate::line::reach::{LANES, reached};
use crate::motion::leg::Leg;

use super::augmented::{Augmented, physical, units};
use super::parameter::SensitivityParameter;
use super::reach::{SensitiveCauses, SensitiveReach};
use super::run::SensitiveRun;
use super::state::SensitiveState;

/// Number of rows of samples that follow from one sample.
const ROWS: usize = 4;

/// Number of samples that follow from one, itself included.
const COUNT: usize = ROWS * LANES;

/// Samples of a [`SensitiveRun`] at equal intervals, as [`crate::ExactSamples`] are those of an exact run. Inside a
/// stretch at constant speed each costs some 50 multiplications, none of which waits for another sample.
#[derive(Debug, Clone)]
pub struct SensitiveSamples<'a, M> {
    /// The run at the next sample.
    run: SensitiveRun<'a, M>,
    /// Units of the derivatives.
    units: [f64; SensitivityParameter::COUNT],
    start_s: f64,
    dt_s: f64,
    reach: SensitiveReach<ROWS>,
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
    /// Flow at the rollers per radian, mL/rad, on the side of an edge on which the derivatives are, where it is asked
    /// for.
    pub flow_ml_rad: Option<&'a mut [f64]>,
    /// Rates of change of the pressure, kPa/s, where they are asked for.
    pub rate_kpa_s: Option<&'a mut [f64]>,
}

impl<'a, M: Iterator<Item = Leg>> SensitiveRun<'a, M> {
    /// Returns the states at n `dt_s` from the time reached on, n = 0, 1, 2 ... without end. `dt_s` must be
    /// positive.
    pub fn every(self, dt_s: f64) -> SensitiveSamples<'a, M> {
        SensitiveSamples {
            units: units(self.line, &self.oscillator),
            start_s: self.time_s(),
            dt_s,
            reach: SensitiveReach::new(&self.oscillator, dt_s),
            run: self,
            number: 0,
        }
    }
}

impl<M: Iterator<Item = Leg>> SensitiveSamples<'_, M> {
    /// Writes the pressures of the next samples and their derivatives, for less than asking for them one by one.
    pub fn fill(&mut self, columns: SensitiveColumns<'_>) {
        let SensitiveColumns { kpa, mut kpa_by, mut flow_ml_rad, mut rate_kpa_s } = columns;
        let asked = [&flow_ml_rad, &rate_kpa_s].into_iter().flatten().map(|column| column.len());
        let lengths = kpa_by.iter().map(|column| column.len()).chain(asked);
        let count = lengths.fold(kpa.len(), usize::min);
        let mut done = 0;
        while done < count {
            let causes = self.reach.causes(&self.run.state, &self.run.flows, self.run.reached_s);
            let inside = self.inside().min(count - done);
            if count - done >= COUNT {
                // The next samples overwrite the excess of a row.
                let rows = inside.div_ceil(LANES);
                for (row, lanes) in self.reach.kpa(causes).take(rows).enumerate() {
                    let place = done + row * LANES..done + (row + 1) * LANES;
                    let [states, derivatives @ ..] = lanes;
                    kpa[place.clone()].copy_from_slice(&states);
                    for ((column, by), unit) in kpa_by.iter_mut().zip(derivatives).zip(self.units) {
                        column[place.clone()].copy_from_slice(&by.map(|by| unit * by));
                    }
                }
            } else {
                for n in 0..inside {
                    let [[x, _], derivatives @ ..] = self.sample(n, &causes);
                    kpa[done + n] = x;
                    for ((column, [by, _]), unit) in kpa_by.iter_mut().zip(derivatives).zip(self.units) {
                        column[done + n] = unit * by;
                    }
                }
            }
            if let Some(flow_ml_rad) = &mut flow_ml_rad {
                self.fill_flow_ml_rad(&mut flow_ml_rad[done..done + inside]);
            }
            if let Some(rate_kpa_s) = &mut rate_kpa_s {
                self.fill_rate_kpa_s(&mut rate_kpa_s[done..done + inside], causes);
            }
            self.go_on(inside, &causes);
            done += inside;
        }
    }

    /// Writes the flow per radian at the next samples, which must lie inside the stretch.
    fn fill_flow_ml_rad(&self, flow_ml_rad: &mut [f64]) {
        let stretch = self.run.stretch;
        if self.run.flows.are_even() {
            flow_ml_rad.fill(stretch.flow_ml_rad(self.time_s(0)));
            return;
        }
        let first_s = self.time_s(0);
        for (n, flow_ml_rad) in flow_ml_rad.iter_mut().enumerate() {
            *flow_ml_rad = stretch.flow_ml_rad(first_s + n as f64 * self.dt_s);
        }
    }

    /// Writes the rates of change of the pressure at the next samples, which must lie inside the stretch.
    fn fill_rate_kpa_s(&self, rate_kpa_s: &mut [f64], causes: SensitiveCauses) {
        let run = &self.run;
        let rate = |n: usize, second_kpa: f64| {
            let flow = run.flows.line.at(run.reached_s + n as f64 * self.dt_s);
            let [rate, _] = run.oscillator.derivative([0.0, second_kpa], flow);
            rate
        };
        let rows = rate_kpa_s.chunks_mut(LANES).zip(self.reach.second_kpa(causes));
        for (row, (places, lanes)) in rows.enumerate() {
            for (lane, (place, second_kpa)) in places.iter_mut().zip(lanes).enumerate() {
                *place = rate(row * LANES + lane, second_kpa);
            }
        }
        // Where the flow's degree is above 4 the first sample alone is known, without lanes.
        let [[_, second_kpa], ..] = run.state;
        if let Some(first) = rate_kpa_s.first_mut() {
            *first = rate(0, second_kpa);
        }
    }

    /// Returns the state of the next sample, n = 0, or of a later one inside the stretch.
    fn sample(&self, n: usize, causes: &SensitiveCauses) -> Augmented {
        if n == 0 { self.run.state } else { self.reach.state(n, causes) }
    }

    /// Goes on over `count` samples, one or more of which lie inside the stretch.
    fn go_on(&mut self, count: usize, causes: &SensitiveCauses) {
        let next_s = self.time_s(count);
        let is_inside = next_s <= self.run.stretch.end_s && self.run.flows.line.degree <= 4;
        // The last sample inside is nearer to the edge than the first.
        let known = if is_inside { count } else { count - 1 };
        self.run.state = self.sample(known, causes);
        self.run.reached_s = self.time_s(known) - self.run.stretch.start_s;
        if !is_inside {
            self.run.go_to(next_s);
        }
        self.number += count as u64;
    }

    /// Returns the number of next samples that lie inside the stretch and have a lane, without the last lane. It is one
    /// at least: the run stands at the next sample.
    fn inside(&self) -> usize {
        let run = &self.run;
        if run.flows.line.degree > 4 {
            return 1;
        }
        reached(COUNT - 1, run.stretch.end_s, self.dt_s, |n| self.time_s(n))
    }

    /// Returns the time of the next sample, n = 0, or of a later one, s.
    fn time_s(&self, n: usize) -> f64 {
        self.start_s + (self.number + n as u64) as f64 * self.dt_s
    }
}

impl<M: Iterator<Item = Leg>> Iterator for SensitiveSamples<'_, M> {
    type Item = SensitiveState;

    fn next(&mut self) -> Option<SensitiveState> {
        let state = physical(self.run.line, &self.run.oscillator, &self.run.state);
        self.number += 1;
        self.run.go_to(self.time_s(0));
        Some(state)
    }
}
