//! The periodic steady state of models without a closed form, integrated until a pitch repeats the one
//! before.

use crate::error::{IntegrationError, ModelError};
use crate::line::extremes::Extremes;
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;
use crate::pump::steady_state::{SteadyState, moving};

use super::line_model::LineModel;
use super::line_run::LineRun;
use super::lumped::Lumped;
use super::resistance::Loss;
use super::tally::PressureTally;

/// Number of pitches after which the search gives up.
pub(crate) const MOST_PITCHES: u32 = 2000;

/// Largest distance from its limit that the state at the end of a pitch may have, kPa.
const NEAR_KPA: f64 = 1e-5;

/// Number of pitches that are compared with as many before. A line that swings makes some changes small by
/// chance.
const WINDOW: usize = 4;

/// Tolerance of a step, well below [`NEAR_KPA`].
pub(crate) const TOLERANCE: f64 = 1e-8;

/// Tally of a pitch, and the state at its end with every part in kPa.
pub(crate) type Turned<T, const K: usize> = Result<(T, [f64; K]), IntegrationError>;

/// Returns the tally of the first pitch that repeats those before to within [`NEAR_KPA`]. `turn` makes the
/// pitch of a given number, from 1 on.
///
/// Let w be the largest change of the last four pitches, and r the ratio of w to the largest change of the
/// four before. While changes go on like that, all changes to come add up to at most 4 w r/(1 - r).
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
        // The fall of the changes is unknown until all eight exist.
        let falling = earlier.is_finite() && last < earlier;
        let left_kpa = if falling { WINDOW as f64 * last * last / (earlier - last) } else { f64::INFINITY };
        // Changes below a hundredth of the limit are rounding.
        if left_kpa <= NEAR_KPA || last <= 0.01 * NEAR_KPA {
            return Ok(tally);
        }
    }
    Err(ModelError::NotPeriodic { pitches: MOST_PITCHES, change_kpa: changes[0] })
}

/// Periodic state of a line at constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PeriodicLine<const N: usize> {
    /// State at angle 0, where a pitch ends and the next begins.
    pub state: [f64; N],
    /// Range of the pressure at the rollers, kPa absolute.
    pub pressure: Extremes,
    /// Mean pressure at the rollers, kPa absolute.
    pub mean_kpa: f64,
}

impl Pump {
    /// Returns the periodic steady state with a resistance of each line, inlet first, in place of R.
    ///
    /// The model is integrated from rest, pitch by pitch, until nothing changes by more than 1e-5 kPa.
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite. Returns [`ModelError::NotPeriodic`] after 2,000 pitches
    /// without a steady state, and passes on the errors of the integrator.
    pub fn resisted_steady_state(
        &self,
        [inlet, outlet]: [Loss; 2],
        speed_rad_s: f64,
    ) -> Result<SteadyState, ModelError> {
        let port =
            |port, loss| self.periodic_line::<2>(port, Lumped::new(self.line(port), loss, port), speed_rad_s);
        let (inlet, outlet) = (port(Port::Inlet, inlet)?, port(Port::Outlet, outlet)?);
        Ok(SteadyState {
            inlet: inlet.pressure,
            inlet_mean_kpa: inlet.mean_kpa,
            outlet: outlet.pressure,
            outlet_mean_kpa: outlet.mean_kpa,
            mean_flow_ml_s: self.average_flow_ml_s(speed_rad_s),
            ripple: self.outlet_curve().ripple(),
        })
    }

    /// Returns the periodic state of a model of the line at a port. The model stands in place of the pump's
    /// line; only the reservoir's pressure stays.
    ///
    /// The model is integrated from rest, pitch by pitch, until no state changes by more than 1e-5 of its
    /// [scale](LineModel::scale). [Totals](LineModel::totals) need not repeat.
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite. Returns [`ModelError::NotPeriodic`] after 2,000 pitches
    /// without a steady state, and passes on the errors of the integrator.
    pub fn periodic_line<const N: usize>(
        &self,
        port: Port,
        model: impl LineModel<N>,
        speed_rad_s: f64,
    ) -> Result<PeriodicLine<N>, ModelError> {
        moving(speed_rad_s)?;
        let period_s = self.pitch_rad() / speed_rad_s.abs();
        let reservoir_kpa = self.line(port).reservoir_kpa;
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let (scale, totals) = (model.scale(), model.totals());
        let is_linear = model.is_linear();
        let run = LineRun::new(self, port, model, legs, [0.0; N], TOLERANCE)?;
        let mut run = if is_linear { run.with_radau()? } else { run };
        let (tally, state) = repeated(|number| {
            let mut tally = PressureTally::EMPTY;
            while let Some(step) = run.step(f64::from(number) * period_s)? {
                tally.add(step.length_s, &step.polynomial(0));
            }
            let end = run.state();
            let in_kpa = |n: usize| if totals[n] { 0.0 } else { end[n] / scale[n] };
            Ok(((tally, end), core::array::from_fn::<_, N, _>(in_kpa)))
        })?;
        Ok(PeriodicLine {
            state,
            pressure: tally.range().above(reservoir_kpa),
            mean_kpa: reservoir_kpa + tally.mean_kpa(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::line::Line;
    use crate::units::rad_s;

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
}
