//! Time that a line needs to come to rest after the last step.

use crate::error::ModelError;
use crate::math::polynomial::Polynomial;
use crate::motion::flow::Flow;

use super::oscillator::{Balanced, Oscillator};

/// Volume that may still move in a settled line, mL: 1 uL.
pub const SETTLED_ML: f64 = 1e-3;

/// Time after which a line counts as never settling, s.
const LIMIT_S: f64 = 3600.0;

/// Number of steps after which a line counts as never settling. A swing takes several steps.
const LIMIT_STEPS: u32 = 2_000_000;

/// Returns the time after which the undelivered volume |C p| stays below [`SETTLED_ML`], s. The line is left
/// in `state` with the rotor at rest.
///
/// The energy x² + y² of a passive line only falls. Once it is below that of the allowed pressure the volume
/// stays inside for ever, so the last crossing seen was the last.
pub(crate) fn settling_s(
    oscillator: &Oscillator,
    compliance_ml_kpa: f64,
    state: Balanced,
) -> Result<f64, ModelError> {
    let allowed_kpa = SETTLED_ML / compliance_ml_kpa;
    let no_flow = Flow::default();
    let mut state = state;
    let mut time_s = 0.0;
    let mut settled_s = 0.0;
    for _ in 0..LIMIT_STEPS {
        if state[0] * state[0] + state[1] * state[1] < allowed_kpa * allowed_kpa {
            return Ok(settled_s);
        }
        if time_s > LIMIT_S {
            break;
        }
        // The step never more than doubles the time, so the time stays finite.
        let length_s = oscillator.fine_step_s(time_s, f64::INFINITY).min(1.0 + time_s);
        let next = oscillator.after(length_s, state, &no_flow);
        let pressure = oscillator.pressure(length_s, state, next, &no_flow);
        for bound in [allowed_kpa, -allowed_kpa] {
            let crossings = pressure.plus(&Polynomial::constant(-bound)).roots_in(0.0, 1.0);
            if let Some(last) = crossings.as_slice().last() {
                settled_s = f64::max(settled_s, time_s + place(oscillator, state, last * length_s, bound));
            }
        }
        state = next;
        time_s += length_s;
    }
    Err(ModelError::NeverSettles { waited_s: time_s })
}

/// Returns the time near `near_s` after `state` at which the exact pressure is `bound_kpa`, by Newton's
/// method.
fn place(oscillator: &Oscillator, state: Balanced, near_s: f64, bound_kpa: f64) -> f64 {
    let mut t = near_s;
    for _ in 0..3 {
        let there = oscillator.after(t, state, &Flow::default());
        let shift = (there[0] - bound_kpa) / oscillator.derivative(there, 0.0)[0];
        // A crossing that only touches the bound has no slope; it stays where the polynomial put it.
        if !shift.is_finite() || shift.abs() > 0.5 * near_s {
            break;
        }
        t -= shift;
    }
    t
}
