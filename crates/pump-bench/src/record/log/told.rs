//! The part of an intent that only the log needs.

use serde::{Deserialize, Serialize};

use crate::record::{DosedFluid, ShortText};

/// Part of an intent that only the log needs. A dose that is cut off is logged by it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Told {
    /// Number that the dose gets in the log.
    pub(crate) number: u64,
    /// Local time less UTC at the start, in s.
    pub(crate) utc_offset_s: i32,
    /// Volume as it was typed. `None` if a program gave a number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) asked: Option<ShortText>,
    /// Expanded uncertainty (k = 2) of the planned volume, in mL. `None` for a retraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) expanded_uncertainty_ml: Option<f64>,
    /// Number of the calibration that the plan was made with. `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) calibration: Option<u32>,
    /// Volume of a dose by weight, in mL, that the entries of earlier commands have. An entry tells its own share.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) earlier_ml: f64,
    /// Rack of which the motion is a part. `None` for a pump by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) rack: Option<ShortText>,
    /// Order of a service by which the motion is made. `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) order: Option<ShortText>,
    /// Fluid that is pumped. `None` in an entry of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) fluid: Option<DosedFluid>,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
