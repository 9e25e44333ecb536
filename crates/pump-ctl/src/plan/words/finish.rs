//! The place in a pitch at which a dose may end.

use core::fmt;
use core::str::FromStr;

use super::unknown_name::UnknownName;

/// The place in a pitch at which a dose may end.
///
/// ```
/// use pump_ctl::plan::Finish;
///
/// assert_eq!("low-flow".parse(), Ok(Finish::LowFlow));
/// assert_eq!(Finish::Any.to_string(), "any");
/// let refused = "low".parse::<Finish>().unwrap_err();
/// assert_eq!(refused.to_string(), "finish is 'low'; allowed: 'any', 'low-flow'");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Finish {
    /// The dose may end anywhere.
    #[default]
    Any,
    /// The dose ends at low flow, where a step delivers little. The flow per radian q_out is there at most
    /// half of its value between pulses, [`pump_model::Pump::nominal_ml_rad`]. It is positive there, also on a
    /// head whose flow reverses. A stop there leaves least to drip, and steps are at most half as coarse.
    LowFlow,
}

impl Finish {
    /// Every finish, in the order of messages.
    pub const ALL: [Self; 2] = [Self::Any, Self::LowFlow];

    const NAMES: [&'static str; 2] = [Self::Any.name(), Self::LowFlow.name()];

    /// Returns the finish's name in the command, in Python and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::LowFlow => "low-flow",
        }
    }
}

impl fmt::Display for Finish {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(self.name())
    }
}

impl FromStr for Finish {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let named = Self::ALL.into_iter().find(|finish| finish.name() == name);
        named.ok_or_else(|| UnknownName::new("finish", name, &Self::NAMES))
    }
}
