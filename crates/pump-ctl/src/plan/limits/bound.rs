//! A limit of a motion by the role of the port at which it holds.

use pump_model::Port;

use super::limits::Limits;
use crate::plan::words::LimitedBy;
use crate::step::Direction;

/// A limit of a motion by the role of the port at which it holds. Which port has the role depends on the
/// direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::plan) enum Bound {
    /// The largest pressure at the discharge port.
    DischargePressure,
    /// The smallest pressure at the discharge port.
    DischargeSuction,
    /// The smallest pressure at the suction port.
    Suction,
    /// The motor's torque.
    Torque,
}

impl Bound {
    /// Returns the limit by the port at which it is reached in this direction.
    pub(in crate::plan) fn limited_by(self, direction: Direction) -> LimitedBy {
        let [sucking, pushing] = Limits::ports(direction);
        match self {
            Self::DischargePressure => match pushing {
                Port::Inlet => LimitedBy::InletPressure,
                Port::Outlet => LimitedBy::OutletPressure,
            },
            Self::DischargeSuction => suction(pushing),
            Self::Suction => suction(sucking),
            Self::Torque => LimitedBy::Torque,
        }
    }
}

/// Returns the limit that the smallest pressure at a port sets.
fn suction(port: Port) -> LimitedBy {
    match port {
        Port::Inlet => LimitedBy::InletSuction,
        Port::Outlet => LimitedBy::OutletSuction,
    }
}
