//! Pressures at times whose intervals are equal but for rounding and gaps.

use crate::line::exact_run::ExactRun;
use crate::line::exact_samples::Interval;
use crate::line::oscillator::{Balanced, Oscillator, SHORT};
use crate::motion::flow::Flow;
use crate::motion::leg::Leg;

use super::recording::PressureSample;

/// Most usual intervals that one step takes. A longer gap is crossed at once.
const MOST: f64 = 8.0;
/// Coefficients of a flow at constant speed, a quartic of time.
const COEFFICIENTS: usize = 5;
/// Number of terms of a short step's series: 0.5^17/17! is below rounding.
const TERMS: usize = 17;

/// An exact run that goes on by the usual interval, and by what the time of a sample differs from it.
///
/// The difference is short beside the swing of the line, so that few terms of its series count. The times are those of
/// the samples, to rounding.
pub(super) struct Uneven<'a, M> {
    run: ExactRun<'a, M>,
    usual_s: f64,
    usual: Interval,
    /// True if `usual` has the flow of the stretch under way.
    is_driven: bool,
}

impl<'a, M: Iterator<Item = Leg>> Uneven<'a, M> {
    pub(super) fn new(run: ExactRun<'a, M>, samples: &[PressureSample]) -> Self {
        let usual_s = usual_s(samples);
        Self { usual_s, usual: Interval::new(&run.oscillator, usual_s), run, is_driven: false }
    }

    /// Goes on to `t_s` and returns the pressure above the reservoir there, kPa.
    pub(super) fn at_kpa(&mut self, t_s: f64) -> f64 {
        let run = &mut self.run;
        let to_s = t_s - run.stretch.start_s;
        let count = libm::rint((to_s - run.reached_s) / self.usual_s);
        let from_s = run.reached_s + count * self.usual_s;
        let is_inside = t_s <= run.stretch.end_s && run.flow.degree < COEFFICIENTS;
        let is_near = run.oscillator.norm() * (to_s - from_s).abs() <= SHORT;
        if !(is_inside && is_near && (1.0..=MOST).contains(&count)) {
            self.is_driven &= t_s <= run.stretch.end_s;
            return run.at(t_s).above_reservoir_kpa;
        }
        if !self.is_driven {
            self.usual.drive(&run.flow);
            self.is_driven = true;
        }
        let [mut x, mut y] = run.state;
        let mut time_s = run.reached_s;
        for _ in 0..count as u32 {
            let ([next_x], [next_y]) = self.usual.after([x], [y], [time_s]);
            (x, y) = (next_x, next_y);
            time_s += self.usual_s;
        }
        run.state = short_step(&run.oscillator, to_s - time_s, [x, y], &run.flow, time_s);
        run.reached_s = to_s;
        run.state[0]
    }
}

/// Returns the state `h` after `state`, forward or backward. `flow` is that of the stretch, which began `time_s` ago.
#[inline]
fn short_step(oscillator: &Oscillator, h: f64, state: Balanced, flow: &Flow, time_s: f64) -> Balanced {
    // The polynomial in the time since `time_s`.
    let mut c = [flow.c[0], flow.c[1], flow.c[2], flow.c[3], flow.c[4]];
    for lowest in 0..COEFFICIENTS - 1 {
        for n in (lowest..COEFFICIENTS - 1).rev() {
            c[n] += time_s * c[n + 1];
        }
    }
    let (rate, decay) = (oscillator.rate, oscillator.decay);
    let mut power = oscillator.derivative([0.0; 2], 1.0)[0];
    let ([mut x, mut y], mut sum) = (state, state);
    for (n, c) in c.into_iter().enumerate() {
        let factor = h * (1.0 / (n + 1) as f64);
        (x, y) = (factor * (power * c - rate * y), factor * (rate * x - decay * y));
        sum = [sum[0] + x, sum[1] + y];
        power *= h;
    }
    for n in COEFFICIENTS..TERMS {
        if x.abs() + y.abs() <= 1e-18 * (sum[0].abs() + sum[1].abs()) {
            break;
        }
        let factor = h / (n + 1) as f64;
        (x, y) = (-factor * rate * y, factor * (rate * x - decay * y));
        sum = [sum[0] + x, sum[1] + y];
    }
    sum
}

/// Returns the usual interval of samples, s: the mean of those that are not half as long again as the shortest.
fn usual_s(samples: &[PressureSample]) -> f64 {
    let intervals = || samples.iter().zip(samples.iter().skip(1)).map(|(one, next)| next.time_s - one.time_s);
    let most_s = 1.5 * intervals().fold(f64::INFINITY, f64::min);
    let (mut sum_s, mut count) = (0.0, 0.0);
    for interval_s in intervals() {
        if interval_s <= most_s {
            sum_s += interval_s;
            count += 1.0;
        }
    }
    // A single sample has no interval; any length does.
    if count > 0.0 { sum_s / count } else { 1.0 }
}
