//! The exact solution of one port with its derivatives.

use crate::line::exact_run::next_stretch;
use crate::line::line::Line;
use crate::line::oscillator::Oscillator;
use crate::motion::leg::Leg;
use crate::motion::stretches::{Stretch, Stretches};
use crate::port::Port;
use crate::pump::pump::Pump;

use super::augmented::{ANGLE, Augmented, Flows, augmented, physical};
use super::propagator::SensitivePropagator;
use super::short_steps::{ShortSteps, is_short};
use super::state::SensitiveState;

/// The exact solution of one port of the flow-centric model with its derivatives by R, C, L, the angle and the
/// roller volume, over any motion in legs of constant acceleration.
///
/// The derivatives are exact as the solution is ([`crate::ExactRun`]): they solve the same equations, with the
/// derivatives of the coefficients as forcing. A shift of the angle moves the edges of the flow. Where the flow
/// jumps at an edge, the derivative of the pressure by the angle jumps by the flow's jump over C. If the rollers
/// start on such an edge, it is the derivative toward the direction of the motion.
///
/// ```
/// use pump_model::{Leg, Port, Pump, SensitiveRun, SensitiveState, SensitivityParameter};
///
/// let pump = Pump::three_roller();
/// let legs = [Leg::constant_speed(0.3, 10.0)];
/// let mut run = SensitiveRun::new(&pump, Port::Outlet, legs, SensitiveState::AT_REST);
/// let at = run.at(0.1);
/// // 1 % more compliance raises the pressure there by 0.1 kPa.
/// let by_compliance = at.pressure_by[SensitivityParameter::Compliance.index()];
/// let change_kpa = 0.01 * pump.outlet().compliance_ml_kpa * by_compliance;
/// assert!((change_kpa - 0.099).abs() < 0.001, "{change_kpa}");
/// ```
#[derive(Debug, Clone)]
pub struct SensitiveRun<'a, M> {
    pub(super) line: &'a Line,
    pub(super) oscillator: Oscillator,
    short_steps: ShortSteps,
    stretches: Stretches<'a, M>,
    pub(super) stretch: Stretch,
    /// Flow between pulses, mL/rad, and volume of a roller, mL.
    pulses: (f64, f64),
    /// Flows over time since the stretch's start.
    pub(super) flows: Flows,
    /// Time reached since the stretch's start, s, and the state there.
    pub(super) reached_s: f64,
    pub(super) state: Augmented,
}

impl<'a, M: Iterator<Item = Leg>> SensitiveRun<'a, M> {
    /// Starts in `start` when the first of the `legs` starts. After the last leg the rotor rests.
    pub fn new(
        pump: &'a Pump,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        start: SensitiveState,
    ) -> Self {
        Self::on(pump, pump.line(port), port, legs, start)
    }

    /// Starts as [`Self::new`] does on any line that the rollers of `pump` drive.
    pub(crate) fn on(
        pump: &'a Pump,
        line: &'a Line,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        start: SensitiveState,
    ) -> Self {
        let oscillator = Oscillator::new(line, port);
        let mut stretches = Stretches::new(pump.curve(port), legs);
        let stretch = next_stretch(&mut stretches);
        let pulses = (pump.nominal_ml_rad(), pump.roller_volume().total_ml());
        let flows = Flows::of(&stretch, pulses.0, pulses.1);
        let state = augmented(line, &oscillator, &start);
        let short_steps = ShortSteps::new(&oscillator);
        Self { line, oscillator, short_steps, stretches, stretch, pulses, flows, reached_s: 0.0, state }
    }

    /// Returns the time reached, s.
    pub fn time_s(&self) -> f64 {
        self.stretch.start_s + self.reached_s
    }

    /// Returns the state reached.
    pub fn state(&self) -> SensitiveState {
        physical(self.line, &self.oscillator, &self.state)
    }

    /// Returns the flow at the rollers per radian at the time reached, mL/rad. At an edge it is that of the side on
    /// which the state is.
    pub fn flow_ml_rad(&self) -> f64 {
        self.stretch.flow_ml_rad(self.time_s())
    }

    /// Goes on to `t_s` and returns the state there. A time in the past gives the state reached.
    pub fn at(&mut self, t_s: f64) -> SensitiveState {
        self.go_to(t_s);
        self.state()
    }

    /// Goes on to `t_s` as [`Self::at`] does, and asks at each edge on the way whether to go on. Returns none if
    /// it stopped there.
    #[cfg(feature = "identification")]
    pub(crate) fn at_while(&mut self, t_s: f64, goes_on: &impl Fn() -> bool) -> Option<SensitiveState> {
        while t_s > self.stretch.end_s {
            self.finish_stretch();
            if !goes_on() {
                return None;
            }
        }
        Some(self.at(t_s))
    }

    /// Returns the rate of change of the pressure at the time reached, kPa/s.
    #[cfg(feature = "identification")]
    pub(crate) fn pressure_rate_kpa_s(&self) -> f64 {
        let [rate, _] = self.oscillator.derivative(self.state[0], self.flows.line.at(self.reached_s));
        rate
    }

    /// Goes on to `t_s`.
    pub(super) fn go_to(&mut self, t_s: f64) {
        while t_s > self.stretch.end_s {
            self.finish_stretch();
        }
        self.go_on(t_s - self.time_s());
    }

    /// Goes on inside the stretch.
    fn go_on(&mut self, length_s: f64) {
        if length_s > 0.0 {
            let flows = self.flows.shifted(self.reached_s);
            self.state = if is_short(&self.oscillator, length_s) {
                self.short_steps.after(&self.oscillator, length_s, &self.state, &flows)
            } else {
                SensitivePropagator::new(&self.oscillator, length_s, flows.line.degree)
                    .apply(&self.state, &flows)
            };
            self.reached_s += length_s;
        }
    }

    /// Goes on to the end of the stretch and into the next.
    ///
    /// Rollers that stand a little farther on pass the edge a little earlier. The flow after the edge then stands in
    /// place of the flow before it, for as long as the rollers turn by that little.
    fn finish_stretch(&mut self) {
        let edge_s = self.stretch.end_s;
        self.go_on(edge_s - self.time_s());
        let before_ml_rad = self.stretch.flow_ml_rad(edge_s);
        self.stretch = next_stretch(&mut self.stretches);
        let jump_ml_rad = self.stretch.flow_ml_rad(edge_s) - before_ml_rad;
        self.state[ANGLE][0] += self.oscillator.rate * self.oscillator.impedance * jump_ml_rad;
        self.flows = Flows::of(&self.stretch, self.pulses.0, self.pulses.1);
        self.reached_s = 0.0;
    }
}
