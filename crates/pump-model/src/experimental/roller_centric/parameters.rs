//! The parameters of the roller-centric model.

use crate::drawing::drawing::Drawing;
use crate::error::{Allowed, ModelError, refused, within};
use crate::head::paper;
use crate::pump::pump::Pump;

/// Parameters of the roller-centric model beyond the [`Pump`]. Experimental: the module's documentation lists what
/// it assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RollerCentric {
    /// s, 0.5 to 2: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// D, 1/kPa, 1e-9 to 1: how much more a chamber holds for more pressure.
    pub distensibility_per_kpa: f64,
    /// R_v, kPa s/mL, 1e-9 to 1e3: what a roller that only just touches the tube resists.
    pub valve_resistance_kpa_s_ml: f64,
    /// theta_c, rad, up to phi: where an engaging roller has closed the lumen.
    pub closure_rad: f64,
    /// P_atm, kPa absolute.
    pub ambient_kpa: f64,
}

impl RollerCentric {
    /// For the pump of McIntyre et al.: s and D as fitted to what they publish, theta_c of the dimensions of their
    /// Table 1, an R_v of 1e-3 kPa s/mL, which is small against what a line resists.
    pub const PUBLISHED: Self = Self {
        scale: paper::SEGMENT_SCALE,
        distensibility_per_kpa: paper::DISTENSIBILITY_PER_KPA,
        valve_resistance_kpa_s_ml: 1e-3,
        closure_rad: paper::CLOSURE_RAD,
        ambient_kpa: paper::AMBIENT_KPA,
    };

    /// For any pump: as [`Self::PUBLISHED`], with theta_c of its dimensions ([`crate::Drawing::closure_rad`]) and the
    /// ambient pressure, kPa absolute. Refuses dimensions from which no theta_c follows.
    pub fn of(pump: &Pump, ambient_kpa: f64) -> Result<Self, ModelError> {
        let closure_rad = Drawing::new(pump.geometry())?.closure_rad();
        let model = Self { closure_rad, ambient_kpa, ..Self::PUBLISHED };
        model.validate(pump)?;
        Ok(model)
    }

    /// Refuses parameters that are not physical, or not so for `pump`.
    pub fn validate(&self, pump: &Pump) -> Result<(), ModelError> {
        within("scale of the segments", self.scale, 0.5..=2.0)?;
        within("distensibility in 1/kPa", self.distensibility_per_kpa, 1e-9..=1.0)?;
        within("resistance of an open roller in kPa s/mL", self.valve_resistance_kpa_s_ml, 1e-9..=1e3)?;
        within("closure angle in rad", self.closure_rad, Allowed::POSITIVE)?;
        if self.closure_rad > pump.roller_volume().engagement_rad() {
            let allowed = "no more than the engagement angle phi; give one where the dimensions' is larger than a \
                           measured phi";
            return Err(refused("closure angle in rad", self.closure_rad, allowed));
        }
        within("ambient pressure in kPa absolute", self.ambient_kpa, Allowed::POSITIVE)?;
        // A segment between two engaged rollers is the smallest.
        let segment_ml =
            self.scale * pump.nominal_ml_rad() * pump.pitch_rad() - pump.roller_volume().total_ml();
        if segment_ml <= 0.0 {
            let allowed = "a positive number: a larger scale or fewer rollers";
            return Err(refused("volume between two rollers in mL", segment_ml, allowed));
        }
        Ok(())
    }
}
