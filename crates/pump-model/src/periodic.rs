//! The periodic steady state of what has no closed form: integrated until a pitch repeats the one before.

use crate::circuit::Loss;
use crate::error::ModelError;
use crate::extremes::Extremes;
use crate::flow_curve::Port;
use crate::integrator::IntegrationError;
use crate::line::Line;
use crate::math::sqrt;
use crate::motion::Leg;
use crate::polynomial::Polynomial;
use crate::port_run::PortRun;
use crate::pump::Pump;
use crate::ripple::{Ripple, square_integral};
use crate::steady::SteadyState;

/// Pitches after which the search gives up.
pub(crate) const MOST_PITCHES: u32 = 2000;

/// How near to its limit the state at the end of a pitch must come, kPa.
const NEAR_KPA: f64 = 1e-5;

/// Pitches that are compared with as many before: a line that swings makes some changes small by chance.
const WINDOW: usize = 4;

/// Error allowed in a step, well below [`NEAR_KPA`].
pub(crate) const TOLERANCE: f64 = 1e-8;

/// What one port does over a pitch, tallied step by step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tally {
    /// s C, mL/kPa, s = 1 at the outlet and -1 at the inlet.
    compliance_ml_kpa: f64,
    time_s: f64,
    pressure: Extremes,
    pressure_kpa_s: f64,
    /// At the rollers.
    least_ml_s: f64,
    most_ml_s: f64,
    square_ml2_s: f64,
}

impl Tally {
    pub(crate) fn new(line: &Line, port: Port) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            compliance_ml_kpa: sign * line.compliance_ml_kpa,
            time_s: 0.0,
            pressure: Extremes { min_kpa: f64::INFINITY, max_kpa: f64::NEG_INFINITY },
            pressure_kpa_s: 0.0,
            least_ml_s: f64::INFINITY,
            most_ml_s: f64::NEG_INFINITY,
            square_ml2_s: 0.0,
        }
    }

    /// Adds a step of `length_s`: pressure, kPa, and the line's flow, mL/s, over the part of it from 0 to 1.
    pub(crate) fn add(&mut self, length_s: f64, pressure: &Polynomial, flow: &Polynomial) {
        let ((_, low), (_, high)) = pressure.range_in(0.0, 1.0);
        self.pressure.cover(low);
        self.pressure.cover(high);
        // s C dP/dt = Q - Q_L, so the flow at the rollers is a polynomial too.
        let at_rollers = flow.plus(&pressure.derivative().scaled(self.compliance_ml_kpa / length_s));
        let ((_, low), (_, high)) = at_rollers.range_in(0.0, 1.0);
        self.least_ml_s = self.least_ml_s.min(low);
        self.most_ml_s = self.most_ml_s.max(high);
        self.time_s += length_s;
        self.pressure_kpa_s += length_s * integral(pressure);
        self.square_ml2_s += length_s * square_integral(|x| at_rollers.at(x), 1.0);
    }

    /// Range of the pressure, kPa.
    pub(crate) fn pressure(&self) -> Extremes {
        self.pressure
    }

    /// Mean pressure, kPa.
    pub(crate) fn mean_kpa(&self) -> f64 {
        self.pressure_kpa_s / self.time_s
    }

    /// Ripple of the flow at the rollers, whose mean is that of the line, mL/s.
    pub(crate) fn ripple(&self, mean_ml_s: f64) -> Ripple {
        let mean = mean_ml_s.abs();
        Ripple {
            peak_to_peak: (self.most_ml_s - self.least_ml_s) / mean,
            rms: sqrt((self.square_ml2_s / self.time_s - mean * mean).max(0.0)) / mean,
        }
    }
}

/// Integral over [0, 1].
fn integral(polynomial: &Polynomial) -> f64 {
    polynomial.c.iter().zip(1..).map(|(c, n)| c / f64::from(n)).sum()
}

/// What a pitch was and the state at its end, every part of it in kPa.
pub(crate) type Turned<T, const K: usize> = Result<(T, [f64; K]), IntegrationError>;

/// The first of the pitches that repeats those before to within [`NEAR_KPA`]: `turn` makes the pitch of that number, from 1 on.
///
/// With w the largest change of the last four pitches and r how much smaller it is than that of the four before, all changes to
/// come are 4 w r/(1 - r) at most, as long as they go on like that.
pub(crate) fn repeated<T, const K: usize>(
    mut turn: impl FnMut(u32) -> Turned<T, K>,
) -> Result<T, ModelError> {
    let mut changes = [f64::INFINITY; 2 * WINDOW];
    let mut before: Option<[f64; K]> = None;
    for number in 1..=MOST_PITCHES {
        let (tally, end) = turn(number)?;
        let change = before.map_or(f64::INFINITY, |before| {
            end.iter().zip(before).fold(0.0_f64, |largest, (now, then)| largest.max((now - then).abs()))
        });
        before = Some(end);
        changes.rotate_right(1);
        changes[0] = change;
        let largest = |changes: &[f64]| changes.iter().copied().fold(0.0, f64::max);
        let (last, earlier) = changes.split_at(WINDOW);
        let (last, earlier) = (largest(last), largest(earlier));
        // Until there are so many changes, nothing is known of how they fall.
        let falling = earlier.is_finite() && last < earlier;
        let left_kpa = if falling { WINDOW as f64 * last * last / (earlier - last) } else { f64::INFINITY };
        // Below a hundredth of what is asked the changes are those of rounding.
        if left_kpa <= NEAR_KPA || last <= 0.01 * NEAR_KPA {
            return Ok(tally);
        }
    }
    Err(ModelError::NotPeriodic { pitches: MOST_PITCHES, change_kpa: changes[0] })
}

