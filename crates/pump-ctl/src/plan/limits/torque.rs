//! The torque that turning the rotor takes.

use pump_model::Pump;

use super::torque_curve::TorqueCurve;
use crate::parameter::Parameter;
use crate::plan::words::{Allowed, PlanError, within};

/// Torque of 1 kPa mL/rad, N m.
const N_M: f64 = 1e-3;

/// The torque that turning takes besides the pressures, and the torque that the motor has.
///
/// All values are those at the pump head, gear included.
///
/// ```
/// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request, Torque, TorqueCurve};
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let curve = TorqueCurve::new(&[(0.0, 1.2), (17.8, 0.9)]).unwrap();
/// let torque = Torque::new(88.637, curve).with_occlusion_n_m(0.4).with_inertia_kg_m2(2e-4);
/// let limits = Limits::new(motor).with_torque(torque);
/// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
/// let plan = Doser::new(&pump, limits)?.plan(Phase::known(0.0), &request)?;
/// let margin = limits.margins(&pump, &plan).torque.unwrap();
/// assert!(margin.reached > 0.4 && margin.used < 1.0);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Torque {
    /// Torque that squeezing the tube takes at any speed, N m, 0 to 1e6.
    pub occlusion_n_m: f64,
    /// Moment of inertia of all turning parts, kg m², 0 to 1e6.
    pub inertia_kg_m2: f64,
    /// Ambient pressure, kPa absolute, 0 to 1e6. The pressures in the tube do work against it.
    pub ambient_kpa: f64,
    /// Torque that the motor has over its speed.
    pub motor: TorqueCurve,
}

impl Torque {
    /// Makes the torque of a rotor that turns without occlusion torque and inertia, at an ambient pressure in
    /// kPa absolute.
    pub const fn new(ambient_kpa: f64, motor: TorqueCurve) -> Self {
        Self { occlusion_n_m: 0.0, inertia_kg_m2: 0.0, ambient_kpa, motor }
    }

    /// Returns the torque with that which squeezing the tube takes, N m.
    #[must_use]
    pub const fn with_occlusion_n_m(self, occlusion_n_m: f64) -> Self {
        Self { occlusion_n_m, ..self }
    }

    /// Returns the torque with the moment of inertia of all turning parts, kg m².
    #[must_use]
    pub const fn with_inertia_kg_m2(self, inertia_kg_m2: f64) -> Self {
        Self { inertia_kg_m2, ..self }
    }

    pub(super) fn validate(&self) -> Result<(), PlanError> {
        let allowed = Allowed::Between { least: 0.0, most: 1e6 };
        within(Parameter::OcclusionTorque, self.occlusion_n_m, allowed)?;
        within(Parameter::Inertia, self.inertia_kg_m2, allowed)?;
        within(Parameter::AmbientPressure, self.ambient_kpa, allowed)
    }

    /// Returns the torque that the motor has to give in the direction of motion, N m, by power balance. It is
    /// negative where the motor brakes.
    ///
    /// tau = (P_out - P_atm) q_out - (P_in - P_atm) q_in + J alpha + tau_occlusion, where q is the flow per
    /// radian. In reverse the fluid's part has the other sign, since an equal flow per radian runs back.
    pub(in crate::plan) fn needed_n_m(
        &self,
        [inlet, outlet]: [(f64, f64); 2],
        acceleration_rad_s2: f64,
        direction: f64,
    ) -> f64 {
        let work = |(pressure_kpa, flow_ml_rad)| (pressure_kpa - self.ambient_kpa) * flow_ml_rad;
        let fluid_n_m = N_M * (work(outlet) - work(inlet));
        direction * (fluid_n_m + self.inertia_kg_m2 * acceleration_rad_s2) + self.occlusion_n_m
    }

    /// Returns an upper bound of the torque at any time of a motion from rest, N m.
    ///
    /// Pressures of inlet and outlet must stay within `within_kpa` of their reservoirs, and flows per radian
    /// below `flow_ml_rad`.
    pub(in crate::plan) fn bound_n_m(
        &self,
        pump: &Pump,
        within_kpa: [f64; 2],
        flow_ml_rad: f64,
        acceleration_rad_s2: f64,
    ) -> f64 {
        let [inlet, outlet] = [(pump.inlet(), within_kpa[0]), (pump.outlet(), within_kpa[1])]
            .map(|(line, within_kpa)| (line.reservoir_kpa - self.ambient_kpa).abs() + within_kpa);
        let fluid_n_m = N_M * flow_ml_rad * (inlet + outlet);
        fluid_n_m + self.inertia_kg_m2 * acceleration_rad_s2 + self.occlusion_n_m
    }
}
