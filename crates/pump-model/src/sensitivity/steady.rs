//! The periodic state of a line at constant speed with its derivatives.

use crate::error::ModelError;
use crate::line::line::Line;
use crate::line::oscillator::Oscillator;
use crate::line::periodic_state::{periodic_state, repeated};
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;
use crate::pump::steady_state::moving;
use crate::units::wrap;

use super::augmented::{ANGLE, physical};
use super::run::SensitiveRun;
use super::state::SensitiveState;

impl SensitiveState {
    /// Returns the state of a port's line that repeats itself every pitch at `speed_rad_s`, where the rollers stand
    /// at `angle_rad`, with its derivatives.
    ///
    /// A periodic state depends on the parameters too: its derivatives repeat themselves as it does.
    ///
    /// ```
    /// use pump_model::{Port, Pump, SensitiveState};
    ///
    /// let pump = Pump::three_roller();
    /// let steady = SensitiveState::steady(&pump, Port::Outlet, 10.0, 0.4)?;
    /// let later = SensitiveState::steady(&pump, Port::Outlet, 10.0, 0.4 + pump.pitch_rad())?;
    /// assert!((steady.pressure_by[0] - later.pressure_by[0]).abs() < 1e-10);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite, and a resonance that nothing damps.
    pub fn steady(pump: &Pump, port: Port, speed_rad_s: f64, angle_rad: f64) -> Result<Self, ModelError> {
        let line = pump.line(port);
        let turned_rad = wrap(angle_rad * speed_rad_s.signum(), pump.pitch_rad());
        let start = Self::repeated(pump, line, port, speed_rad_s)?;
        let mut run = SensitiveRun::new(pump, port, [Leg::constant_speed(0.0, speed_rad_s)], start);
        Ok(run.at(turned_rad / speed_rad_s.abs()))
    }

    /// Returns the state of [`Self::steady`] where the rollers stand at angle 0, on any line that they drive.
    pub(crate) fn repeated(
        pump: &Pump,
        line: &Line,
        port: Port,
        speed_rad_s: f64,
    ) -> Result<Self, ModelError> {
        moving(speed_rad_s)?;
        let state = periodic_state(line, pump.curve(port), port, speed_rad_s)?;
        let oscillator = Oscillator::new(line, port);
        let period_s = pump.pitch_rad() / speed_rad_s.abs();
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let mut run = SensitiveRun::on(pump, line, port, legs, Self::fixed(state));
        // Rollers that stand a little farther on are where they would be a little later.
        let rate = oscillator.derivative(run.state[0], run.flows.line.at(0.0));
        run.go_to(period_s);
        let resonance = ModelError::UndampedResonance { port, speed_rad_s };
        let mut start = repeated(&oscillator, period_s, run.state).ok_or(resonance)?;
        start[0] = oscillator.balanced(state.numbers());
        start[ANGLE] = rate.map(|x| x / speed_rad_s);
        Ok(physical(line, &oscillator, &start))
    }
}
