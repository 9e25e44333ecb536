//! Volume against speed: a revolution delivers the volume that was trapped at the inlet pressure of that
//! moment. Experimental.

use crate::error::{Allowed, ModelError, Parameter, within};
use crate::head::paper;
use crate::line::exact_run::ExactRun;
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;
use crate::pump::steady_state::moving;
use crate::units::{TURN_RAD, wrap};

/// Dependence of the volume of a revolution on the speed.
///
/// A segment is trapped when the roller behind it closes the lumen, and holds more or less by the inlet
/// pressure of that moment.
///
/// V_rot(N) = NU V0s (1 + D (P_in(theta_c; N) - P_atm)) with V0s = s V_nom/NU - (V_r + V(theta_c))/2. P_in is
/// the pressure of the periodic steady state at speed N, when the engaging roller stands at theta_c. In
/// reverse the ports swap their roles.
///
/// The law takes the pump without law and calibration: V_nom, V_r and P_in are of its unscaled curves, and
/// angles count from its own zero.
///
/// The law is experimental. Its two parameters are fitted to summary numbers (means, NRMSE and deviations)
/// that McIntyre et al. publish; the raw volumes are not published. Doses use the law where a pump file or a
/// calibration says so.
///
/// ```
/// use pump_model::{Pump, SpeedLaw, units::rad_s};
/// let pump = Pump::three_roller();
/// // Without distensibility the volume is that of the segments at every speed.
/// let stiff = SpeedLaw { distensibility_per_kpa: 0.0, ..SpeedLaw::PUBLISHED };
/// assert!((stiff.revolution_ml(&pump, rad_s(100.0))? - 20.865864).abs() < 1e-5);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedLaw {
    /// Scale s: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// Distensibility D, 1/kPa, not negative: the fraction by which a segment holds more for a kPa of
    /// pressure.
    pub distensibility_per_kpa: f64,
    /// Closure angle theta_c, rad, at which an engaging roller closes the lumen.
    pub closure_rad: f64,
    /// Ambient pressure P_atm, kPa absolute.
    pub ambient_kpa: f64,
}

impl SpeedLaw {
    /// Law fitted to the published figures of McIntyre et al.'s pump, with theta_c by the dimensions of
    /// Table 1.
    pub const PUBLISHED: Self = Self {
        scale: paper::SEGMENT_SCALE,
        distensibility_per_kpa: paper::DISTENSIBILITY_PER_KPA,
        closure_rad: paper::CLOSURE_RAD,
        ambient_kpa: paper::AMBIENT_KPA,
    };

    /// Checks the parameters of the law.
    ///
    /// # Errors
    ///
    /// Refuses parameters that are not physical.
    pub fn validate(&self) -> Result<(), ModelError> {
        within(Parameter::SpeedLawScale, self.scale, Allowed::POSITIVE)?;
        within(Parameter::ClosureAngle, self.closure_rad, Allowed::POSITIVE)?;
        within(Parameter::AmbientPressure, self.ambient_kpa, Allowed::POSITIVE)?;
        within(Parameter::Distensibility, self.distensibility_per_kpa, 0.0..=1.0)
    }

    /// Returns the volume of a revolution V_rot(N), mL, at a constant speed other than 0. The speed is
    /// negative in reverse.
    ///
    /// # Errors
    ///
    /// Refuses parameters or a speed that are not allowed, a speed without a steady state, and a volume that
    /// is not positive.
    pub fn revolution_ml(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        self.validate()?;
        let trapped_kpa = self.trapped_kpa(pump, speed_rad_s)?;
        let stretch = 1.0 + self.distensibility_per_kpa * (trapped_kpa - self.ambient_kpa);
        let revolution_ml = self.scale * TURN_RAD * pump.geometry().nominal_ml_rad() * stretch
            - self.pinched_ml(pump) * stretch;
        within(Parameter::SpeedLawRevolution, revolution_ml, Allowed::POSITIVE)?;
        Ok(revolution_ml)
    }

    /// Returns the volume that the rollers take of a revolution's segments when these are trapped, mL:
    /// NU (V_r + V(theta_c))/2.
    pub fn pinched_ml(&self, pump: &Pump) -> f64 {
        let roller = pump.roller_volume();
        0.5 * f64::from(pump.geometry().rollers) * (roller.total_ml() + roller.at(self.closure_rad))
    }

    /// Returns the factor of every flow and volume of the pump at a speed other than 0:
    /// kappa(N) = V_rot(N)/V_rot.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::revolution_ml`] does.
    pub fn factor(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        Ok(self.revolution_ml(pump, speed_rad_s)? / pump.revolution_ml())
    }

    /// Returns the mean flow at a speed other than 0, mL/s; negative in reverse:
    /// Q_avg(omega) = V_rot(N) omega/(2 pi).
    ///
    /// # Errors
    ///
    /// Fails where [`Self::revolution_ml`] does.
    pub fn average_flow_ml_s(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        Ok(self.revolution_ml(pump, speed_rad_s)? * speed_rad_s / TURN_RAD)
    }

    /// Returns the pressure P_in(theta_c; N), kPa absolute: that of the steady state at the suction port when
    /// a roller closes the lumen.
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite, a pump whose rollers engage for too long, and a resonance
    /// that nothing damps.
    pub fn trapped_kpa(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        moving(speed_rad_s)?;
        // Port, and angle that the rotor turns from angle 0 until the next roller that engages stands at
        // theta_c.
        let (port, turn_rad) = if speed_rad_s > 0.0 {
            let psi_rad = pump.geometry().inlet_phase_rad(pump.roller_volume())?;
            (Port::Inlet, psi_rad + self.closure_rad)
        } else {
            (Port::Outlet, self.closure_rad - pump.roller_volume().engagement_rad())
        };
        let state = pump.periodic_state(port, speed_rad_s)?;
        let motion = [Leg::constant_speed(0.0, speed_rad_s)];
        let time_s = wrap(turn_rad, pump.pitch_rad()) / speed_rad_s.abs();
        let kpa = ExactRun::new(pump, port, motion, state).at(time_s).above_reservoir_kpa;
        Ok(pump.line(port).reservoir_kpa + kpa)
    }
}
