//! The settings of a dose, as the page writes them.

use pump_ctl::plan::{Cruise, Limits, Lowest, Motor, Phase, Request, SetBy};
use pump_model::units::{rad_s, radians};
use pump_model::{DefaultPulse, Fluid, Line, ModelError, Pump};

use crate::cautions::Knowledge;
use crate::pulse_spread::covariances;
use crate::pulse_sureness::PulseSureness;
use crate::refusal::Refusal;

/// Number of settings.
pub const SETTINGS: usize = 10;

/// Fewest and most rollers of a head that is known by its volume.
const ROLLERS: (f64, f64) = (2.0, 24.0);

/// Motor steps per revolution of the pump head, and the largest acceleration, rad/s²: those of the built-in pumps.
const STEPS_PER_REV: f64 = 12_800.0;
const MAX_ACCELERATION_RAD_S2: f64 = 500.0;

/// Standard uncertainty of the roller volume of the paper's heads, mL, as their pump files have it.
const ROLLER_VOLUME_STANDARD_ML: f64 = 0.026;

/// Temperature of the water that is pumped, °C.
const WATER_DEGC: f64 = 25.0;

/// The settings of a dose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    head: Head,
    volume_ml: f64,
    start_deg: f64,
    rate_ml_s: f64,
    is_smooth: bool,
    line: Line,
}

/// The pump head.
#[derive(Debug, Clone, Copy)]
enum Head {
    /// The head of McIntyre et al. with three rollers.
    ThreeRoller,
    /// The head of McIntyre et al. with two rollers.
    TwoRoller,
    /// A head that is known by its rollers and its volume per revolution.
    ByVolume { rollers: f64, ml_per_rev: f64 },
}

impl Settings {
    /// Reads the settings in their order on the page: head (3 and 2 are built in, any other is known by its volume),
    /// its rollers, its mL per revolution; volume, mL; start angle, degrees; rate, mL/s; 1 for a smooth flow; R, C and
    /// L of either line.
    pub(crate) fn read(numbers: &[f64; SETTINGS]) -> Self {
        let &[head, rollers, ml_per_rev, volume_ml, start_deg, rate_ml_s, smooth, r, c, l] = numbers;
        let head = match head {
            3.0 => Head::ThreeRoller,
            2.0 => Head::TwoRoller,
            _ => Head::ByVolume { rollers, ml_per_rev },
        };
        let line = Line {
            resistance_kpa_s_ml: r,
            compliance_ml_kpa: c,
            inertance_kpa_s2_ml: l,
            reservoir_kpa: Line::PUBLISHED.reservoir_kpa,
        };
        Self { head, volume_ml, start_deg, rate_ml_s, is_smooth: smooth == 1.0, line }
    }

    /// Returns the volume asked for, mL.
    pub(crate) fn volume_ml(&self) -> f64 {
        self.volume_ml
    }

    /// Makes the pump.
    ///
    /// # Errors
    /// Returns the [`Refusal`] of a head or a line that is out of range.
    pub(crate) fn pump(&self) -> Result<Pump, Refusal> {
        let (rollers, ml_per_rev) = match self.head {
            Head::ThreeRoller => return Ok(Pump::three_roller().with_lines(self.line, self.line)?),
            Head::TwoRoller => return Ok(Pump::two_roller().with_lines(self.line, self.line)?),
            Head::ByVolume { rollers, ml_per_rev } => (rollers, ml_per_rev),
        };
        if !(rollers >= ROLLERS.0 && rollers <= ROLLERS.1 && libm::floor(rollers) == rollers) {
            return Err(Refusal::Rollers(rollers));
        }
        // Whole and 24 at most.
        let rollers = rollers as u32;
        let pulse = DefaultPulse::of_rollers(rollers);
        Ok(Pump::from_ml_per_rev(ml_per_rev, rollers, pulse, self.line, self.line)?)
    }

    /// Returns how well the pulse of the head is known.
    pub(crate) fn knowledge(&self) -> Knowledge {
        match self.head {
            Head::ThreeRoller | Head::TwoRoller => Knowledge::Measured(ROLLER_VOLUME_STANDARD_ML),
            // Whole and 24 at most where there is a pump.
            Head::ByVolume { rollers, .. } => {
                Knowledge::Usual(PulseSureness::of_default(covariances(rollers as u32), 0.0))
            }
        }
    }

    /// Returns true if the flow is to be smooth.
    pub(crate) fn is_smooth(&self) -> bool {
        self.is_smooth
    }

    /// Returns the motor.
    pub(crate) fn motor(&self) -> Motor {
        let max_rpm = match self.head {
            Head::ThreeRoller => 170.0,
            Head::TwoRoller => 300.0,
            Head::ByVolume { .. } => 100.0,
        };
        Motor::new(STEPS_PER_REV, rad_s(max_rpm), MAX_ACCELERATION_RAD_S2)
    }

    /// Returns the limits of the dose: those of the motor, and the pressure at which water boils.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a temperature at which water is not known.
    pub(crate) fn limits(&self) -> Result<Limits, ModelError> {
        let limits = Limits::new(self.motor());
        let vapour_kpa = Fluid::water(WATER_DEGC)?.vapour_kpa;
        Ok(vapour_kpa.map_or(limits, |kpa| limits.with_lowest(Lowest { kpa, set_by: SetBy::Vapour })))
    }

    /// Returns the angle at the start, which is known exactly.
    pub(crate) fn start(&self) -> Phase {
        Phase::known(radians(self.start_deg))
    }

    /// Returns the request.
    pub(crate) fn request(&self) -> Request {
        Request::new(self.volume_ml, Cruise::Flow { ml_s: self.rate_ml_s }).with_smooth(self.is_smooth)
    }
}
