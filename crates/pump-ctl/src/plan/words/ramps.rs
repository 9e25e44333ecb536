//! The choice of the ramps of a dose.

use core::fmt;
use core::str::FromStr;

use super::unknown_name::UnknownName;

/// The choice of the ramps, in which a dose starts and stops.
///
/// ```
/// use pump_ctl::plan::Ramps;
///
/// assert_eq!("fastest".parse(), Ok(Ramps::Fastest));
/// assert_eq!(Ramps::default().to_string(), "line");
/// assert_eq!("line-aware".parse(), Ok(Ramps::LineAware), "the name of earlier versions");
/// let refused = "slow".parse::<Ramps>().unwrap_err();
/// assert_eq!(refused.to_string(), "ramps is 'slow'; allowed: 'line', 'fastest'");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Ramps {
    /// The ramps leave the outlet's line nearly at rest. Motion and settling end soonest among the ramps whose
    /// back flow stays below 2 uL, in a dose below 200 uL below a hundredth of it or half a step, or among those with
    /// the least back flow.
    #[default]
    LineAware,
    /// The ramps have the largest acceleration of the motor.
    Fastest,
}

impl Ramps {
    /// Every choice of ramps, in the order of messages.
    pub const ALL: [Self; 2] = [Self::LineAware, Self::Fastest];

    const NAMES: [&'static str; 2] = [Self::LineAware.name(), Self::Fastest.name()];

    /// Name of [`Self::LineAware`] in earlier versions, which is still read.
    pub const EARLIER_NAME: &'static str = "line-aware";

    /// Returns the choice's name in the command, in Python and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LineAware => "line",
            Self::Fastest => "fastest",
        }
    }
}

impl fmt::Display for Ramps {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(self.name())
    }
}

impl FromStr for Ramps {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        if name == Self::EARLIER_NAME {
            return Ok(Self::LineAware);
        }
        let named = Self::ALL.into_iter().find(|ramps| ramps.name() == name);
        named.ok_or_else(|| UnknownName::new("ramps", name, &Self::NAMES))
    }
}
