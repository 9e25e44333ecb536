//! The built-in pump, its doses, and pumps that differ from it.

use std::error::Error;
use std::f64::consts::TAU;

use pump_bench::built_in;
use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Plan, Ramps, Request};
use pump_model::{Line, Pump};

/// The built-in pump of three rollers with its motor.
pub(crate) struct Trial {
    pub(crate) pump: Pump,
    doser_limits: Limits,
}

impl Trial {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let file = built_in("three-roller").ok_or("three-roller is built in")?;
        Ok(Self { pump: file.model()?, doser_limits: Limits::new(file.limits().motor) })
    }

    /// Returns `count` start angles, evenly over a pitch, rad.
    pub(crate) fn start_angles(&self, count: u32) -> impl Iterator<Item = f64> + use<> {
        let pitch_rad = self.pump.pitch_rad();
        (0..count).map(move |n| pitch_rad * f64::from(n) / f64::from(count))
    }

    /// Plans a dose from a start angle.
    pub(crate) fn plan(
        &self,
        start_rad: f64,
        volume_ml: f64,
        rate_ml_s: f64,
        ramps: Ramps,
    ) -> Result<Plan, Box<dyn Error>> {
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: rate_ml_s }).with_ramps(ramps);
        Ok(Doser::new(&self.pump, self.doser_limits)?.plan(Phase::known(start_rad), &request)?)
    }

    /// Returns the pump with this factor on the compliance of its outlet line.
    pub(crate) fn with_compliance(&self, factor: f64) -> Result<Pump, Box<dyn Error>> {
        let outlet = *self.pump.outlet();
        let outlet = Line { compliance_ml_kpa: factor * outlet.compliance_ml_kpa, ..outlet };
        Ok(Pump::new(*self.pump.geometry(), *self.pump.roller_volume(), *self.pump.inlet(), outlet)?)
    }

    /// Returns the pump with `more_ml` of roller volume, and a bore that keeps the volume of a revolution.
    pub(crate) fn with_roller_volume(&self, more_ml: f64) -> Result<Pump, Box<dyn Error>> {
        let mut geometry = *self.pump.geometry();
        let roller = self.pump.roller_volume();
        let grown = 1.0 + f64::from(geometry.rollers) * more_ml / (TAU * self.pump.nominal_ml_rad());
        geometry.bore_radius_mm *= grown.sqrt();
        let roller = roller.scaled_to(roller.total_ml() + more_ml)?;
        Ok(Pump::new(geometry, roller, *self.pump.inlet(), *self.pump.outlet())?)
    }

    /// Returns the whole number of steps that one constant, the mean volume of a revolution, gives for a volume.
    pub(crate) fn steps_by_one_constant(&self, volume_ml: f64) -> i64 {
        let step_ml = self.pump.revolution_ml() / self.doser_limits.motor.steps_per_rev;
        (volume_ml / step_ml).round() as i64
    }

    /// Returns the angle of a motor step, rad.
    pub(crate) fn step_rad(&self) -> f64 {
        TAU / self.doser_limits.motor.steps_per_rev
    }
}

/// Returns the volume that a pump delivers over a turn, mL.
pub(crate) fn delivered_ml(pump: &Pump, start_rad: f64, steps: i64, step_rad: f64) -> f64 {
    let curve = pump.outlet_curve();
    curve.volume_ml(start_rad + steps as f64 * step_rad) - curve.volume_ml(start_rad)
}
