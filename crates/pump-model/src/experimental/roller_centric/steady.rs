//! Periodic steady state of the roller-centric model.

use crate::circuit::Loss;
use crate::circuit::lumped::flow_scale_ml_s;
use crate::circuit::periodic::{TOLERANCE, repeated};
use crate::error::ModelError;
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;
use crate::pump::steady_state::{SteadyState, moving};

use super::chambers::{INLET_KPA, INLET_ML_S, OUTLET_KPA, OUTLET_ML_S};
use super::parameters::RollerCentric;
use super::run::RollerRun;
use super::tally::Tally;

impl RollerCentric {
    /// Returns the periodic steady state at `speed_rad_s`, which must not be zero; negative in reverse.
    ///
    /// The model is integrated from rest, pitch by pitch, until pressures and the volume in the pump change
    /// by no more than 1e-5 kPa. The ripple is that of the flow out of the pump
    /// ([`crate::RollerSample::outlet_ml_s`]).
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite, and everything that [`RollerRun::new`] refuses. Returns
    /// [`ModelError::NotPeriodic`] after 2,000 pitches without a steady state.
    pub fn steady_state(&self, pump: &Pump, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        self.resisted_steady_state(pump, [pump.inlet(), pump.outlet()].map(Loss::of), speed_rad_s)
    }

    /// Returns the periodic steady state with a resistance of each line, inlet first, in place of R.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::steady_state`] does.
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
        // Pitches end away from all edges, where joins and cuts do not depend on rounding.
        let start_s = run.first_middle_s();
        run.run_to(start_s)?;
        let (inlet, outlet, volume_ml) = repeated(|number| {
            let before_ml = run.delivered_ml();
            let mut inlet = Tally::new(inlet_line, Port::Inlet);
            let mut outlet = Tally::new(outlet_line, Port::Outlet);
            while let Some(step) = run.step(start_s + f64::from(number) * period_s)? {
                inlet.add(step.length_s(), &step.polynomial(INLET_KPA), &step.polynomial(INLET_ML_S));
                outlet.add(step.length_s(), &step.polynomial(OUTLET_KPA), &step.polynomial(OUTLET_ML_S));
            }
            let end = run.state();
            let ends_kpa = [
                end[INLET_KPA],
                end[INLET_ML_S] / flow_scale_ml_s(inlet_line),
                end[OUTLET_KPA],
                end[OUTLET_ML_S] / flow_scale_ml_s(outlet_line),
                run.stored_ml() / inlet_line.compliance_ml_kpa.min(outlet_line.compliance_ml_kpa),
            ];
            Ok(((inlet, outlet, run.delivered_ml() - before_ml), ends_kpa))
        })?;
        let mean_flow_ml_s = volume_ml / period_s;
        Ok(SteadyState {
            inlet: inlet.pressure.range().above(self.ambient_kpa),
            inlet_mean_kpa: self.ambient_kpa + inlet.pressure.mean_kpa(),
            outlet: outlet.pressure.range().above(self.ambient_kpa),
            outlet_mean_kpa: self.ambient_kpa + outlet.pressure.mean_kpa(),
            mean_flow_ml_s,
            ripple: outlet.ripple(mean_flow_ml_s),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::port_run::PortRun;
    use crate::units::rad_s;

    #[test]
    fn the_tally_has_the_ripple_of_the_curve() {
        let pump = Pump::three_roller();
        let speed_rad_s = rad_s(60.0);
        let (port, period_s) = (Port::Outlet, pump.pitch_rad() / speed_rad_s);
        let legs = [Leg::constant_speed(0.0, speed_rad_s)];
        let start = pump.periodic_state(port, speed_rad_s).unwrap();
        let mut run = PortRun::<_, 2>::new(&pump, port, legs, start, TOLERANCE).unwrap();
        let mut tally = Tally::new(pump.outlet(), port);
        while let Some(step) = run.step(period_s).unwrap() {
            tally.add(step.length_s, &step.polynomial(0), &step.polynomial(1));
        }
        let mean_ml_s = pump.average_flow_ml_s(speed_rad_s);
        let (found, exact) = (tally.ripple(mean_ml_s), pump.outlet_curve().ripple());
        assert!((found.peak_to_peak / exact.peak_to_peak - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
        assert!((found.rms / exact.rms - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    }
}
