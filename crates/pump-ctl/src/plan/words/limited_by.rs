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
    /// No limit binds. The dose cruises at the speed that was asked for.
    Nothing,
    /// The acceleration binds. The dose is too short to reach its cruise speed, or the envelope of a smooth
    /// flow.
    Acceleration,
    /// The motor's largest speed binds.
    Speed,
    /// The largest pressure at the discharge port binds.
    OutletPressure,
    /// The smallest pressure at the suction port binds.
    InletPressure,
    /// The smallest pressure at the discharge port binds. A long line makes it where the flow falls.
    OutletSuction,
    /// The motor's torque binds.
    Torque,
}

impl LimitedBy {
    /// Every limit that has a name of its own. [`Self::OutletSuction`] shares the name of
    /// [`Self::OutletPressure`].
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

    /// Returns the limit's name in reports. Both limits of the pressure at the discharge port are
    /// `outlet_pressure`.
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

    /// Reads a name that [`Self::name`] gives. The name `outlet_pressure` is [`Self::OutletPressure`].
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let named = Self::ALL.into_iter().find(|limit| limit.name() == name);
        named.ok_or_else(|| UnknownName::new("limited_by", name, &Self::NAMES))
    }
}
