//! Engagement of a roller from the drawing alone: the roller's angles and the volume that it displaces.
//!
//! McIntyre et al. measure that volume and leave its derivation open. Here the backplate is an arc that goes
//! over into a straight at y = 0, and the tube lies against both. Where the roller comes closer to the
//! backplate than the tube is thick, the bore is flattened by the difference h, 2 r_i at most. The flattened
//! bore is a stadium of unchanged perimeter, which has lost pi h²/4 of its area.

use libm::{acos, asin, atan2, cos, sin, sqrt};

use core::f64::consts::{FRAC_PI_2, PI};

use crate::error::{ModelError, Parameter, refused};
use crate::head::geometry::Geometry;

use super::quadrature;

/// A pump's dimensions as its drawing gives them, and the engagement of a roller that follows from them.
///
/// Angles are of the shaft, from the roller's first contact with the tube on.
///
/// ```
/// use pump_model::{Drawing, Geometry, Variant, units::degrees};
/// let drawing = Drawing::new(&Geometry::published(3, Variant::Measured))?;
/// assert!((degrees(drawing.engagement_rad()) - 66.8).abs() < 0.05);
/// assert!((drawing.volume_ml(drawing.engagement_rad()) - 2.2267).abs() < 1e-4);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawing {
    geometry: Geometry,
    /// Distance of the tube's inner side from the shaft, rho = r_b - 2 r_o, mm.
    inner_mm: f64,
    /// Angle of the roller's axis at first contact, eta_c, rad before the arc's end.
    contact_rad: f64,
}

impl Drawing {
    /// Checks the dimensions and finds the angle of first contact.
    ///
    /// # Errors
    ///
    /// Refuses dimensions with which no roller can work ([`Geometry::validate`]) and a roller that reaches
    /// around the shaft. Also refuses a roller so small (about as its tube's bore) that it dips into the tube
    /// with its flank. The flow then jumps in a way that this squeeze does not describe.
    pub fn new(geometry: &Geometry) -> Result<Self, ModelError> {
        geometry.validate()?;
        let Geometry { roller_radius_mm, roller_offset_mm, .. } = *geometry;
        let inner_mm = geometry.backplate_radius_mm - 2.0 * geometry.tube_outer_radius_mm;
        let refused = |allowed| Err(refused(Parameter::RollerRadius, roller_radius_mm, allowed));
        let least_square = roller_offset_mm * roller_offset_mm - inner_mm * inner_mm;
        if roller_radius_mm * roller_radius_mm <= least_square {
            let least_mm = sqrt(least_square);
            return Err(ModelError::RollerTooSmall { radius_mm: roller_radius_mm, least_mm });
        }
        if roller_radius_mm >= roller_offset_mm {
            return refused("less than the roller offset, or the roller would reach around the shaft");
        }
        let contact_rad = acos((inner_mm - roller_radius_mm) / roller_offset_mm);
        Ok(Self { geometry: *geometry, inner_mm, contact_rad })
    }

    /// Returns the depth by which neighbouring rollers overlap in space, mm. `None` if they do not.
    ///
    /// See [`Geometry::rollers_overlap_mm`].
    pub fn rollers_overlap_mm(&self) -> Option<f64> {
        self.geometry.rollers_overlap_mm()
    }

    /// Returns the angle beyond the arc's end at which contact begins, rad:
    /// eta_c = acos((r_b - 2 r_o - r_roller) / r_offset).
    pub fn contact_rad(&self) -> f64 {
        self.contact_rad
    }

    /// Returns the engagement angle phi, rad: from first contact until the roller has left the straight.
    ///
    /// phi = eta_c + acos((rho² + r_offset² - r_roller²) / (2 rho r_offset)) with rho = r_b - 2 r_o.
    pub fn engagement_rad(&self) -> f64 {
        self.contact_rad + self.half_width_rad(0.0)
    }

    /// Returns the angle at which the roller first closes the tube, rad:
    /// theta_c = eta_c - acos((r_b - r_roller - 2 (r_o - r_i)) / r_offset).
    pub fn closure_rad(&self) -> f64 {
        let wall_mm = self.geometry.tube_outer_radius_mm - self.geometry.bore_radius_mm;
        let near_mm = self.geometry.backplate_radius_mm - self.geometry.roller_radius_mm - 2.0 * wall_mm;
        self.contact_rad - acos((near_mm / self.geometry.roller_offset_mm).min(1.0))
    }

    /// Returns the volume V(theta) displaced at `theta_rad` after first contact, mL.
    ///
    /// Gauss-Legendre quadrature between the corners of h gives V to 1e-10 of itself. V is constant beyond
    /// [`Self::engagement_rad`].
    pub fn volume_ml(&self, theta_rad: f64) -> f64 {
        if theta_rad <= 0.0 {
            return 0.0;
        }
        let eta = self.contact_rad - theta_rad.min(self.engagement_rad());
        let area_mm2 = |h_mm: f64| PI * h_mm * h_mm / 4.0;
        let straight_mm3 = self.over_straight(eta, area_mm2);
        let mean_radius_mm = self.geometry.backplate_radius_mm - self.geometry.tube_outer_radius_mm;
        let arc_mm3 = mean_radius_mm * self.over_arc(eta, area_mm2);
        1e-3 * (straight_mm3 + arc_mm3)
    }

