//! Dimensions of a pump, and the quantities that follow from them alone (McIntyre et al.).

use core::f64::consts::PI;

use libm::sin;

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::units::{TURN_RAD, degrees};

use super::roller_volume::RollerVolume;

/// Dimensions of pump head and tube.
///
/// The symbols are those of McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and
/// pressure response of a roller-type peristaltic pump", Sensors and Actuators A.
///
/// ```
/// use pump_model::{Geometry, Variant};
/// let geometry = Geometry::published(3, Variant::Measured);
/// geometry.validate()?;
/// assert!((geometry.nominal_ml_rad() - 4.3982297).abs() < 1e-7);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Geometry {
    /// Number of rollers, 1 or more.
    pub rollers: u32,
    /// Inner radius of the tube r_i, mm.
    pub bore_radius_mm: f64,
    /// Outer radius of the tube r_o, mm.
    pub tube_outer_radius_mm: f64,
    /// Radius of the backplate (raceway) r_b, mm.
    pub backplate_radius_mm: f64,
    /// Contact angle beta, rad: the backplate spans pi + 2 beta. It is negative for a bed shorter than half a turn.
    pub contact_angle_rad: f64,
    /// Radius of a roller r_roller, mm.
    pub roller_radius_mm: f64,
    /// Distance from the shaft to a roller's axis r_offset, mm.
    pub roller_offset_mm: f64,
}

impl Geometry {
    /// Returns the geometry of a head of which only the number of rollers is known. Every length and the contact
    /// angle are 0, and [`Self::is_known`] is false.
    pub const fn of_rollers(rollers: u32) -> Self {
        Self {
            rollers,
            bore_radius_mm: 0.0,
            tube_outer_radius_mm: 0.0,
            backplate_radius_mm: 0.0,
            contact_angle_rad: 0.0,
            roller_radius_mm: 0.0,
            roller_offset_mm: 0.0,
        }
    }

    /// Returns true if the dimensions are known. They are not for a head that is known by its volume alone
    /// ([`Self::of_rollers`]).
    ///
    /// ```
    /// use pump_model::{Geometry, Pump};
    /// assert!(Pump::three_roller().geometry().is_known());
    /// assert!(!Geometry::of_rollers(4).is_known());
    /// ```
    pub fn is_known(&self) -> bool {
        *self != Self::of_rollers(self.rollers)
    }

