//! Resistance R from flows and the pressures that they take: dP = R Q.

use crate::error::{Allowed, Parameter};

use super::error::{IdentificationError, within};
use super::estimate::Estimate;
use super::least_squares::{StraightLine, Terms};
use super::readings::Readings;
use super::sought_parameter::SoughtParameter;

/// Steady flow and the pressure that it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowPoint {
    /// Flow through the line, mL/s, of either sign.
    pub flow_ml_s: f64,
    /// Pressure at the line's beginning less that at its end, kPa, in the direction of positive flow.
    pub drop_kpa: f64,
    /// Standard uncertainty of the pressure, kPa, positive. Points weigh by the ratios of these; 1 for all
    /// weighs them equally.
    pub standard_kpa: f64,
}

/// A resistance that grows with the flow: dP = R Q + K Q|Q|, as bends and turbulence make it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Bend {
    /// Resistance R at no flow, kPa s/mL.
    pub at_no_flow_kpa_s_ml: Estimate,
    /// Coefficient K of the bend, kPa s²/mL².
    pub per_flow_kpa_s2_ml2: Estimate,
    /// Standard deviation of the points about the bent line, in units of their standard uncertainties.
    pub scatter: f64,
}

impl Bend {
    /// Returns R at a flow, drop over flow, kPa s/mL.
    pub fn resistance_kpa_s_ml(&self, flow_ml_s: f64) -> f64 {
        self.at_no_flow_kpa_s_ml.value + self.per_flow_kpa_s2_ml2.value * flow_ml_s.abs()
    }
}

/// Resistance R by weighted least squares (McIntyre et al.: R = dP/Q).
///
/// ```
/// use pump_model::identification::{FlowPoint, ResistanceFit};
/// let points = [(10.0, 1.11), (20.0, 2.21), (40.0, 4.44), (60.0, 6.64)];
/// let points = points.map(|(flow_ml_s, drop_kpa)| FlowPoint { flow_ml_s, drop_kpa, standard_kpa: 1.0 });
/// let fit = ResistanceFit::of(&points, false)?;
/// assert!((fit.resistance_kpa_s_ml.value - 0.1108).abs() < 2.0 * fit.resistance_kpa_s_ml.standard);
/// assert!(fit.resistance_kpa_s_ml.standard < 2e-4 && fit.bend.is_none());
/// # Ok::<(), pump_model::identification::IdentificationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResistanceFit {
    /// Resistance R of the straight line, kPa s/mL.
    pub resistance_kpa_s_ml: Estimate,
    /// Drop at no flow, kPa, if it was sought: a reservoir or a sensor that is off.
    pub offset_kpa: Option<Estimate>,
    /// Drop at no flow, kPa, if it was not sought and yet stands out. It is then more than twice its standard
    /// uncertainty and explains the points better than a bend does.
    pub missed_offset_kpa: Option<Estimate>,
    /// Standard deviation of the points about the straight line, in units of their standard uncertainties:
    /// kPa if those are 1.
    pub scatter: f64,
    /// Bent line, if its bend is more than twice its standard uncertainty. R then holds only at flows like
    /// the points'.
    pub bend: Option<Bend>,
}

impl ResistanceFit {
    /// Fits a line through the origin, or with an offset.
    ///
    /// # Errors
    ///
    /// Refuses values that are not allowed, too few points, and points that do not determine the resistance.
    pub fn of(points: &[FlowPoint], with_offset: bool) -> Result<Self, IdentificationError> {
        for (n, point) in points.iter().enumerate() {
            within((Parameter::Flow, Readings::FlowPoints, n), point.flow_ml_s, Allowed::FINITE)?;
            within((Parameter::PressureDrop, Readings::FlowPoints, n), point.drop_kpa, Allowed::FINITE)?;
            let standard = (Parameter::PressureUncertainty, Readings::FlowPoints, n);
            within(standard, point.standard_kpa, Allowed::POSITIVE)?;
        }
        let with = |offset, bend| {
            let points = points.iter().map(|point| (point.flow_ml_s, point.drop_kpa, point.standard_kpa));
            StraightLine::about(0.0, points, Terms { offset, slope: true, bend })?.estimated()
        };
        let through = |bend| with(with_offset, bend);
        let parameters = Terms { offset: with_offset, slope: true, bend: false }.count();
        if points.len() <= parameters {
            let given = points.len();
            return Err(IdentificationError::TooFew {
                given,
                of: Readings::FlowPoints,
                needed: parameters + 1,
                parameters,
            });
        }
        let undetermined = |why| IdentificationError::Undetermined {
            of: Readings::FlowPoints,
            parameter: SoughtParameter::Resistance,
            why,
        };
        let straight = through(false).ok_or(undetermined("they are all at one flow; measure at several"))?;
        let resistance = straight.slope;
        if !straight.is_rising() {
            return Err(undetermined("the pressure does not rise with the flow; check signs and columns"));
        }
        if !resistance.differs_from_zero() {
            return Err(undetermined(
                "twice its standard error exceeds it; measure more points, at larger flows",
            ));
        }
        let missed = if with_offset { None } else { with(true, false) };
        let missed = missed.filter(|line| line.offset.differs_from_zero());
        if missed.is_some_and(|line| !line.is_rising() || !line.slope.differs_from_zero()) {
            return Err(undetermined(
                "the drop is as large at every flow; check columns and reservoir, or measure at larger flows",
            ));
        }
        let bent = through(true).filter(|bent| bent.bend.differs_from_zero());
        let missed = missed.filter(|line| bent.is_none_or(|bent| line.scatter < bent.scatter));
        Ok(Self {
            resistance_kpa_s_ml: resistance,
            offset_kpa: with_offset.then_some(straight.offset),
            missed_offset_kpa: missed.map(|line| line.offset),
            scatter: straight.scatter,
            bend: bent.map(|bent| Bend {
                at_no_flow_kpa_s_ml: bent.slope,
                per_flow_kpa_s2_ml2: bent.bend,
                scatter: bent.scatter,
            }),
        })
    }

    /// Returns the drop of the straight line at a flow, kPa.
    pub fn drop_kpa(&self, flow_ml_s: f64) -> f64 {
        self.offset_kpa.map_or(0.0, |offset| offset.value) + self.resistance_kpa_s_ml.value * flow_ml_s
    }
}