/// Refuses a speed at which nothing repeats itself.
pub(crate) fn moving(speed_rad_s: f64) -> Result<(), ModelError> {
    if speed_rad_s.is_finite() && speed_rad_s != 0.0 {
        return Ok(());
    }
    let (parameter, allowed) = ("speed in rad/s", "a finite speed other than zero");
    Err(ModelError::OutOfRange { parameter, value: speed_rad_s, allowed })
}

impl Pump {
    /// As [`Self::steady_state`], with what inlet and outlet line resist in place of their R: integrated from rest, pitch by
    /// pitch, until nothing changes by more than 1e-5 kPa. An error after 2,000 pitches.
    pub fn resisted_steady_state(
        &self,
        [inlet, outlet]: [Loss; 2],
        speed_rad_s: f64,
    ) -> Result<SteadyState, ModelError> {
        moving(speed_rad_s)?;
        let inlet = self.repeated_port(Port::Inlet, inlet, speed_rad_s)?;
        let outlet = self.repeated_port(Port::Outlet, outlet, speed_rad_s)?;
        let [inlet_kpa, outlet_kpa] = [self.inlet(), self.outlet()].map(|line| line.reservoir_kpa);
        Ok(SteadyState {
            inlet: inlet.pressure().above(inlet_kpa),
            inlet_mean_kpa: inlet_kpa + inlet.mean_kpa(),
            outlet: outlet.pressure().above(outlet_kpa),
            outlet_mean_kpa: outlet_kpa + outlet.mean_kpa(),
            mean_flow_ml_s: self.average_flow_ml_s(speed_rad_s),
            ripple: self.outlet_curve().ripple(),
        })
    }

    fn repeated_port(&self, port: Port, loss: Loss, speed_rad_s: f64) -> Result<Tally, ModelError> {
        let (line, period_s) = (self.line(port), self.pitch_rad() / speed_rad_s.abs());
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let mut run = PortRun::<_, 2, _>::resisted(self, loss, port, legs, nalgebra::zero(), TOLERANCE)?;
        repeated(|number| {
            let mut tally = Tally::new(line, port);
            while let Some(step) = run.step(f64::from(number) * period_s)? {
                tally.add(step.length_s, &step.polynomial(0), &step.polynomial(1));
            }
            let end = run.state();
            Ok((tally, [end[0], end[1] / line.flow_scale_ml_s()]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rad_s;

    #[test]
    fn integrating_to_periodicity_finds_the_closed_form() {
        for (rollers, rpm) in [(3, 100.0), (2, -150.0), (3, 5.0), (3, 600.0)] {
            let pump = Pump::preset(rollers, crate::Variant::Measured).unwrap();
            let linear = [pump.inlet(), pump.outlet()].map(Loss::of);
            let exact = pump.steady_state(rad_s(rpm)).unwrap();
            let found = pump.resisted_steady_state(linear, rad_s(rpm)).unwrap();
            for (found, exact) in [
                (found.inlet.min_kpa, exact.inlet.min_kpa),
                (found.inlet.max_kpa, exact.inlet.max_kpa),
                (found.inlet_mean_kpa, exact.inlet_mean_kpa),
                (found.outlet.min_kpa, exact.outlet.min_kpa),
                (found.outlet.max_kpa, exact.outlet.max_kpa),
                (found.outlet_mean_kpa, exact.outlet_mean_kpa),
            ] {
                assert!((found - exact).abs() < 2e-5, "{rollers} rollers, {rpm} r/min: {found} for {exact}");
            }
        }
    }

    #[test]
    fn a_line_that_nothing_damps_is_refused_after_a_bounded_search() {
        let line = Line { resistance_kpa_s_ml: 0.0, ..Line::PUBLISHED };
        let measured = Pump::three_roller();
        let pump = Pump::new(*measured.geometry(), *measured.roller_volume(), line, line).unwrap();
        let found = pump.resisted_steady_state([Loss::of(&line); 2], rad_s(100.0));
        assert!(matches!(found, Err(ModelError::NotPeriodic { .. })), "{found:?}");
    }

    #[test]
    fn the_tally_has_the_ripple_of_the_curve() {
        let pump = Pump::three_roller();
        let speed_rad_s = rad_s(60.0);
        let tally = pump.repeated_port(Port::Outlet, Loss::of(pump.outlet()), speed_rad_s).unwrap();
        let mean_ml_s = pump.average_flow_ml_s(speed_rad_s);
        let (found, exact) = (tally.ripple(mean_ml_s), pump.outlet_curve().ripple());
        assert!((found.peak_to_peak / exact.peak_to_peak - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
        assert!((found.rms / exact.rms - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    }
}