    /// Checks the dimensions of the pump.
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::DimensionsUnknown`] for a head that is known by its volume alone.
    /// Refuses dimensions that are not finite and positive. Also refuses rollers that hit the backplate, do
    /// not close the tube, or leave it open at some angle.
    pub fn validate(&self) -> Result<(), ModelError> {
        self.validate_rollers()?;
        if !self.is_known() {
            return Err(ModelError::DimensionsUnknown { rollers: self.rollers });
        }
        within(Parameter::BoreRadius, self.bore_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::TubeOuterRadius, self.tube_outer_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::BackplateRadius, self.backplate_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::RollerRadius, self.roller_radius_mm, Allowed::POSITIVE)?;
        within(Parameter::RollerOffset, self.roller_offset_mm, Allowed::POSITIVE)?;
        if self.tube_outer_radius_mm <= self.bore_radius_mm {
            let allowed = "more than the bore radius";
            return Err(refused(Parameter::TubeOuterRadius, self.tube_outer_radius_mm, allowed));
        }
        let outer_diameter_mm = 2.0 * self.tube_outer_radius_mm;
        if self.backplate_radius_mm <= outer_diameter_mm {
            let backplate_radius_mm = self.backplate_radius_mm;
            return Err(ModelError::BackplateTooSmall { backplate_radius_mm, outer_diameter_mm });
        }
        within(Parameter::ContactAngle, degrees(self.contact_angle_rad), -90.0..90.0)?;
        let reach_mm = self.roller_offset_mm + self.roller_radius_mm;
        let gap_mm = self.backplate_radius_mm - reach_mm;
        if gap_mm < 0.0 {
            let backplate_radius_mm = self.backplate_radius_mm;
            return Err(ModelError::RollersHitBackplate { reach_mm, backplate_radius_mm });
        }
        let closed_mm = 2.0 * (self.tube_outer_radius_mm - self.bore_radius_mm);
        if gap_mm > closed_mm {
            return Err(ModelError::NotOccluding { gap_mm, closed_mm });
        }
        self.validate_seal(0.0)
    }

    /// Checks the number of rollers alone.
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::OutOfRange`] for a number of rollers that no pump has.
    pub fn validate_rollers(&self) -> Result<(), ModelError> {
        within(Parameter::Rollers, f64::from(self.rollers), 1.0..=1000.0)
    }

    /// Refuses rollers if at some angle none of them is fully engaged. Rollers engage fully `inset_rad`
    /// inside the arc.
    pub(crate) fn validate_seal(&self, inset_rad: f64) -> Result<(), ModelError> {
        let span_rad = self.sealed_span_rad(inset_rad);
        if self.pitch_rad() > span_rad {
            return Err(ModelError::NotSealing {
                rollers: self.rollers,
                pitch_deg: degrees(self.pitch_rad()),
                span_deg: degrees(span_rad),
            });
        }
        Ok(())
    }

    /// Returns the angle over which a roller turns fully engaged, rad: Lam = pi + 2 beta - 2 inset.
    pub(crate) fn sealed_span_rad(&self, inset_rad: f64) -> f64 {
        PI + 2.0 * self.contact_angle_rad - 2.0 * inset_rad
    }

    /// Returns the flow per radian without roller pulses, mL/rad: a = pi r_i² (r_b - r_o) (McIntyre et al.).
    pub fn nominal_ml_rad(&self) -> f64 {
        const MM3_PER_ML: f64 = 1000.0;
        let radius = self.bore_radius_mm;
        PI * radius * radius * (self.backplate_radius_mm - self.tube_outer_radius_mm) / MM3_PER_ML
    }

    /// Returns the angle between neighbouring rollers, rad: 2 pi / NU.
    pub fn pitch_rad(&self) -> f64 {
        TURN_RAD / f64::from(self.rollers)
    }

    /// Returns the depth by which neighbouring rollers overlap in space, mm. `None` if they do not.
    ///
    /// Their axes stand 2 r_offset sin(pi/NU) apart. The model computes such a head, but nobody can build it.
    ///
    /// ```
    /// use pump_model::{Geometry, Variant};
    /// assert_eq!(Geometry::published(3, Variant::Measured).rollers_overlap_mm(), None);
    /// // Eight rollers of 40 mm on a circle of 80 mm: the axes stand 30.6 mm apart.
    /// let depth_mm = Geometry::published(8, Variant::Measured).rollers_overlap_mm().unwrap();
    /// assert!((depth_mm - 9.385).abs() < 1e-3);
    /// ```
    pub fn rollers_overlap_mm(&self) -> Option<f64> {
        let apart_mm = 2.0 * self.roller_offset_mm * sin(0.5 * self.pitch_rad());
        let depth_mm = 2.0 * self.roller_radius_mm - apart_mm;
        // Six rollers of the paper's touch, and rounding must not decide.
        (self.rollers > 1 && depth_mm > 1e-6).then_some(depth_mm)
    }

    /// Returns psi, rad; negative where rollers engage for too long.
    pub(crate) fn psi_rad(&self, roller: &RollerVolume) -> f64 {
        PI - roller.engagement_rad() - 2.0 * self.contact_angle_rad + 2.0 * roller.inset_rad()
    }

    /// Returns the angle by which the pulse of the inlet begins behind that of the outlet, rad:
    /// psi = 2 pi - Lam - phi.
    ///
    /// A roller is fully engaged over Lam = pi + 2 beta - 2 inset. For a measured roller volume
    /// psi = pi - phi - 2 beta (McIntyre et al.).
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::EngagementTooLong`] if psi is negative.
    pub fn inlet_phase_rad(&self, roller: &RollerVolume) -> Result<f64, ModelError> {
        let psi = self.psi_rad(roller);
        if psi >= 0.0 {
            Ok(psi)
        } else {
            Err(ModelError::EngagementTooLong {
                engagement_deg: roller.engagement_deg(),
                span_deg: degrees(self.sealed_span_rad(roller.inset_rad())),
                psi_deg: degrees(psi),
            })
        }
    }
}
