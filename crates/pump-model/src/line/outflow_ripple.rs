//! The ripple of the flow at the end of the outlet line, which the vessel sees.

use libm::sqrt;

use crate::head::flow_curve::FlowCurve;
use crate::math::hermite::{self, End};
use crate::math::polynomial::Polynomial;
use crate::motion::flow::Flow;
use crate::motion::leg::Leg;
use crate::motion::ripple::{Ripple, square_integral};
use crate::port::Port;

use super::exact_run::ExactRun;
use super::fine_steps::{FineSteps, Follower};
use super::line::Line;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator};
use super::periodic_state::repeated_state;
use super::reach::LANES;

/// Length of a step beyond which only slow parts of the state are left, in units of 1/|A|.
const LONG: f64 = 10.0;

impl Oscillator {
    /// Returns the flow at the line's end between two states over the fraction of the time passed, 0 to 1.
    /// The unit is that of a balanced state, kPa.
    fn outflow(&self, length_s: f64, [before, after]: [Balanced; 2], flows: [f64; 2]) -> Polynomial {
        if self.norm() * length_s > LONG {
            // Only slow parts are left, and a curvature would be the difference of large numbers.
            return Polynomial { c: [before[1], after[1] - before[1], 0.0, 0.0, 0.0, 0.0] };
        }
        // The flow at the rollers drives the pressure, so it enters the outflow's curvature first.
        let end = |state: Balanced, flow: f64| {
            let slope = self.derivative(state, flow);
            End { value: state[1], slope: slope[1], curvature: self.times(slope)[1] }
        };
        Polynomial { c: hermite::quintic(length_s, &end(before, flows[0]), &end(after, flows[1])) }
    }
}

/// Returns the ripple over time of the flow at the end of an outlet line, for a motion that repeats itself
/// without end. Returns none if there is no flow, or at a resonance that nothing damps.
pub(crate) fn outflow_ripple<I>(line: &Line, curve: &FlowCurve, legs: I) -> Option<Ripple>
where
    I: IntoIterator<Item = Leg> + Clone,
{
    let end_s = legs.clone().into_iter().map(|leg| leg.end_s()).fold(0.0, f64::max);
    if !(end_s > 0.0 && end_s.is_finite()) {
        return None;
    }
    let mut steps = FineSteps::new(&Oscillator::new(line, Port::Outlet));
    let mut from_rest = ExactRun::on(line, curve, Port::Outlet, legs.clone(), LineState::AT_REST);
    from_rest.go_by(&steps, end_s);
    let state = repeated_state(&from_rest.oscillator, end_s, from_rest.state())?;
    Tally::of(ExactRun::on(line, curve, Port::Outlet, legs, state), &mut steps, end_s).ripple(end_s)
}

/// Extremes, integral and integral of the square of a flow.
struct Tally {
    low: f64,
    high: f64,
    sum: f64,
    square: f64,
}

impl Tally {
    /// Follows a run to `end_s`, by fine steps of its line.
    fn of<M: Iterator<Item = Leg>>(mut run: ExactRun<'_, M>, steps: &mut FineSteps, end_s: f64) -> Self {
        let mut tally = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, sum: 0.0, square: 0.0 };
        while run.time_s() < end_s {
            run.follow_fine_steps(steps, end_s, &mut tally);
            let (before, from_s) = (run.state, run.reached_s);
            let flow_before = run.flow.at(from_s);
            let (length_s, is_last) = run.fine_step(end_s);
            let flows = [flow_before, run.flow.at(run.reached_s)];
            tally.add(length_s, &run.oscillator.outflow(length_s, [before, run.state], flows));
            if is_last && !run.enters_next(end_s) {
                break;
            }
        }
        tally
    }

    /// Adds the flow over a step.
    fn add(&mut self, length_s: f64, flow: &Polynomial) {
        self.cover(flow.at(0.0));
        self.cover(flow.at(1.0));
        let slope = flow.derivative();
        if slope.at(0.0) * slope.at(1.0) < 0.0 {
            self.cover_turns(flow);
        }
        let mean: f64 = flow.c.iter().enumerate().map(|(n, c)| c / (n + 1) as f64).sum();
        self.sum += length_s * mean;
        self.square += length_s * square_integral(|x| flow.at(x), 1.0);
    }

    fn cover(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// Covers the values at which a flow over a step turns.
    fn cover_turns(&mut self, flow: &Polynomial) {
        for turn in flow.derivative().roots_in(0.0, 1.0).as_slice() {
            self.cover(flow.at(*turn));
        }
    }

    /// Returns the ripple of a flow that was followed over `time_s`. In reverse the flow counts mirrored.
    fn ripple(&self, time_s: f64) -> Option<Ripple> {
        let mean = (self.sum / time_s).abs();
        let variance = self.square / time_s - mean * mean;
        (mean > 0.0).then(|| Ripple {
            peak_to_peak: (self.high - self.low) / mean,
            rms: sqrt(variance.max(0.0)) / mean,
        })
    }
}

