//! A pump at a duty: its speed, its lines and its steady state.

use pump_model::units::{rad_s, rpm};
use pump_model::{Port, Pump, SteadyState};

use crate::pump_file::PumpFile;
use crate::simulation::{AskedMethod, Method, choose_method};

use super::duty::Duty;
use super::error::SizingError;
use super::line::SizedLine;

/// Part by which the resistance may change up to twice the mean flow for a line that counts as linear.
const LINEAR: f64 = 0.01;

/// A pump at a duty.
#[derive(Debug, Clone)]
pub(super) struct Operating {
    pub(super) file: PumpFile,
    pub(super) pump: Pump,
    pub(super) speed_rad_s: f64,
    pub(super) inlet: SizedLine,
    pub(super) outlet: SizedLine,
}

/// The mean pressures of a pump file at a duty, before a pump is made of it.
pub(super) fn lines(file: &PumpFile, flow_ml_s: f64) -> Result<[SizedLine; 2], SizingError> {
    Ok([SizedLine::of(file, Port::Inlet, flow_ml_s)?, SizedLine::of(file, Port::Outlet, flow_ml_s)?])
}

impl Operating {
    /// Returns the pump of a file that has the duty's lines already.
    pub(super) fn of(file: PumpFile, duty: &Duty) -> Result<Self, SizingError> {
        let [inlet, outlet] = lines(&file, duty.flow_ml_s)?;
        let pump = file.speed_dependent_pump()?;
        let speed_rad_s = pump.speed_for_flow(duty.flow_ml_s)?;
        let pump = pump.at(speed_rad_s)?;
        Ok(Self { file, pump, speed_rad_s, inlet, outlet })
    }

    /// Refuses a speed beyond the motor's.
    pub(super) fn check_speed(&self, flow_ml_s: f64) -> Result<(), SizingError> {
        let (needed_rpm, most_rpm) = (rpm(self.speed_rad_s), self.file.motor.max_speed_rpm);
        if needed_rpm <= most_rpm * (1.0 + 1e-12) {
            return Ok(());
        }
        Err(SizingError::Speed {
            pump: self.file.pump.id.clone(),
            flow_ml_s,
            needed_rpm,
            least_rpm: 0.0,
            most_rpm,
            most_ml_s: self.pump.average_flow_ml_s(rad_s(most_rpm)),
        })
    }

    /// Returns the method of the steady state: the closed form where the resistances are those of the mean flow within
    /// 1 % up to twice that flow, and the integrator with the friction at every flow elsewhere.
    pub(super) fn method(&self, flow_ml_s: f64) -> Result<Method, SizingError> {
        let frictions = self.file.frictions()?;
        let bends = frictions.iter().flatten().any(|friction| {
            let [once, twice] = [flow_ml_s, 2.0 * flow_ml_s].map(|flow| friction.resistance_kpa_s_ml(flow));
            (twice / once - 1.0).abs() > LINEAR
        });
        let frictions = if bends { frictions } else { [None; 2] };
        let method = choose_method(AskedMethod::Auto, None, frictions, None);
        Ok(method.unwrap_or_else(|error| unreachable!("a method is chosen for any lines: {error}")))
    }

    /// Returns the periodic steady state at the duty's flow.
    pub(super) fn steady(&self, flow_ml_s: f64) -> Result<SteadyState, SizingError> {
        Ok(self.method(flow_ml_s)?.steady_state(&self.pump, self.speed_rad_s)?)
    }
}