    /// Returns the slope g(theta) = dV/dtheta, mL/rad.
    ///
    /// On the straight, h over y - r_offset sin eta depends on theta through r_offset cos eta alone. On the
    /// arc, h over p - eta does not depend on theta at all. The arc's part is therefore its end at y = 0,
    /// where both have the same h.
    pub fn slope_ml_rad(&self, theta_rad: f64) -> f64 {
        if theta_rad <= 0.0 || theta_rad >= self.engagement_rad() {
            return 0.0;
        }
        let eta = self.contact_rad - theta_rad;
        let offset_mm = self.geometry.roller_offset_mm;
        let (x_mm, y_mm) = (offset_mm * cos(eta), offset_mm * sin(eta));
        let bore_mm = 2.0 * self.geometry.bore_radius_mm;
        // The squeeze h does not grow where the bore is closed.
        let growth = |h_mm: f64| if h_mm < bore_mm { FRAC_PI_2 * h_mm } else { 0.0 };
        let end_mm = self.squeeze_at_end_mm(eta);
        let mean_radius_mm = self.geometry.backplate_radius_mm - self.geometry.tube_outer_radius_mm;
        let boundary_mm3 = PI * end_mm * end_mm / 4.0 * (mean_radius_mm - x_mm);
        1e-3 * (y_mm * self.over_straight(eta, growth) + boundary_mm3)
    }

    /// Returns the angles at which V is not smooth, in rising order.
    ///
    /// These are first contact and full engagement, and the angle at which the closed bore appears. The
    /// others are the angles at which an end of the contact (h = 0) or of the closed bore (h = 2 r_i) passes
    /// the arc's end.
    pub(crate) fn corners_rad(&self) -> [f64; 6] {
        let (contact, closed) =
            (self.half_width_rad(0.0), self.half_width_rad(2.0 * self.geometry.bore_radius_mm));
        let eta = self.contact_rad;
        let mut corners =
            [0.0, (eta - contact).max(0.0), self.closure_rad(), eta - closed, eta + closed, eta + contact];
        corners.sort_unstable_by(f64::total_cmp);
        corners
    }

    /// Returns the angle at the shaft between the roller's axis and the point of its surface at
    /// rho + `squeeze_mm`, rad.
    fn half_width_rad(&self, squeeze_mm: f64) -> f64 {
        let Geometry { roller_radius_mm: radius, roller_offset_mm: offset, .. } = self.geometry;
        let reach = self.inner_mm + squeeze_mm;
        acos(((reach * reach + offset * offset - radius * radius) / (2.0 * reach * offset)).min(1.0))
    }

    /// Returns the squeeze h at y = 0, mm.
    fn squeeze_at_end_mm(&self, eta: f64) -> f64 {
        let Geometry { roller_radius_mm: radius, roller_offset_mm: offset, .. } = self.geometry;
        let (x_mm, y_mm) = (offset * cos(eta), offset * sin(eta));
        if y_mm.abs() >= radius {
            return 0.0;
        }
        self.clipped(x_mm + sqrt(radius * radius - y_mm * y_mm) - self.inner_mm)
    }

    fn clipped(&self, squeeze_mm: f64) -> f64 {
        squeeze_mm.clamp(0.0, 2.0 * self.geometry.bore_radius_mm)
    }

    /// Returns the integral of a function of h over y > 0, mm times the function's unit.
    ///
    /// The integral runs over the angle t at the roller's axis, y = r_offset sin eta + r_roller sin t. There
    /// the squeeze h = r_offset cos eta + r_roller cos t - rho has no singularity near the roller's flank.
    fn over_straight(&self, eta: f64, of_squeeze: impl Fn(f64) -> f64) -> f64 {
        let Geometry { roller_radius_mm: radius, roller_offset_mm: offset, .. } = self.geometry;
        let (x_mm, y_mm) = (offset * cos(eta), offset * sin(eta));
        if y_mm <= -radius {
            return 0.0;
        }
        let first = asin((-y_mm / radius).clamp(-1.0, 1.0));
        // Beyond the roller nothing is squeezed.
        let corner = |squeeze_mm: f64| acos(((self.inner_mm + squeeze_mm - x_mm) / radius).clamp(0.0, 1.0));
        let (touch, closed) = (corner(0.0), corner(2.0 * self.geometry.bore_radius_mm));
        quadrature::between(first.max(-touch), touch, [-closed, closed], |t| {
            let squeeze_mm = self.clipped(x_mm + radius * cos(t) - self.inner_mm);
            of_squeeze(squeeze_mm) * radius * cos(t)
        })
    }

    /// Returns the integral of a function of h over the polar angle p < 0, rad times the function's unit.
    ///
    /// The integral runs over the angle t at the roller's axis. The roller's surface is R from the shaft,
    /// R² = r_offset² + r_roller² + 2 r_offset r_roller cos t. Then h = R - rho and
    /// dp = (r_roller² + r_offset r_roller cos t) / R² dt.
    fn over_arc(&self, eta: f64, of_squeeze: impl Fn(f64) -> f64) -> f64 {
        let Geometry { roller_radius_mm: radius, roller_offset_mm: offset, .. } = self.geometry;
        let y_mm = offset * sin(eta);
        let last = if y_mm.abs() < radius {
            atan2(-y_mm, sqrt(radius * radius - y_mm * y_mm)) - eta
        } else if eta > 0.0 {
            return 0.0;
        } else {
            PI
        };
        let corner = |squeeze_mm: f64| {
            let reach = self.inner_mm + squeeze_mm;
            let cosine = (reach * reach - offset * offset - radius * radius) / (2.0 * offset * radius);
            acos(cosine.clamp(-1.0, 1.0))
        };
        let (touch, closed) = (corner(0.0), corner(2.0 * self.geometry.bore_radius_mm));
        quadrature::between(-touch, last.min(touch), [-closed, closed], |t| {
            let square = offset * offset + radius * radius + 2.0 * offset * radius * cos(t);
            let squeeze_mm = self.clipped(sqrt(square) - self.inner_mm);
            of_squeeze(squeeze_mm) * (radius * radius + offset * radius * cos(t)) / square
        })
    }
}
