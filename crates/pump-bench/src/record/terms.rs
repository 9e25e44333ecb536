//! The terms of a dose besides its volume.

use pump_ctl::plan::{Cruise, PressureLimits, Ramps};
use serde::{Deserialize, Serialize};

/// Terms of a dose besides its volume, in the form of the journal. The rest of a dose that was cut off keeps
/// to them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DoseTerms {
    /// Cruise speed, in rad/s. For a smooth flow it is the mean speed. `None` if a flow or the fastest speed
    /// was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) cruise_rad_s: Option<f64>,
    /// Mean flow asked for, in mL/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) flow_ml_s: Option<f64>,
    /// True if the fastest speed was asked for.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) fastest: bool,
    /// True if the speed followed the rollers' angle for a smooth flow.
    #[serde(default)]
    pub(crate) smooth: bool,
    /// True if the dose was to end at low flow.
    #[serde(default)]
    pub(crate) low_flow: bool,
    /// True if a balance was to end the dose. The announced steps then lead to the most that may be delivered.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) by_weight: bool,
    /// Reading before a dose by weight, its mass and its ceiling. `None` for other doses, and for those by weight that
    /// an earlier version began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) weighing: Option<WeighingTerms>,
    /// True if the motion was to go on until it is stopped. The announced steps then lead to the most that one run
    /// makes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) until_stopped: bool,
    /// True for a flow over time by a profile, of which no rest can be made.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) profile: bool,
    /// Ramps that were asked for. `None` took those of the drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ramps: Option<Ramps>,
    /// Pressure limit at the discharge port, in kPa absolute. `None` takes the pump file's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) max_outlet_kpa: Option<f64>,
    /// Pressure limit at the suction port, in kPa absolute. `None` takes the pump file's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) min_inlet_kpa: Option<f64>,
}

/// Terms of a dose that a balance is to end. A later command goes on with the same balance and vessel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WeighingTerms {
    /// Reading of the balance before the dose, in g.
    pub(crate) tare_g: f64,
    /// Mass that the balance is to show for the dose, in g.
    pub(crate) target_g: f64,
    /// Most volume by the model that the pump may turn for, in mL.
    pub(crate) most_ml: f64,
}

impl DoseTerms {
    /// Returns terms with a cruise. A dose within a time keeps the speed `planned_rad_s` that meets the time.
    pub(crate) fn cruising(cruise: Cruise, planned_rad_s: f64) -> Self {
        let terms = Self::default();
        match cruise {
            Cruise::Flow { ml_s } => Self { flow_ml_s: Some(ml_s), ..terms },
            Cruise::Speed { rad_s } => Self { cruise_rad_s: Some(rad_s), ..terms },
            Cruise::Within { .. } => Self { cruise_rad_s: Some(planned_rad_s), ..terms },
            Cruise::Fastest => Self { fastest: true, ..terms },
        }
    }

    /// Returns the cruise of the terms. `None` if an entry of an early version does not tell it.
    pub(crate) fn cruise(&self) -> Option<Cruise> {
        match (self.fastest, self.flow_ml_s, self.cruise_rad_s) {
            (true, ..) => Some(Cruise::Fastest),
            (false, Some(ml_s), _) => Some(Cruise::Flow { ml_s }),
            (false, None, speed) => speed.map(|rad_s| Cruise::Speed { rad_s }),
        }
    }

    /// Returns the pressure limits of the terms.
    pub(crate) fn pressures(&self) -> PressureLimits {
        PressureLimits { max_outlet_kpa: self.max_outlet_kpa, min_inlet_kpa: self.min_inlet_kpa }
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
