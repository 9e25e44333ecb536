//! Compliance C from a syringe that injects into a closed line: C = dV/dP.

use crate::error::{Allowed, Parameter};

use super::error::{IdentificationError, within};
use super::estimate::Estimate;
use super::least_squares::{StraightLine, Terms};
use super::readings::Readings;
use super::sought_parameter::SoughtParameter;

/// Injected volume and the pressure that it made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InjectionPoint {
    /// Volume injected since the start, mL; negative if drawn out.
    pub volume_ml: f64,
    /// Pressure in the closed line, kPa, absolute or above any constant pressure.
    pub pressure_kpa: f64,
}

/// Compliance C by least squares of the pressure over the volume. The volume of the syringe counts as exact,
/// and the sensor's noise is in the pressure.
///
/// ```
/// use pump_model::identification::{ComplianceFit, InjectionPoint};
/// let points = [(0.0, 88.6), (0.1, 91.4), (0.2, 94.2), (0.3, 96.9), (0.4, 99.7)];
/// let points = points.map(|(volume_ml, pressure_kpa)| InjectionPoint { volume_ml, pressure_kpa });
/// let fit = ComplianceFit::of(&points)?;
/// assert!((fit.compliance_ml_kpa.value - 0.0361).abs() < 2.0 * fit.compliance_ml_kpa.standard);
/// assert!((fit.bulk_modulus_kpa(26.0).value - 720.0).abs() < 3.0);
/// # Ok::<(), pump_model::identification::IdentificationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ComplianceFit {
    /// Compliance C, mL/kPa.
    pub compliance_ml_kpa: Estimate,
    /// Pressure before the injection, kPa, measured as the points are.
    pub start_kpa: Estimate,
    /// Standard deviation of the points about the line, kPa.
    pub scatter_kpa: f64,
    /// Slope dP/dV at the start, kPa/mL, and its change with the volume, kPa/mL².
    ///
    /// It is present if the change is more than twice its standard uncertainty. The line then stiffens or
    /// softens (air in it stiffens), and C holds only at pressures like the points'.
    pub bend: Option<(Estimate, Estimate)>,
}

impl ComplianceFit {
    /// Fits P = P_start + V/C.
    ///
    /// # Errors
    ///
    /// Refuses values that are not finite, fewer than three points, and points that do not determine the
    /// compliance.
    pub fn of(points: &[InjectionPoint]) -> Result<Self, IdentificationError> {
        for (n, point) in points.iter().enumerate() {
            within((Parameter::Volume, Readings::VolumePoints, n), point.volume_ml, Allowed::FINITE)?;
            within((Parameter::Pressure, Readings::VolumePoints, n), point.pressure_kpa, Allowed::FINITE)?;
        }
        let through = |bend| {
            let points = points.iter().map(|point| (point.volume_ml, point.pressure_kpa, 1.0));
            StraightLine::about(0.0, points, Terms { offset: true, slope: true, bend })?.estimated()
        };
        if points.len() < 3 {
            let given = points.len();
            return Err(IdentificationError::TooFew {
                given,
                of: Readings::VolumePoints,
                needed: 3,
                parameters: 2,
            });
        }
        let undetermined = |why| IdentificationError::Undetermined {
            of: Readings::VolumePoints,
            parameter: SoughtParameter::Compliance,
            why,
        };
        let straight = through(false).ok_or(undetermined("they are all at one volume; inject in steps"))?;
        if !straight.is_rising() {
            return Err(undetermined("the pressure does not rise with the volume; check signs and columns"));
        }
        if !straight.slope.differs_from_zero() {
            return Err(undetermined("twice its standard error exceeds it; inject more, in more steps"));
        }
        let bent = through(true).filter(|bent| bent.bend.differs_from_zero());
        Ok(Self {
            compliance_ml_kpa: straight.slope.inverse(),
            start_kpa: straight.offset,
            scatter_kpa: straight.scatter,
            bend: bent.map(|bent| (bent.slope, bent.bend)),
        })
    }

    /// Returns the pressure of the fit after an injection, kPa.
    pub fn pressure_kpa(&self, volume_ml: f64) -> f64 {
        self.start_kpa.value + volume_ml / self.compliance_ml_kpa.value
    }

    /// Returns the effective bulk modulus of a closed line that holds `total_ml`, kPa:
    /// B_e = dP V_total/dV = V_total/C (McIntyre et al.; their C = 1/B_e lacks the volume).
    pub fn bulk_modulus_kpa(&self, total_ml: f64) -> Estimate {
        self.compliance_ml_kpa.inverse().times(total_ml)
    }
}
