//! A line's state augmented by its derivatives, and its rate of change.
//!
//! A derivative s of the state z by a parameter p follows s' = A s + (dA/dp) z + (db/dp) f + b (df/dp), where
//! z' = A z + b f. The augmented system is linear with the forcing of the line itself.

use crate::line::line::Line;
use crate::line::line_state::LineState;
use crate::line::oscillator::{Balanced, Oscillator};
use crate::math::polynomial::Polynomial;
use crate::motion::flow::Flow;
use crate::motion::stretches::Stretch;

use super::parameter::SensitivityParameter;
use super::state::SensitiveState;

/// Number of states: that of the line, and its derivatives.
pub(super) const STATES: usize = 1 + SensitivityParameter::COUNT;
/// Number of parameters of the line: R, C and L.
pub(super) const LINE: usize = 3;
/// States that a flow of their own drives, after those of the line: the derivatives by angle and roller volume.
pub(super) const ANGLE: usize = 4;
pub(super) const ROLLER: usize = 5;

/// State z and its derivatives in the coordinates of the [`Oscillator`], whose impedance is held.
///
/// The derivatives are Z dz/dR with the impedance Z, C dz/dC, L dz/dL, dz/d(angle) and dz/dV_r, so that those by
/// the line's parameters are about as large as the state.
pub(super) type Augmented = [Balanced; STATES];

/// Derivatives by the line's parameters.
pub(super) type ByLine<T> = [T; LINE];

/// Flows that drive the state and its derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Flows {
    /// Flow at the rollers, mL/s.
    pub(super) line: Flow,
    /// Derivative of the flow by the angle, mL/(s rad).
    pub(super) by_angle: Flow,
    /// Derivative of the flow by the roller volume, 1/s.
    pub(super) by_roller: Flow,
}

impl Flows {
    /// Returns the flows of a stretch. Between pulses `nominal_ml_rad` flow, and a roller displaces `roller_ml`.
    pub(super) fn of(stretch: &Stretch, nominal_ml_rad: f64, roller_ml: f64) -> Self {
        let pulses = stretch.flow.plus(&Polynomial::constant(-nominal_ml_rad)).scaled(1.0 / roller_ml);
        Self {
            line: stretch.flow(),
            by_angle: stretch.flow_of(&stretch.flow.derivative()),
            by_roller: stretch.flow_of(&pulses),
        }
    }

    /// True if no flow changes with time.
    pub(super) fn are_even(&self) -> bool {
        [&self.line, &self.by_angle, &self.by_roller]
            .iter()
            .all(|flow| flow.terms().skip(1).all(|c| c == 0.0))
    }

    /// Returns the flows over the time since `t`.
    pub(super) fn shifted(&self, t: f64) -> Self {
        if self.are_even() {
            return *self;
        }
        Self {
            line: self.line.shifted(t),
            by_angle: self.by_angle.shifted(t),
            by_roller: self.by_roller.shifted(t),
        }
    }
}

/// Units of the derivatives: the derivative by a parameter is that of [`Augmented`] times its unit.
pub(super) fn units(line: &Line, oscillator: &Oscillator) -> [f64; SensitivityParameter::COUNT] {
    let per_resistance = 1.0 / oscillator.impedance;
    [per_resistance, 1.0 / line.compliance_ml_kpa, 1.0 / line.inertance_kpa_s2_ml, 1.0, 1.0]
}

/// Returns the augmented state of a state with derivatives.
pub(super) fn augmented(line: &Line, oscillator: &Oscillator, state: &SensitiveState) -> Augmented {
    let mut augmented = [oscillator.balanced(state.state.numbers()); STATES];
    let derivatives = state.pressure_by.iter().zip(&state.flow_by).zip(units(line, oscillator));
    for (place, ((pressure, flow), unit)) in augmented.iter_mut().skip(1).zip(derivatives) {
        *place = oscillator.balanced([pressure / unit, flow / unit]);
    }
    augmented
}

/// Returns the state with derivatives of an augmented state.
pub(super) fn physical(line: &Line, oscillator: &Oscillator, augmented: &Augmented) -> SensitiveState {
    let [state, derivatives @ ..] = augmented;
    let mut sensitive = SensitiveState::fixed(LineState::of(oscillator.physical(*state)));
    let places = sensitive.pressure_by.iter_mut().zip(&mut sensitive.flow_by);
    for ((place, derivative), unit) in places.zip(derivatives).zip(units(line, oscillator)) {
        let [pressure, flow] = oscillator.physical(*derivative);
        (*place.0, *place.1) = (unit * pressure, unit * flow);
    }
    sensitive
}

impl Oscillator {
    /// Returns the parts (dA/dp) z + (db/dp) f of the derivatives by R, C and L, for a state z with the rate of
    /// change A z + b f = `rate`. C and L divide the rate of pressure and flow, and R damps the flow.
    pub(super) fn by_line(&self, state: Balanced, rate: Balanced) -> ByLine<Balanced> {
        [[0.0, -self.rate.abs() * state[1]], [-rate[0], 0.0], [0.0, -rate[1]]]
    }
}
