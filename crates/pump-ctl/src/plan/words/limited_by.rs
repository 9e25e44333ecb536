//! The limit that keeps a dose from being faster.

use core::fmt;
use core::str::FromStr;

use super::unknown_name::UnknownName;

/// The limit that keeps a dose from being faster.
///
/// A pressure that binds has the name of its port, and of its side: `pressure` is the largest pressure allowed
/// there, `suction` the smallest. In reverse the outlet sucks and the inlet pushes.
///
/// ```
/// use pump_ctl::plan::LimitedBy;
///
/// assert_eq!("inlet_suction".parse(), Ok(LimitedBy::InletSuction));
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
    /// The smallest pressure at the inlet binds: the inlet sucks, or its line runs on where the flow falls in
    /// reverse.
    InletSuction,
    /// The largest pressure at the inlet binds, which pushes in reverse.
    InletPressure,
    /// The smallest pressure at the outlet binds: a long line runs on where the flow falls, or the outlet sucks
    /// in reverse.
    OutletSuction,
    /// The largest pressure at the outlet binds.
    OutletPressure,
    /// The motor's torque binds.
    Torque,
}

impl LimitedBy {
    /// Every limit.
    pub const ALL: [Self; 8] = [
        Self::Nothing,
        Self::Speed,
        Self::Acceleration,
        Self::InletSuction,
        Self::InletPressure,
        Self::OutletSuction,
        Self::OutletPressure,
        Self::Torque,
    ];

    const NAMES: [&'static str; 8] = [
        Self::Nothing.name(),
        Self::Speed.name(),
        Self::Acceleration.name(),
        Self::InletSuction.name(),
        Self::InletPressure.name(),
        Self::OutletSuction.name(),
        Self::OutletPressure.name(),
        Self::Torque.name(),
    ];

    /// Returns the limit's name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "none",
            Self::Acceleration => "acceleration",
            Self::Speed => "speed",
            Self::InletSuction => "inlet_suction",
            Self::InletPressure => "inlet_pressure",
            Self::OutletSuction => "outlet_suction",
            Self::OutletPressure => "outlet_pressure",
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

    /// Reads a name that [`Self::name`] gives.
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let named = Self::ALL.into_iter().find(|limit| limit.name() == name);
        named.ok_or_else(|| UnknownName::new("limited_by", name, &Self::NAMES))
    }
}
