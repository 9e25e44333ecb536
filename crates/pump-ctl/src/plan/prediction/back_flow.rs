//! The volume that the line takes back from the vessel during a dose and after it.

use pump_model::{BackFlow, Port, Pump, VesselRun};

use super::shortened_motion::ShortenedMotion;
use crate::plan::Plan;
use crate::plan::words::PlanError;
use crate::step::Direction;

impl Plan {
    /// Returns the volume that the outlet's line takes back from the vessel, exactly, for the smooth motion
    /// through the steps. In reverse the volume that it gives back counts.
    ///
    /// If the start angle is not known exactly, each volume is the largest of all angles at which the rollers
    /// may stand, looked at a sixteenth of a pitch apart.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Ramps, Request};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let request = Request::new(1.0, Cruise::Flow { ml_s: 5.0 });
    /// let fastest = doser.plan(Phase::known(1.9), &request.with_ramps(Ramps::Fastest))?;
    /// // The rollers stop in 3 ms, and the line swings on.
    /// let back_flow = fastest.back_flow(&pump)?;
    /// assert!(back_flow.backflow_ml > 0.02 && back_flow.reverse_flow_ml > back_flow.backflow_ml);
    /// // Line-aware ramps leave the line nearly at rest.
    /// assert!(doser.plan(Phase::known(1.9), &request)?.back_flow(&pump)?.backflow_ml < 0.003);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::Model`] if the line does not come to rest within an hour.
    pub fn back_flow(&self, pump: &Pump) -> Result<BackFlow, PlanError> {
        let mut worst = BackFlow::default();
        for off_rad in self.start.beside(pump.pitch_rad()) {
            let motion = ShortenedMotion::new(self, pump, off_rad);
            worst = worst.worst(motion.back_flow(pump, self.direction() == Direction::Forward)?);
        }
        Ok(worst)
    }
}

impl ShortenedMotion {
    /// Returns the volume that the outlet's line takes back during the whole motion and after it.
    fn back_flow(&self, pump: &Pump, is_forward: bool) -> Result<BackFlow, PlanError> {
        let mut vessel = VesselRun::new(self.run(pump, Port::Outlet), is_forward);
        // The pitches that were left out repeat the last before the motor slows down.
        let left_out_ml = match self.last_pitch_s() {
            Some((start_s, end_s)) => {
                vessel.go_to(start_s);
                let before_ml = vessel.reverse_flow_ml();
                vessel.go_to(end_s);
                self.surplus() * (vessel.reverse_flow_ml() - before_ml)
            }
            None => 0.0,
        };
        let kept = vessel.back_flow_to_rest(self.duration_s())?;
        Ok(BackFlow { reverse_flow_ml: kept.reverse_flow_ml + left_out_ml, ..kept })
    }
}
