//! Which pressures a dose will make, and how long its line needs to settle.

use pump_model::{DEFAULT_TOLERANCE, Extremes, Leg, Port, PortRun, Pump};

use super::{Plan, PlanError};

/// Pressures over a dose, start-up, stop and settling included, from lines at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Range at the inlet, kPa absolute.
    pub inlet: Extremes,
    /// Range at the outlet, kPa absolute.
    pub outlet: Extremes,
    /// Time from the last step until the undelivered volume stays below 1 uL, s.
    pub settle_s: f64,
}

impl Plan {
    /// The motion: ramp, cruise, ramp; then the motor holds.
    pub fn legs(&self) -> [Leg; 3] {
        self.profile.legs(self.start.angle_rad, self.direction())
    }

    /// Predicts pressures and settling of this dose on `pump`, from lines at rest.
    pub fn predict(&self, pump: &Pump) -> Result<Prediction, PlanError> {
        let motion_s = self.profile.duration_s();
        let run = |port| PortRun::<_, 2>::from_rest(pump, port, self.legs(), DEFAULT_TOLERANCE);

        let mut outlet = run(Port::Outlet)?;
        let moving = outlet.extremes(motion_s)?;
        let settle_s = outlet.settling_s()?;
        let end_s = motion_s + settle_s;
        Ok(Prediction {
            inlet: run(Port::Inlet)?.extremes(end_s)?,
            outlet: moving.and(outlet.extremes(end_s)?),
            settle_s,
        })
    }

    /// Time from the last step until the undelivered volume stays below 1 uL, s.
    pub(super) fn settle_s(&self, pump: &Pump) -> Result<f64, PlanError> {
        let mut outlet = PortRun::<_, 2>::from_rest(pump, Port::Outlet, self.legs(), DEFAULT_TOLERANCE)?;
        outlet.run_to(self.profile.duration_s())?;
        Ok(outlet.settling_s()?)
    }
}
