//! The duty of a pump: flow, fluid, hoses and lifts.

use crate::pump_file::{AmbientTable, HoseTable, LineSource, LineTable, PumpFile, Reservoir};
use crate::units::{HoseSize, Pressure};

use super::error::SizingError;

/// Young's modulus of a hose of which the size alone is known, in MPa: that of the hose of McIntyre et al.
const MODULUS_MPA: f64 = 3.5;

/// Poisson's ratio of rubber, which keeps its volume.
const POISSON_RATIO: f64 = 0.5;

/// Loss of a hose's ends in velocity heads: 0.5 for a sharp-edged entrance and 1.0 for the exit (Crane, Technical Paper
/// 410, appendix A).
const END_LOSSES: f64 = 1.5;

/// The duty that a pump is sized for. What is not given stays that of the pump file.
///
/// ```
/// use pump_bench::sizing::Duty;
///
/// let duty = Duty::new(2000.0 / 3600.0).with_fluid(Some("glycerol 50%".into()), Some(20.0));
/// assert_eq!(duty.temperature_degc, Some(20.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Duty {
    /// Mean flow, in mL/s.
    pub flow_ml_s: f64,
    /// Name of the fluid.
    pub fluid: Option<String>,
    /// Temperature of the fluid, in °C.
    pub temperature_degc: Option<f64>,
    /// Hose from the supply to the pump.
    pub inlet_hose: Option<HoseSize>,
    /// Hose from the pump to the vessel.
    pub outlet_hose: Option<HoseSize>,
    /// Height of the pump above the supply's surface, in mm.
    pub suction_lift_mm: Option<f64>,
    /// Height of the vessel above the pump, in mm.
    pub discharge_lift_mm: Option<f64>,
    /// Surroundings of the pump.
    pub ambient: Option<AmbientTable>,
    /// Largest pressure that is allowed at the outlet.
    pub max_outlet: Option<Pressure>,
}

impl Duty {
    /// Returns the duty of a mean flow in mL/s.
    pub fn new(flow_ml_s: f64) -> Self {
        Self {
            flow_ml_s,
            fluid: None,
            temperature_degc: None,
            inlet_hose: None,
            outlet_hose: None,
            suction_lift_mm: None,
            discharge_lift_mm: None,
            ambient: None,
            max_outlet: None,
        }
    }

    /// Returns the duty with the name of the fluid and its temperature in °C.
    #[must_use]
    pub fn with_fluid(self, fluid: Option<String>, temperature_degc: Option<f64>) -> Self {
        Self { fluid, temperature_degc, ..self }
    }

    /// Returns the duty with the hoses at inlet and outlet.
    #[must_use]
    pub fn with_hoses(self, inlet_hose: Option<HoseSize>, outlet_hose: Option<HoseSize>) -> Self {
        Self { inlet_hose, outlet_hose, ..self }
    }

    /// Returns the duty with the lifts of suction and discharge, in mm.
    #[must_use]
    pub fn with_lifts(self, suction_lift_mm: Option<f64>, discharge_lift_mm: Option<f64>) -> Self {
        Self { suction_lift_mm, discharge_lift_mm, ..self }
    }

    /// Returns the duty with the surroundings of the pump.
    #[must_use]
    pub fn with_ambient(self, ambient: Option<AmbientTable>) -> Self {
        Self { ambient, ..self }
    }

    /// Returns the duty with the largest pressure that is allowed at the outlet.
    #[must_use]
    pub fn with_max_outlet(self, max_outlet: Option<Pressure>) -> Self {
        Self { max_outlet, ..self }
    }

    /// Returns a pump file with the duty's fluid, hoses, lifts and surroundings in place of its own. The resistance of
    /// a hose is taken at the duty's flow.
    pub(super) fn file(&self, mut file: PumpFile) -> Result<PumpFile, SizingError> {
        file.fluid = file.fluid.changed_to(self.fluid.as_deref(), self.temperature_degc)?;
        file.ambient = self.ambient.unwrap_or(file.ambient);
        if !file.ambient.is_possible() {
            return Err(SizingError::Air { kpa: file.ambient.pressure_kpa });
        }
        self.lay(&mut file.inlet, self.inlet_hose, self.suction_lift_mm);
        self.lay(&mut file.outlet.line, self.outlet_hose, self.discharge_lift_mm);
        file.pump.default_rate_ml_s = self.flow_ml_s;
        if let Some(most) = self.max_outlet {
            file.limits.max_outlet_kpa = Some(most.absolute_kpa(file.ambient.pressure_kpa));
        }
        for (line, side) in [(&file.inlet, "inlet"), (&file.outlet.line, "outlet")] {
            if line.is_unknown() {
                return Err(SizingError::NoLine { side });
            }
        }
        Ok(file)
    }

    /// Puts a hose and a lift in place of those of a line.
    fn lay(&self, line: &mut LineTable, hose: Option<HoseSize>, lift_mm: Option<f64>) {
        if let Some(lift_mm) = lift_mm {
            line.reservoir = Reservoir::Lift(lift_mm);
        }
        match (hose, &mut line.source) {
            (Some(hose), source) => *source = LineSource::Hose(table(&hose, self.flow_ml_s)),
            (None, LineSource::Hose(own)) => own.resistance_at_ml_s = Some(self.flow_ml_s),
            (None, _) => {}
        }
    }
}

/// Returns the table of a hose of which the size alone is known.
fn table(hose: &HoseSize, flow_ml_s: f64) -> HoseTable {
    HoseTable {
        bore_radius_mm: 0.5 * hose.tube.bore_mm,
        outer_radius_mm: 0.5 * hose.tube.outer_mm,
        length_mm: hose.length_mm,
        modulus_mpa: MODULUS_MPA,
        poisson_ratio: POISSON_RATIO,
        minor_loss: END_LOSSES,
        resistance_at_ml_s: Some(flow_ml_s),
    }
}
