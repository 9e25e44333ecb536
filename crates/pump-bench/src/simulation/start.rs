//! The states of the lines from which a run in the steady state starts.

use pump_model::circuit::{Loss, Lumped};
use pump_model::{ExactRun, Leg, LineState, ModelError, Port, PortRun, Pump};

use super::waveform::Method;

/// Tolerance of the integrator on the way from angle 0 to that of the start.
const TOLERANCE: f64 = 1e-8;

impl Method {
    /// Returns the states of the lines of inlet and outlet in the periodic steady state at a constant speed in rad/s,
    /// when the rotor stands at `angle_rad`.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a speed that the model refuses, of an integration that fails, or of a model that
    /// starts from rest alone.
    pub fn periodic_states(
        &self,
        pump: &Pump,
        speed_rad_s: f64,
        angle_rad: f64,
    ) -> Result<[LineState; 2], ModelError> {
        // A periodic state is known where a pitch begins. The rotor turns from there to its angle.
        let pitch_rad = pump.pitch_rad();
        let turned_rad = (angle_rad * speed_rad_s.signum()).rem_euclid(pitch_rad);
        let turned_s = turned_rad / speed_rad_s.abs();
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let exact = |port| -> Result<LineState, ModelError> {
            let state = pump.periodic_state(port, speed_rad_s)?;
            Ok(ExactRun::new(pump, port, legs, state).at(turned_s))
        };
        let integrated = |port, loss: Loss| -> Result<LineState, ModelError> {
            let model = Lumped::new(pump.line(port), loss, port);
            let [above_reservoir_kpa, flow_ml_s] = pump.periodic_line::<2>(port, model, speed_rad_s)?.state;
            let state = LineState { above_reservoir_kpa, flow_ml_s };
            let mut run = PortRun::<_, 2, _>::resisted(pump, loss, port, legs, state, TOLERANCE)?;
            Ok(run.run_to(turned_s)?)
        };
        match self {
            Self::Rodas5p(integration) if integration.roller_centric.is_some() => {
                Err(ModelError::StartsFromRest)
            }
            Self::Rodas5p(integration) if integration.frictions != [None; 2] => {
                let [inlet, outlet] = integration.losses(pump);
                Ok([integrated(Port::Inlet, inlet)?, integrated(Port::Outlet, outlet)?])
            }
            Self::Exact | Self::Rodas5p(_) | Self::Radau { .. } => {
                Ok([exact(Port::Inlet)?, exact(Port::Outlet)?])
            }
        }
    }
}
