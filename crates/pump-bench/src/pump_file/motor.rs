//! `[motor]`: steps, speeds and torque of the motor.

use pump_ctl::plan::{Motor, TORQUE_POINTS, Torque, TorqueCurve};
use pump_model::units::rad_s;
use serde::{Deserialize, Serialize};

use super::range::{WrongValue, allow, within, within_if_given};
use crate::units::{FULL_STEPS_PER_REV, STEPS_PER_REV};

/// The table `[motor]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct MotorTable {
    /// Steps per revolution of the motor, microsteps included.
    pub steps_per_rev: u32,
    /// Revolutions of the motor per revolution of the pump head.
    #[serde(default = "one")]
    pub gear: f64,
    /// Full steps per revolution of the motor. A rotor that is released may fall by two of them.
    #[serde(default = "usual_full_steps")]
    pub full_steps_per_rev: u32,
    /// Fastest speed of the pump head, in r/min.
    pub max_speed_rpm: f64,
    /// Largest acceleration of the pump head, in rad/s².
    pub max_acceleration_rad_s2: f64,
    /// Torque of the motor at the pump head, gear included: 2 to 8 points in r/min and N m, from speed 0 up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_curve_rpm_n_m: Option<Vec<(f64, f64)>>,
    /// Torque at the pump head that squeezes the tube at any speed, in N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occlusion_torque_n_m: Option<f64>,
    /// Moment of inertia of all that turns, referred to the pump head, in kg m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<f64>,
    /// True if somebody has said that these values are those of the motor. `None` counts as said: a value that a
    /// person writes is confirmed. `false` stands beside values that the program filled in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confirmed: Option<bool>,
    /// False if the program filled in which way the head turns as the motor counts up. `None` counts as said, as above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_confirmed: Option<bool>,
}

impl MotorTable {
    /// Returns true if the program filled in the steps, and nobody has written others.
    pub fn has_assumed_steps(&self) -> bool {
        self.confirmed == Some(false)
    }

    /// Returns true if the program filled in the direction.
    pub fn has_assumed_direction(&self) -> bool {
        self.has_assumed_steps() || self.direction_confirmed == Some(false)
    }

    /// Returns the number of motor steps per revolution of the pump head.
    pub(crate) fn steps_at_pump_head(&self) -> f64 {
        f64::from(self.steps_per_rev) * self.gear
    }

    /// Returns the motor as the pump head sees it.
    pub(crate) fn at_pump_head(&self) -> Motor {
        Motor::new(self.steps_at_pump_head(), rad_s(self.max_speed_rpm), self.max_acceleration_rad_s2)
    }

    /// Returns the torque that turning takes and the torque that the motor gives, at an ambient pressure in
    /// kPa.
    ///
    /// Returns `None` unless torque curve, occlusion torque and inertia are all known: the fluid's part alone
    /// would pass nearly everything.
    pub(crate) fn torque(&self, ambient_kpa: f64) -> Option<Torque> {
        let motor = curve(self.torque_curve_rpm_n_m.as_deref()?)?;
        let (occlusion_n_m, inertia_kg_m2) = self.occlusion_torque_n_m.zip(self.inertia_kg_m2)?;
        let torque = Torque::new(ambient_kpa, motor);
        Some(torque.with_occlusion_n_m(occlusion_n_m).with_inertia_kg_m2(inertia_kg_m2))
    }

    /// Refuses the first value outside its range. Speed and acceleration are left to the planner.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        within("[motor] steps_per_rev", self.steps_per_rev, STEPS_PER_REV)?;
        within("[motor] gear", self.gear, 1e-3..=1e4)?;
        within("[motor] full_steps_per_rev", self.full_steps_per_rev, FULL_STEPS_PER_REV)?;
        if let Some(points) = &self.torque_curve_rpm_n_m {
            let shown: Vec<String> = points.iter().map(|(rpm, n_m)| format!("[{rpm}, {n_m}]")).collect();
            allow(
                curve(points).is_some(),
                "[motor] torque_curve_rpm_n_m",
                format_args!("[{}]", shown.join(", ")),
                "2 to 8 points [r/min, N m], the first at 0 r/min, speeds rising, torques 0 to 1000000",
            )?;
        }
        within_if_given("[motor] occlusion_torque_n_m", self.occlusion_torque_n_m, 0.0..=1e6)?;
        within_if_given("[motor] inertia_kg_m2", self.inertia_kg_m2, 0.0..=1e6)?;
        let needs_inertia = self.torque_curve_rpm_n_m.is_some() && self.occlusion_torque_n_m.is_some();
        if needs_inertia && self.inertia_kg_m2.is_none() {
            return Err(WrongValue::missing(
                "[motor] inertia_kg_m2",
                "a number, 0 if it is negligible: speeding up takes torque, too",
            ));
        }
        Ok(())
    }
}

/// Returns the torque curve over rad/s, or `None` if the points make no curve.
fn curve(points: &[(f64, f64)]) -> Option<TorqueCurve> {
    let mut converted = [(0.0, 0.0); TORQUE_POINTS];
    let converted = converted.get_mut(..points.len())?;
    for (to, (rpm, n_m)) in converted.iter_mut().zip(points) {
        *to = (rad_s(*rpm), *n_m);
    }
    TorqueCurve::new(converted)
}

/// Returns the gear of a motor without a gearbox.
fn one() -> f64 {
    1.0
}

/// Returns the full steps per revolution of a usual stepper motor.
fn usual_full_steps() -> u32 {
    200
}
