//! A dose that is asked for.

use pump_ctl::plan::{Cruise, Finish};

use crate::record::{Purpose, Terms};

/// What is asked of a bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoseRequest {
    /// Why.
    pub purpose: Purpose,
    /// mL; negative in reverse; not zero.
    pub volume_ml: f64,
    /// How fast; none takes the pump file's default rate.
    pub cruise: Option<Cruise>,
    /// Whether the speed follows the rollers' angle for a smooth flow.
    pub smooth: bool,
    /// Where in a pitch it may end; its retraction ends anywhere.
    pub finish: Finish,
    /// Where the rollers stand, rad; none takes the recorded angle.
    pub start_angle_rad: Option<f64>,
    /// Of the rest of a dose that was cut off the volume of the whole, mL; none if this is the whole.
    pub whole_ml: Option<f64>,
    /// What is sucked back after the dose, mL, positive; none sucks nothing back.
    pub retract_ml: Option<f64>,
    /// Limit at the port that pushes, kPa absolute; none takes the pump file's.
    pub max_outlet_kpa: Option<f64>,
    /// Limit at the port that sucks, kPa absolute; none takes the pump file's.
    pub min_inlet_kpa: Option<f64>,
}

impl DoseRequest {
    /// A dose with the pump file's defaults.
    pub fn dose(volume_ml: f64) -> Self {
        Self {
            purpose: Purpose::Dose,
            volume_ml,
            cruise: None,
            smooth: false,
            finish: Finish::Any,
            start_angle_rad: None,
            whole_ml: None,
            retract_ml: None,
            max_outlet_kpa: None,
            min_inlet_kpa: None,
        }
    }

    /// The request for the rest of a dose that was cut off: what it says itself, and the terms of the whole where it says
    /// nothing.
    pub(crate) fn for_rest(self, whole: &Terms) -> Self {
        Self {
            cruise: self.cruise.or(whole.cruise_rad_s.map(|rad_s| Cruise::Speed { rad_s })),
            smooth: self.smooth || whole.smooth,
            finish: if whole.low_flow { Finish::LowFlow } else { self.finish },
            max_outlet_kpa: self.max_outlet_kpa.or(whole.max_outlet_kpa),
            min_inlet_kpa: self.min_inlet_kpa.or(whole.min_inlet_kpa),
            ..self
        }
    }
}
