//! The ripple of the flow at the end of the outlet line, which the vessel sees.

use libm::sqrt;

use crate::head::flow_curve::FlowCurve;
use crate::math::hermite::{self, End};
use crate::math::polynomial::Polynomial;
use crate::motion::leg::Leg;
use crate::motion::ripple::{Ripple, square_integral};
use crate::port::Port;

use super::exact_run::ExactRun;
use super::line::Line;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator};
use super::periodic_state::repeated_state;

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
    let after = ExactRun::on(line, curve, Port::Outlet, legs.clone(), LineState::AT_REST).at(end_s);
    let state = repeated_state(&Oscillator::new(line, Port::Outlet), end_s, after)?;
    Tally::of(ExactRun::on(line, curve, Port::Outlet, legs, state), end_s).ripple(end_s)
}

/// Extremes, integral and integral of the square of a flow.
struct Tally {
    low: f64,
    high: f64,
    sum: f64,
    square: f64,
}

impl Tally {
    /// Follows a run to `end_s`.
    fn of<M: Iterator<Item = Leg>>(mut run: ExactRun<'_, M>, end_s: f64) -> Self {
        let mut tally = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, sum: 0.0, square: 0.0 };
        while run.time_s() < end_s {
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
        let mut cover = |value: f64| {
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        };
        cover(flow.at(0.0));
        cover(flow.at(1.0));
        let slope = flow.derivative();
        if slope.at(0.0) * slope.at(1.0) < 0.0 {
            slope.roots_in(0.0, 1.0).as_slice().iter().for_each(|turn| cover(flow.at(*turn)));
        }
        let mean: f64 = flow.c.iter().enumerate().map(|(n, c)| c / (n + 1) as f64).sum();
        self.sum += length_s * mean;
        self.square += length_s * square_integral(|x| flow.at(x), 1.0);
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
