//! The periodic steady state of the roller-centric model.

use crate::circuit::Loss;
use crate::error::ModelError;
use crate::flow_curve::Port;
use crate::motion::Leg;
use crate::periodic::{TOLERANCE, Tally, moving, repeated};
use crate::pump::Pump;
use crate::steady::SteadyState;

use super::chambers::{DELIVERED_ML, INLET_KPA, INLET_ML_S, OUTLET_KPA, OUTLET_ML_S};
use super::{RollerCentric, RollerRun};

impl RollerCentric {
    /// Periodic steady state at `speed_rad_s`, which must not be zero; negative in reverse. Integrated from rest, pitch by pitch,
    /// until pressures and what the pump holds change by no more than 1e-5 kPa; an error after 2,000 pitches.
    ///
    /// The ripple is that of the flow out of the pump ([`super::RollerSample::outlet_ml_s`]).
    pub fn steady_state(&self, pump: &Pump, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        self.resisted_steady_state(pump, [pump.inlet(), pump.outlet()].map(Loss::of), speed_rad_s)
    }

    /// As [`Self::steady_state`], with what inlet and outlet line resist in place of their R.
    pub fn resisted_steady_state(
        &self,
        pump: &Pump,
        losses: [Loss; 2],
        speed_rad_s: f64,
    ) -> Result<SteadyState, ModelError> {
        moving(speed_rad_s)?;
        let period_s = pump.pitch_rad() / speed_rad_s.abs();
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let mut run = RollerRun::resisted(pump, *self, losses, legs, TOLERANCE)?;
        let (inlet_line, outlet_line) = (pump.inlet(), pump.outlet());
        // Pitches end away from all edges, where what joins and parts is the same whatever the rounding.
        let start_s = run.first_middle_s();
        run.run_to(start_s)?;
        let (inlet, outlet, volume_ml) = repeated(|number| {
            let before_ml = run.state()[DELIVERED_ML];
            let mut inlet = Tally::new(inlet_line, Port::Inlet);
            let mut outlet = Tally::new(outlet_line, Port::Outlet);
            while let Some(step) = run.step(start_s + f64::from(number) * period_s)? {
                inlet.add(step.length_s, &step.polynomial(INLET_KPA), &step.polynomial(INLET_ML_S));
                outlet.add(step.length_s, &step.polynomial(OUTLET_KPA), &step.polynomial(OUTLET_ML_S));
            }
            let end = run.state();
            let ends_kpa = [
                end[INLET_KPA],
                end[INLET_ML_S] / inlet_line.flow_scale_ml_s(),
                end[OUTLET_KPA],
                end[OUTLET_ML_S] / outlet_line.flow_scale_ml_s(),
                run.stored_ml() / inlet_line.compliance_ml_kpa.min(outlet_line.compliance_ml_kpa),
            ];
            Ok(((inlet, outlet, end[DELIVERED_ML] - before_ml), ends_kpa))
        })?;
        let mean_flow_ml_s = volume_ml / period_s;
        Ok(SteadyState {
            inlet: inlet.pressure().above(self.ambient_kpa),
            inlet_mean_kpa: self.ambient_kpa + inlet.mean_kpa(),
            outlet: outlet.pressure().above(self.ambient_kpa),
            outlet_mean_kpa: self.ambient_kpa + outlet.mean_kpa(),
            mean_flow_ml_s,
            ripple: outlet.ripple(mean_flow_ml_s),
        })
    }
}
