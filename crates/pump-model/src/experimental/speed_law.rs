//! Volume against speed: what a revolution delivers at the inlet pressure at which it was trapped. Experimental.

use crate::error::{Allowed, ModelError, within};
use crate::head::paper;
use crate::head::port::Port;
use crate::line::exact_run::ExactRun;
use crate::math::{TURN_RAD, wrap};
use crate::motion::leg::Leg;
use crate::pump::pump::Pump;
use crate::pump::steady_state::moving;

/// How the volume of a revolution depends on the speed: a segment is trapped when the roller behind it closes the
/// lumen, and holds more or less by the inlet pressure of that moment.
///
/// V_rot(N) = NU V0s (1 + D (P_in(theta_c; N) - P_atm)) with V0s = s V_nom/NU - (V_r + V(theta_c))/2. P_in is that of
/// the periodic steady state at speed N, when the engaging roller stands at theta_c. In reverse the ports swap their
/// roles.
///
/// The pump is as it is without law and calibration: V_nom, V_r and P_in are of its unscaled curves, angles from its
/// own zero.
///
/// Experimental: its two parameters are fitted to summary numbers (means, NRMSE and deviations) that McIntyre et al.
/// publish; the raw volumes are not published. Doses use it where a pump file or a calibration says so.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedLaw {
    /// s: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// D, 1/kPa, not negative: how much more a segment holds for more pressure.
    pub distensibility_per_kpa: f64,
    /// theta_c, rad: where an engaging roller closes the lumen.
    pub closure_rad: f64,
    /// P_atm, kPa absolute.
    pub ambient_kpa: f64,
}

impl SpeedLaw {
    /// Fitted to what McIntyre et al. publish of their pump; theta_c of the dimensions of Table 1.
    pub const PUBLISHED: Self = Self {
        scale: paper::SEGMENT_SCALE,
        distensibility_per_kpa: paper::DISTENSIBILITY_PER_KPA,
        closure_rad: paper::CLOSURE_RAD,
        ambient_kpa: paper::AMBIENT_KPA,
    };

    /// Refuses parameters that are not physical.
    pub fn validate(&self) -> Result<(), ModelError> {
        within("scale of the speed law", self.scale, Allowed::POSITIVE)?;
        within("closure angle in rad", self.closure_rad, Allowed::POSITIVE)?;
        within("ambient pressure in kPa absolute", self.ambient_kpa, Allowed::POSITIVE)?;
        within("distensibility in 1/kPa", self.distensibility_per_kpa, 0.0..=1.0)
    }

    /// V_rot(N), mL per revolution, at a constant speed other than 0; negative in reverse.
    pub fn revolution_ml(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        self.validate()?;
        let trapped_kpa = self.trapped_kpa(pump, speed_rad_s)?;
        let stretch = 1.0 + self.distensibility_per_kpa * (trapped_kpa - self.ambient_kpa);
        let revolution_ml = self.scale * TURN_RAD * pump.geometry().nominal_ml_rad() * stretch
            - self.pinched_ml(pump) * stretch;
        within("volume per revolution of the speed law in mL", revolution_ml, Allowed::POSITIVE)?;
        Ok(revolution_ml)
    }

    /// NU (V_r + V(theta_c))/2, mL: what the rollers take of the segments of a revolution when these are trapped.
    pub fn pinched_ml(&self, pump: &Pump) -> f64 {
        let roller = pump.roller_volume();
        0.5 * f64::from(pump.geometry().rollers) * (roller.total_ml() + roller.at(self.closure_rad))
    }

    /// kappa(N) = V_rot(N)/V_rot: what every flow and volume of the pump is multiplied by at this speed, not 0.
    pub fn factor(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        Ok(self.revolution_ml(pump, speed_rad_s)? / pump.revolution_ml())
    }

    /// Q_avg(omega) = V_rot(N) omega/(2 pi), mL/s, at a speed other than 0; negative in reverse.
    pub fn average_flow_ml_s(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        Ok(self.revolution_ml(pump, speed_rad_s)? * speed_rad_s / TURN_RAD)
    }

    /// P_in(theta_c; N), kPa absolute: the pressure of the steady state at the port that sucks when a roller closes the
    /// lumen.
    pub fn trapped_kpa(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        moving(speed_rad_s)?;
        // How far the rotor turns from angle 0 until the next roller that engages stands at theta_c.
        let (port, turn_rad) = if speed_rad_s > 0.0 {
            let psi_rad = pump.geometry().inlet_phase_rad(pump.roller_volume())?;
            (Port::Inlet, psi_rad + self.closure_rad)
        } else {
            (Port::Outlet, self.closure_rad - pump.roller_volume().engagement_rad())
        };
        let state = pump.periodic_state(port, speed_rad_s)?;
        let motion = [Leg::constant_speed(0.0, speed_rad_s)];
        let time_s = wrap(turn_rad, pump.pitch_rad()) / speed_rad_s.abs();
        let [kpa, _] = ExactRun::new(pump, port, motion, state).at(time_s);
        Ok(pump.line(port).reservoir_kpa + kpa)
    }
}
