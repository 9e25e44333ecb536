//! The outlet's line as it may be: with the compliance that is known, and with less and more.

use libm::ceil;
use pump_model::{FlowCurve, Leg, Line, LineState, LineStep};

use super::left_over::LeftOver;
use super::ring_down::{Decay, RingDown};
use crate::plan::profile::Profile;

/// Compliances for which the ramps are made, over the one that is known. Lamé's formula misses the paper's
/// measured compliance by as much (0.0455 against 0.0361 mL/kPa), and from what side is not known.
const COMPLIANCES: [f64; 3] = [0.75, 1.0, 1.25];

/// Place of the line that is known among those that may be.
pub(super) const KNOWN: usize = 1;

/// States of the lines that may be.
pub(super) type States = [LineState; 3];

/// The lines that may be at the outlet, and a time step of each.
pub(super) struct Lines {
    lines: [Line; 3],
    decays: [Decay; 3],
    step_s: f64,
    steps: [LineStep; 3],
}

impl Lines {
    /// Makes the lines that may be in place of `outlet`, with steps of `step_s`.
    pub(super) fn new(outlet: &Line, step_s: f64) -> Self {
        let lines = COMPLIANCES
            .map(|factor| Line { compliance_ml_kpa: factor * outlet.compliance_ml_kpa, ..*outlet });
        let decays = lines.map(|line| Decay::new(&line));
        Self { lines, decays, step_s, steps: lines.map(|line| LineStep::new(&line, step_s)) }
    }

    /// Returns the lines with steps of another length.
    pub(super) fn with_steps_of(&self, step_s: f64) -> Self {
        let is_same = (step_s - self.step_s).abs() <= 1e-9 * self.step_s;
        let steps = if is_same { self.steps } else { self.lines.map(|line| LineStep::new(&line, step_s)) };
        Self { step_s, steps, ..*self }
    }

    /// Returns the states of lines that have carried this flow for long.
    pub(super) fn steady(&self, flow_ml_s: f64) -> States {
        self.lines
            .map(|line| LineState { above_reservoir_kpa: line.resistance_kpa_s_ml * flow_ml_s, flow_ml_s })
    }

    /// Follows the lines through a motion from `from_s` to `to_s`, in equal steps no longer than these, 128 at
    /// most. `left_over`, if there is one, takes note of each step.
    pub(super) fn run(
        &self,
        volume_ml: impl Fn(f64) -> f64,
        (from_s, to_s): (f64, f64),
        states: &mut States,
        mut left_over: Option<&mut LeftOver>,
    ) {
        let span_s = to_s - from_s;
        if span_s <= 0.0 {
            return;
        }
        let count = ceil(span_s / self.step_s - 1e-6).clamp(1.0, 128.0);
        let each_s = span_s / count;
        let lines = self.with_steps_of(each_s);
        let mut before_ml = volume_ml(from_s);
        for number in 1..=count as u32 {
            let after_ml = volume_ml(from_s + f64::from(number) * each_s);
            let flow_ml_s = (after_ml - before_ml) / each_s;
            for (state, step) in states.iter_mut().zip(&lines.steps) {
                *state = step.after(*state, flow_ml_s);
            }
            if let Some(left_over) = left_over.as_deref_mut() {
                left_over.note(after_ml, states, &self.lines);
            }
            before_ml = after_ml;
        }
    }

    /// Returns the ways to rest from these states.
    pub(super) fn ring_down(&self, states: &States) -> impl Iterator<Item = RingDown> {
        self.decays.iter().zip(states).map(|(decay, state)| RingDown::new(decay, *state))
    }

    /// Returns states with `volume_ml` more in each line.
    pub(super) fn with_volume(&self, states: &States, volume_ml: f64) -> States {
        let mut fuller = *states;
        for (state, line) in fuller.iter_mut().zip(&self.lines) {
            state.above_reservoir_kpa += volume_ml / line.compliance_ml_kpa;
        }
        fuller
    }
}

/// Returns the volume at the rollers since angle 0, mL, at each time of a motion.
pub(super) fn of_motion<'a>(curve: &'a FlowCurve, profile: &'a Profile) -> impl Fn(f64) -> f64 + 'a {
    |t_s| curve.volume_ml(profile.leg_at(t_s).angle_at(t_s))
}

/// Returns the volume at the rollers since angle 0, mL, at each time of a leg.
pub(super) fn of_leg(curve: &FlowCurve, leg: Leg) -> impl Fn(f64) -> f64 + '_ {
    move |t_s| curve.volume_ml(leg.angle_at(t_s))
}
