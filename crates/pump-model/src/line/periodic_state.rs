//! The periodic state of a line at constant speed, in closed form.

use crate::error::ModelError;
use crate::head::flow_curve::FlowCurve;
use crate::motion::leg::Leg;
use crate::port::Port;

use super::exact_run::ExactRun;
use super::fine_steps::FineSteps;
use super::line::Line;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator};
use super::propagator::Propagator;

/// Returns the state of `line` at angle 0 that repeats itself every pitch of `curve`, the flow curve of
/// `port`.
///
/// The state after a period T is e^(A T) z + b, so z = -(e^(A T) - I)^-1 b. An undamped resonance has no such
/// state. For a period long against the decay, e^(A T) is 0 and z is b.
pub(crate) fn periodic_state(
    line: &Line,
    curve: &FlowCurve,
    port: Port,
    speed_rad_s: f64,
) -> Result<LineState, ModelError> {
    let steps = FineSteps::new(&Oscillator::new(line, port));
    periodic_state_by(&steps, line, curve, port, speed_rad_s)
}

/// Returns the periodic state as [`periodic_state`] does, by fine steps of this line.
pub(crate) fn periodic_state_by(
    steps: &FineSteps,
    line: &Line,
    curve: &FlowCurve,
    port: Port,
    speed_rad_s: f64,
) -> Result<LineState, ModelError> {
    let period_s = curve.pitch_rad() / speed_rad_s.abs();
    let motion = [Leg::constant_speed(0.0, speed_rad_s)];
    let mut run = ExactRun::on(line, curve, port, motion, LineState::AT_REST);
    run.go_by(steps, period_s);
    repeated_state(&run.oscillator, period_s, run.state())
        .ok_or(ModelError::UndampedResonance { port, speed_rad_s })
}

/// Returns the state that repeats itself every `period_s` under a flow that takes the line from rest to
/// `after` in that time. It is none at an undamped resonance.
pub(super) fn repeated_state(oscillator: &Oscillator, period_s: f64, after: LineState) -> Option<LineState> {
    let [state] = repeated(oscillator, period_s, [oscillator.balanced(after.numbers())])?;
    Some(LineState::of(oscillator.physical(state)))
}

/// Returns the states that repeat themselves every `period_s`, each under an input that takes it from 0 to that of
/// `after` in that time. There are none at an undamped resonance.
pub(crate) fn repeated<const K: usize>(
    oscillator: &Oscillator,
    period_s: f64,
    after: [Balanced; K],
) -> Option<[Balanced; K]> {
    let [[a, c], [b, d]] = Propagator::new(oscillator, period_s, 0).change();
    let determinant = a * d - b * c;
    // An eigenvalue of e^(A T) is known to rounding times the phase turned, as far as it has not died out. A
    // line that does not swing has no resonance.
    let rounding = oscillator.swing_left(period_s) * 1e-12 * (1.0 + oscillator.norm() * period_s);
    if determinant == 0.0 || determinant.abs() < rounding * rounding {
        return None;
    }
    Some(after.map(|[bx, by]| [(b * by - d * bx) / determinant, (c * bx - a * by) / determinant]))
}
