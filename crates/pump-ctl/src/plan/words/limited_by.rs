//! The limit that keeps a dose from being faster.

use core::fmt;
use core::str::FromStr;

use super::unknown_name::UnknownName;

/// The limit that keeps a dose from being faster.
///
/// ```
/// use pump_ctl::plan::LimitedBy;
///
/// assert_eq!("inlet_pressure".parse(), Ok(LimitedBy::InletPressure));
/// assert_eq!(LimitedBy::Nothing.to_string(), "none");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitedBy {
    /// No limit: the dose cruises at the speed that was asked for.
    Nothing,
    /// The acceleration: the dose is too short to reach that speed, or the envelope of a smooth flow.
    Acceleration,
    /// The motor's largest speed.
    Speed,
    /// The pressure at the port that pushes.
    OutletPressure,
    /// The pressure at the port that sucks.
    InletPressure,
    /// Too little pressure at the port that pushes, as a long line makes where the flow falls.
    OutletSuction,
    /// The torque that the motor has.
    Torque,
}

impl LimitedBy {
    /// Every limit that has a name of its own. [`Self::OutletSuction`] shares that of [`Self::OutletPressure`].
    pub const ALL: [Self; 6] = [
        Self::Nothing,
        Self::Speed,
        Self::Acceleration,
        Self::OutletPressure,
        Self::InletPressure,
        Self::Torque,
    ];

    const NAMES: [&'static str; 6] = [
        Self::Nothing.name(),
        Self::Speed.name(),
        Self::Acceleration.name(),
        Self::OutletPressure.name(),
        Self::InletPressure.name(),
        Self::Torque.name(),
    ];

    /// The limit's name in reports. Both limits of the pressure at the port that pushes are `outlet_pressure`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "none",
            Self::Acceleration => "acceleration",
            Self::Speed => "speed",
            Self::OutletPressure | Self::OutletSuction => "outlet_pressure",
            Self::InletPressure => "inlet_pressure",
            Self::Torque => "torque",
        }
    }
}

impl fmt::Display for LimitedBy {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(self.name())
    }
}

impl FromStr for LimitedBy {
    type Err = UnknownName;

    /// Reads a name of [`Self::name`]; `outlet_pressure` is [`Self::OutletPressure`].
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let named = Self::ALL.into_iter().find(|limit| limit.name() == name);
        named.ok_or_else(|| UnknownName::new("limited_by", name, &Self::NAMES))
    }
}
