//! What a dose must not exceed.

use pump_model::Pump;
use pump_model::math::TURN_RAD;

use super::{Plan, PlanError};

/// The stepper motor, as seen at the pump head.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motor {
    /// Steps per revolution of the pump head, gear included.
    pub steps_per_rev: f64,
    /// Fastest speed of the pump head, rad/s.
    pub max_speed_rad_s: f64,
    /// Largest acceleration of the pump head, rad/s².
    pub max_acceleration_rad_s2: f64,
}

impl Motor {
    /// Angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        TURN_RAD / self.steps_per_rev
    }
}

/// Limits of the motor and, where given, of the pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    /// Steps, speed and acceleration.
    pub motor: Motor,
    /// Largest pressure at the port that pushes, kPa absolute; none is not checked.
    pub max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the port that sucks, kPa absolute; none is not checked.
    pub min_inlet_kpa: Option<f64>,
}

impl Limits {
    /// The motor alone.
    pub fn of_motor(motor: Motor) -> Self {
        Self { motor, max_outlet_kpa: None, min_inlet_kpa: None }
    }

    /// Refuses limits that mean nothing.
    pub fn validate(&self) -> Result<(), PlanError> {
        let within = |parameter, value: f64, range: core::ops::RangeInclusive<f64>, allowed| {
            if range.contains(&value) {
                Ok(())
            } else {
                Err(PlanError::OutOfRange { parameter, value, allowed })
            }
        };
        within("steps per revolution", self.motor.steps_per_rev, 4.0..=1e9, "4 to 1e9")?;
        within("largest speed in rad/s", self.motor.max_speed_rad_s, 1e-9..=1e4, "1e-9 to 1e4")?;
        within(
            "largest acceleration in rad/s2",
            self.motor.max_acceleration_rad_s2,
            1e-6..=1e7,
            "1e-6 to 1e7",
        )?;
        if let Some(limit) = self.max_outlet_kpa {
            within(
                "outlet pressure limit in kPa absolute",
                limit,
                1e-9..=1e6,
                "a positive pressure, 1e6 at most",
            )?;
        }
        if let Some(limit) = self.min_inlet_kpa {
            within("inlet pressure limit in kPa absolute", limit, -1e6..=1e6, "within 1e6 either way")?;
        }
        Ok(())
    }

    /// Whether a pressure is limited.
    pub(super) fn check_pressure(&self) -> bool {
        self.max_outlet_kpa.is_some() || self.min_inlet_kpa.is_some()
    }

    /// Refuses a plan whose predicted pressures break a limit. In reverse the ports swap roles.
    pub(super) fn check_pressures(&self, pump: &Pump, plan: &Plan) -> Result<(), PlanError> {
        if !self.check_pressure() {
            return Ok(());
        }
        let prediction = plan.predict(pump)?;
        let (sucking, pushing) = if plan.direction() > 0 {
            (prediction.inlet, prediction.outlet)
        } else {
            (prediction.outlet, prediction.inlet)
        };
        if let Some(limit_kpa) = self.max_outlet_kpa
            && pushing.max_kpa > limit_kpa
        {
            return Err(PlanError::OutletPressure { predicted_kpa: pushing.max_kpa, limit_kpa });
        }
        if let Some(limit_kpa) = self.min_inlet_kpa
            && sucking.min_kpa < limit_kpa
        {
            return Err(PlanError::InletPressure { predicted_kpa: sucking.min_kpa, limit_kpa });
        }
        Ok(())
    }
}