impl Follower for Tally {
    /// Adds the flow over each step, the quintic through value, slope and curvature at both ends.
    fn follow(
        &mut self,
        oscillator: &Oscillator,
        step_s: f64,
        count: usize,
        [x, y]: &[[f64; LANES]; 2],
        flow: &Flow,
    ) {
        let mut q = [0.0; LANES];
        for c in flow.terms().rev() {
            for (lane, q) in q.iter_mut().enumerate() {
                *q = *q * (lane as f64 * step_s) + c;
            }
        }
        // Change of the outflow over a step, to first and second order.
        let (mut slope, mut bend) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let x_rate = oscillator.rate * (oscillator.impedance * q[lane] - y[lane]);
            let y_rate = oscillator.rate * x[lane] - oscillator.decay * y[lane];
            slope[lane] = step_s * y_rate;
            bend[lane] = step_s * step_s * (oscillator.rate * x_rate - oscillator.decay * y_rate);
        }
        let (sums, squares) = integrals(y, &slope, &bend);
        self.cover(y[0]);
        for lane in 1..LANES {
            if lane > count {
                break;
            }
            let from = lane - 1;
            self.sum += step_s * sums[from];
            self.square += step_s * squares[from];
            self.cover(y[lane]);
            if slope[from] * slope[lane] < 0.0 {
                let end = |lane: usize| End { value: y[lane], slope: slope[lane], curvature: bend[lane] };
                self.cover_turns(&Polynomial { c: hermite::quintic(1.0, &end(from), &end(lane)) });
            }
        }
    }
}

/// Returns the integrals of the quintics between neighbours, and of their squares, over a step of length 1.
fn integrals(
    y: &[f64; LANES],
    slope: &[f64; LANES],
    bend: &[f64; LANES],
) -> ([f64; LANES - 1], [f64; LANES - 1]) {
    let (mut sums, mut squares) = ([0.0; LANES - 1], [0.0; LANES - 1]);
    for lane in 0..LANES - 1 {
        // Even and odd parts about the middle of the step, which do not mix.
        let [y0, y1, d0, d1] = [y[lane], y[lane + 1], slope[lane], slope[lane + 1]];
        let [e0, e1] = [bend[lane], bend[lane + 1]];
        let (mean, rise) = (0.5 * (y0 + y1), 0.5 * (y1 - y0));
        let (swell, drift) = (0.5 * (d0 - d1), 0.5 * (d0 + d1));
        let (bow, twist) = (0.5 * (e0 + e1), 0.5 * (e1 - e0));
        sums[lane] = mean + swell / 5.0 + bow / 60.0;
        let even = mean * mean
            + 31.0 / 630.0 * swell * swell
            + bow * bow / 2520.0
            + mean * (0.4 * swell + bow / 30.0)
            + 11.0 / 1260.0 * swell * bow;
        let odd = 131.0 / 231.0 * rise * rise + 5.0 / 462.0 * drift * drift + twist * twist / 27_720.0
            - 32.0 / 231.0 * rise * drift
            + 5.0 / 693.0 * rise * twist
            - 17.0 / 13_860.0 * drift * twist;
        squares[lane] = even + odd;
    }
    (sums, squares)
}
