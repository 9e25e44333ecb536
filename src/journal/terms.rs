//! What was asked of a dose besides its volume.

use pump_ctl::plan::{Cruise, Finish};
use serde::{Deserialize, Serialize};

use crate::dose::{DoseRequest, Prepared};

/// What was asked of a dose besides its volume: the rest of one that is cut off keeps to it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Cruise speed, rad/s, of a smooth flow its mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cruise_rad_s: Option<f64>,
    /// Whether the speed followed the rollers' angle for a smooth flow.
    #[serde(default)]
    pub smooth: bool,
    /// Whether it was to end at low flow.
    #[serde(default)]
    pub low_flow: bool,
    /// Limit at the port that pushes, kPa absolute, in place of the pump file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_outlet_kpa: Option<f64>,
    /// Limit at the port that sucks, kPa absolute, in place of the pump file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_inlet_kpa: Option<f64>,
}

impl Terms {
    /// Those of a prepared dose.
    pub(crate) fn of(prepared: &Prepared) -> Self {
        let DoseRequest { smooth, finish, max_outlet_kpa, min_inlet_kpa, .. } = prepared.request;
        let cruise_rad_s = Some(prepared.plan.profile.cruise_rad_s());
        Self { cruise_rad_s, smooth, low_flow: finish == Finish::LowFlow, max_outlet_kpa, min_inlet_kpa }
    }

    /// What is asked of the rest: what `request` says, and these where it says nothing.
    pub(crate) fn of_rest(&self, request: DoseRequest) -> DoseRequest {
        DoseRequest {
            cruise: request.cruise.or(self.cruise_rad_s.map(|rad_s| Cruise::Speed { rad_s })),
            smooth: request.smooth || self.smooth,
            finish: if self.low_flow { Finish::LowFlow } else { request.finish },
            max_outlet_kpa: request.max_outlet_kpa.or(self.max_outlet_kpa),
            min_inlet_kpa: request.min_inlet_kpa.or(self.min_inlet_kpa),
            ..request
        }
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
