//! `[motor]`: steps, speeds, torque.

use pump_ctl::plan::{Motor, TORQUE_POINTS, Torque, TorqueCurve};
use pump_model::math::rad_s;
use serde::{Deserialize, Serialize};

/// `[motor]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorTable {
    /// Steps per revolution of the motor, microsteps included.
    pub steps_per_rev: u32,
    /// Revolutions of the motor per revolution of the pump head.
    #[serde(default = "one")]
    pub gear: f64,
    /// Full steps per revolution of the motor: a rotor that is let go may fall by two of them.
    #[serde(default = "usual_full_steps")]
    pub full_steps_per_rev: u32,
    /// Fastest speed of the pump head, r/min.
    pub max_speed_rpm: f64,
    /// Largest acceleration of the pump head, rad/s².
    pub max_acceleration_rad_s2: f64,
    /// (r/min, N m) of what the motor gives at the pump head, gear included: 2 to 8 points from speed 0 up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_curve_rpm_n_m: Option<Vec<(f64, f64)>>,
    /// Torque that squeezing the tube takes at the pump head at any speed, N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occlusion_torque_n_m: Option<f64>,
    /// Moment of inertia of all that turns, at the pump head, kg m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<f64>,
}

impl MotorTable {
    /// The motor as seen at the pump head.
    pub fn at_pump_head(&self) -> Motor {
        Motor {
            steps_per_rev: f64::from(self.steps_per_rev) * self.gear,
            max_speed_rad_s: rad_s(self.max_speed_rpm),
            max_acceleration_rad_s2: self.max_acceleration_rad_s2,
        }
    }

    /// What turning takes and what the motor gives, at this ambient pressure; none unless curve, occlusion and inertia are
    /// known: the fluid's part alone would pass nearly everything.
    pub fn torque(&self, ambient_kpa: f64) -> Option<Torque> {
        let motor = curve(self.torque_curve_rpm_n_m.as_deref()?)?;
        let (occlusion_n_m, inertia_kg_m2) = self.occlusion_torque_n_m.zip(self.inertia_kg_m2)?;
        Some(Torque { occlusion_n_m, inertia_kg_m2, ambient_kpa, motor })
    }

    /// What is wrong with it: key, what it says, what is allowed. Speed and acceleration are left to the planner.
    pub(super) fn wrong(&self) -> Option<(&'static str, String, &'static str)> {
        let unless = |ok: bool, key, value: &dyn std::fmt::Display, allowed| {
            (!ok).then(|| (key, value.to_string(), allowed))
        };
        let number = |key, value: Option<f64>| {
            value.and_then(|value| unless((0.0..=1e6).contains(&value), key, &value, "0 to 1000000"))
        };
        let steps = self.steps_per_rev;
        let full = self.full_steps_per_rev;
        unless((1..=100_000_000).contains(&steps), "[motor] steps_per_rev", &steps, "1 to 100000000")
            .or_else(|| {
                unless((1e-3..=1e4).contains(&self.gear), "[motor] gear", &self.gear, "0.001 to 10000")
            })
            .or_else(|| {
                unless((4..=100_000).contains(&full), "[motor] full_steps_per_rev", &full, "4 to 100000")
            })
            .or_else(|| {
                let points = self.torque_curve_rpm_n_m.as_deref()?;
                let shown: Vec<String> = points.iter().map(|(rpm, n_m)| format!("[{rpm}, {n_m}]")).collect();
                let shown = format!("[{}]", shown.join(", "));
                let allowed =
                    "2 to 8 points [r/min, N m], the first at 0 r/min, speeds rising, torques 0 to 1000000";
                unless(curve(points).is_some(), "[motor] torque_curve_rpm_n_m", &shown, allowed)
            })
            .or_else(|| number("[motor] occlusion_torque_n_m", self.occlusion_torque_n_m))
            .or_else(|| number("[motor] inertia_kg_m2", self.inertia_kg_m2))
            .or_else(|| {
                let wanted = self.torque_curve_rpm_n_m.is_some() && self.occlusion_torque_n_m.is_some();
                let allowed = "a number, 0 if it is negligible: speeding up takes torque, too";
                unless(!wanted || self.inertia_kg_m2.is_some(), "[motor] inertia_kg_m2", &"missing", allowed)
            })
    }
}

/// The curve over rad/s; none if it is none.
fn curve(points: &[(f64, f64)]) -> Option<TorqueCurve> {
    let mut converted = [(0.0, 0.0); TORQUE_POINTS];
    let converted = converted.get_mut(..points.len())?;
    for (to, (rpm, n_m)) in converted.iter_mut().zip(points) {
        *to = (rad_s(*rpm), *n_m);
    }
    TorqueCurve::new(converted)
}

fn one() -> f64 {
    1.0
}

fn usual_full_steps() -> u32 {
    200
}
