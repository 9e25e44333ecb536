//! `[pump]`: the pump's name and its defaults.

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, allow, within_if_given};

/// The table `[pump]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PumpTable {
    /// Identifier of the pump: lower-case letters, digits, `-` and `_`. It names the folder of the pump's
    /// record.
    pub id: String,
    /// Name of the pump, for people.
    pub name: String,
    /// Rate of a dose that names no rate, in mL/s.
    pub default_rate_ml_s: f64,
    /// Angle at which the rotor's mark meets the housing's mark, in deg. `None` if there are no marks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mark_angle_deg: Option<f64>,
}

impl PumpTable {
    /// Refuses an identifier that names no folder, and a mark beyond one turn. The default rate is not
    /// checked here.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        allow(
            (1..=64).contains(&self.id.len()) && self.id.chars().all(letters),
            "[pump] id",
            format_args!("`{}`", self.id),
            "1 to 64 of a-z, 0-9, - and _",
        )?;
        within_if_given("[pump] mark_angle_deg", self.mark_angle_deg, -360.0..=360.0)
    }
}
