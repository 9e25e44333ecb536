//! Parameters of the roller-centric model.

use crate::drawing::drawing::Drawing;
use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::head::paper;
use crate::pump::pump::Pump;

/// Parameters of the roller-centric model beyond the [`Pump`]. Experimental: the module's documentation lists
/// the assumptions.
///
/// ```
/// use pump_model::{Pump, RollerCentric};
/// let pump = Pump::three_roller();
/// // The closure angle follows from the dimensions.
/// let model = RollerCentric::of(&pump, 85.7)?;
/// assert!((model.closure_rad - RollerCentric::PUBLISHED.closure_rad).abs() < 1e-6);
/// assert!((model.closure_rad.to_degrees() - 30.69).abs() < 0.01);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RollerCentric {
    /// Scale s, 0.5 to 2: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// Distensibility D, 1/kPa, 1e-9 to 1: the fraction by which a chamber holds more for a kPa of pressure.
    pub distensibility_per_kpa: f64,
    /// Resistance R_v of a roller that only just touches the tube, kPa s/mL, 1e-9 to 1e3.
    pub valve_resistance_kpa_s_ml: f64,
    /// Closure angle theta_c, rad, up to phi, at which an engaging roller has closed the lumen.
    pub closure_rad: f64,
    /// Ambient pressure P_atm, kPa absolute.
    pub ambient_kpa: f64,
}

impl RollerCentric {
    /// Parameters for the pump of McIntyre et al.
    ///
    /// The values of s and D are fitted to the published figures, and theta_c follows from the dimensions of
    /// Table 1. R_v is 1e-3 kPa s/mL, which is small against the resistance of a line.
    pub const PUBLISHED: Self = Self {
        scale: paper::SEGMENT_SCALE,
        distensibility_per_kpa: paper::DISTENSIBILITY_PER_KPA,
        valve_resistance_kpa_s_ml: 1e-3,
        closure_rad: paper::CLOSURE_RAD,
        ambient_kpa: paper::AMBIENT_KPA,
    };

    /// Returns the parameters for any pump: [`Self::PUBLISHED`] with the ambient pressure, kPa absolute, and
    /// theta_c of the pump's dimensions ([`crate::Drawing::closure_rad`]).
    ///
    /// # Errors
    ///
    /// Refuses dimensions from which no theta_c follows, and parameters that [`Self::validate`] refuses.
    pub fn of(pump: &Pump, ambient_kpa: f64) -> Result<Self, ModelError> {
        let closure_rad = Drawing::new(pump.geometry())?.closure_rad();
        let model = Self { closure_rad, ambient_kpa, ..Self::PUBLISHED };
        model.validate(pump)?;
        Ok(model)
    }

    /// Checks the parameters for `pump`.
    ///
    /// # Errors
    ///
    /// Refuses parameters outside their ranges, a closure angle beyond phi, and rollers that leave no volume
    /// between them.
    pub fn validate(&self, pump: &Pump) -> Result<(), ModelError> {
        within(Parameter::SegmentScale, self.scale, 0.5..=2.0)?;
        within(Parameter::Distensibility, self.distensibility_per_kpa, 1e-9..=1.0)?;
        within(Parameter::OpenRollerResistance, self.valve_resistance_kpa_s_ml, 1e-9..=1e3)?;
        within(Parameter::ClosureAngle, self.closure_rad, Allowed::POSITIVE)?;
        if self.closure_rad > pump.roller_volume().engagement_rad() {
            let allowed = "no more than the engagement angle phi; state a smaller one if the dimensions give \
                           more than a measured phi";
            return Err(refused(Parameter::ClosureAngle, self.closure_rad, allowed));
        }
        within(Parameter::AmbientPressure, self.ambient_kpa, Allowed::POSITIVE)?;
        // The smallest segment is that between two engaged rollers.
        let segment_ml =
            self.scale * pump.nominal_ml_rad() * pump.pitch_rad() - pump.roller_volume().total_ml();
        if segment_ml <= 0.0 {
            let allowed = "a positive number: a larger scale or fewer rollers";
            return Err(refused(Parameter::SegmentVolume, segment_ml, allowed));
        }
        Ok(())
    }
}
