//! Lines from hoses: R, C and L from the dimensions, the material and the fluid.

use core::f64::consts::PI;

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::line::friction::Friction;
use crate::line::line::Line;

use super::fluid::Fluid;

/// A straight hose of one bore.
///
/// ```
/// use pump_model::{Fluid, Hose};
/// let hose = Hose {
///     bore_radius_mm: 5.0, outer_radius_mm: 7.0, length_mm: 331.0,
///     modulus_mpa: 3.5, poisson_ratio: 0.5, minor_loss: 5.75,
/// };
/// let water = Fluid::water(25.0)?;
/// assert!((hose.compliance_ml_kpa(&water) - 0.0455).abs() < 1e-4);
/// assert!((hose.inertance_kpa_s2_ml(&water) - 0.0042).abs() < 1e-5);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hose {
    /// Inner radius a, mm.
    pub bore_radius_mm: f64,
    /// Outer radius b, mm.
    pub outer_radius_mm: f64,
    /// Length l, mm.
    pub length_mm: f64,
    /// Young's modulus E of the wall, MPa.
    pub modulus_mpa: f64,
    /// Poisson ratio nu of the wall, 0 to 0.5: 0.5 for rubber, which keeps its volume.
    pub poisson_ratio: f64,
    /// Minor-loss coefficient K of ends, bends and fittings together, 0 to 1e6, in velocity heads of the
    /// bore.
    pub minor_loss: f64,
}

impl Hose {
    /// Checks dimensions and material of the hose.
    ///
    /// # Errors
    ///
    /// Refuses dimensions and materials that are not physical, with the name of the parameter.
    pub fn validate(&self) -> Result<(), ModelError> {
        within(Parameter::HoseBoreRadius, self.bore_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::HoseOuterRadius, self.outer_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::HoseLength, self.length_mm, Allowed::POSITIVE)?;
        within(Parameter::HoseModulus, self.modulus_mpa, Allowed::POSITIVE)?;
        if self.outer_radius_mm <= self.bore_radius_mm {
            let allowed = "more than its bore radius";
            return Err(refused(Parameter::HoseOuterRadius, self.outer_radius_mm, allowed));
        }
        within(Parameter::HosePoissonRatio, self.poisson_ratio, 0.0..=0.5)?;
        within(Parameter::HoseMinorLoss, self.minor_loss, 0.0..=1e6)
    }

    /// Returns the volume of the bore, mL: V = pi a² l.
    pub fn volume_ml(&self) -> f64 {
        1e-3 * PI * self.bore_radius_mm * self.bore_radius_mm * self.length_mm
    }

    /// Returns the compliance of the hose with `fluid`, mL/kPa: C = V (1/K + 2 (1 + nu)/E (b² + (1 - 2 nu)
    /// a²)/(b² - a²)).
    ///
    /// K is the fluid's bulk modulus. The wall is a cylinder of any thickness whose ends are held (Lamé,
    /// plane strain). The formula equals Wylie and Streeter's factor for thick walls ("Fluid Transients",
    /// anchored throughout). A held hose is stiffer than one that may become longer.
    pub fn compliance_ml_kpa(&self, fluid: &Fluid) -> f64 {
        let (a2, b2) =
            (self.bore_radius_mm * self.bore_radius_mm, self.outer_radius_mm * self.outer_radius_mm);
        let nu = self.poisson_ratio;
        let wall_per_mpa = 2.0 * (1.0 + nu) / self.modulus_mpa * (b2 + (1.0 - 2.0 * nu) * a2) / (b2 - a2);
        const MPA_PER_KPA: f64 = 1e-3;
        self.volume_ml() * (1.0 / fluid.bulk_modulus_mpa + wall_per_mpa) * MPA_PER_KPA
    }

    /// Returns the inertance of the hose with `fluid`, kPa s²/mL: L = rho l / A.
    pub fn inertance_kpa_s2_ml(&self, fluid: &Fluid) -> f64 {
        // kg/m³ mm/mm² are 1e3 Pa s²/m³, and 1 kPa s²/mL is 1e9 of those.
        1e-6 * fluid.density_kg_m3 * self.length_mm / (PI * self.bore_radius_mm * self.bore_radius_mm)
    }

    /// Returns the friction of the hose: the pressure that pushes the fluid through, over the flow.
    ///
    /// # Errors
    ///
    /// Refuses a hose or a fluid that is not physical.
    pub fn friction(&self, fluid: &Fluid) -> Result<Friction, ModelError> {
        self.validate()?;
        fluid.validate()?;
        let diameter_mm = 2.0 * self.bore_radius_mm;
        let area_mm2 = PI * self.bore_radius_mm * self.bore_radius_mm;
        // The speed v in m/s is Q in mL/s over A in mm². The unit kg/m³ m/s mm over mPa s is 1.
        let reynolds_per_flow = fluid.density_kg_m3 * diameter_mm / (fluid.viscosity_mpa_s * area_mm2);
        // 32 mu l v/d² with mPa s, mm, m/s and mm²: Pa; to kPa.
        let laminar_kpa_s_ml =
            1e-3 * 32.0 * fluid.viscosity_mpa_s * self.length_mm / (diameter_mm * diameter_mm * area_mm2);
        let minor_kpa_s2_ml2 = 1e-3 * 0.5 * self.minor_loss * fluid.density_kg_m3 / (area_mm2 * area_mm2);
        Ok(Friction { reynolds_per_flow, laminar_kpa_s_ml, minor_kpa_s2_ml2 })
    }

    /// Returns the linear line of this hose. R is the pressure at `flow_ml_s` over that flow, in either
    /// direction. At no flow R is that of laminar flow alone, 128 mu l/(pi d⁴).
    ///
    /// # Errors
    ///
    /// Refuses a hose, a fluid or a line that is not physical, and a flow that is not finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::{Fluid, Hose};
    /// // The line of McIntyre et al., whose R they took at 210 mL/s.
    /// let hose = Hose {
    ///     bore_radius_mm: 5.0, outer_radius_mm: 7.0, length_mm: 331.0,
    ///     modulus_mpa: 3.5, poisson_ratio: 0.5, minor_loss: 5.75,
    /// };
    /// let line = hose.line(&Fluid::water(25.0)?, 88.637, 210.0)?;
    /// assert!((line.resistance_kpa_s_ml - 0.1108).abs() < 2e-4);
    /// assert!((line.inertance_kpa_s2_ml - 0.0042).abs() < 1e-5);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn line(&self, fluid: &Fluid, reservoir_kpa: f64, flow_ml_s: f64) -> Result<Line, ModelError> {
        within(Parameter::Flow, flow_ml_s, Allowed::FINITE)?;
        let line = Line {
            resistance_kpa_s_ml: self.friction(fluid)?.resistance_kpa_s_ml(flow_ml_s),
            compliance_ml_kpa: self.compliance_ml_kpa(fluid),
            inertance_kpa_s2_ml: self.inertance_kpa_s2_ml(fluid),
            reservoir_kpa,
        };
        line.validate()?;
        Ok(line)
    }
}
