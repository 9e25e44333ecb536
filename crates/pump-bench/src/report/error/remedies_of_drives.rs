//! The remedies of the errors of drives.

use std::error::Error as StdError;

#[cfg(feature = "node")]
use pump_link::frame::VERSION;

use crate::drives::DriveError;
#[cfg(feature = "grbl")]
use crate::drives::GrblError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
#[cfg(feature = "node")]
use crate::drives::NodeError;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
use crate::drives::PortFault;
use crate::notice::Remedy;

impl DriveError {
    /// Returns the remedies that a person has. A device of another program has remedies of its own.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Unable { instead, .. } => vec![*instead],
            Self::Device(error) | Self::Refused(error) => {
                of_wiring(error.as_ref()).into_iter().chain(of_device(error.as_ref())).collect()
            }
            Self::Busy { .. }
            | Self::Interrupted
            | Self::Name { .. }
            | Self::Other { .. }
            | Self::NotGiven { .. }
            | Self::OtherDriver { .. }
            | Self::NoBoard { .. }
            | Self::NotBuilt { .. } => Vec::new(),
        }
    }
}

/// Returns the remedy of a motor that has no current because of how its board is wired, which shows before it moves.
fn of_wiring(error: &(dyn StdError + Send + Sync + 'static)) -> Option<Remedy> {
    #[cfg(feature = "node")]
    match error.downcast_ref::<NodeError>() {
        Some(NodeError::Estop) => return Some(Remedy::BridgeStop),
        Some(NodeError::Driver) => return Some(Remedy::CheckFaultLevel),
        _ => {}
    }
    let _ = error;
    None
}

/// Returns the remedy of a device's own error.
fn of_device(error: &(dyn StdError + Send + Sync + 'static)) -> Option<Remedy> {
    #[cfg(feature = "grbl")]
    if let Some(error) = error.downcast_ref::<GrblError>() {
        return of_grbl(error);
    }
    #[cfg(feature = "node")]
    if let Some(error) = error.downcast_ref::<NodeError>() {
        return of_node(error);
    }
    #[cfg(feature = "klipper")]
    if let Some(error) = error.downcast_ref::<KlipperError>() {
        return of_klipper(error);
    }
    let _ = error;
    None
}

/// Returns the remedy of a port that cannot be opened.
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
fn of_port(fault: &PortFault) -> Option<Remedy> {
    match fault {
        PortFault::Missing { .. } | PortFault::NoSerialLine { .. } => Some(Remedy::FindPort),
        PortFault::Forbidden => Some(Remedy::JoinPortGroup),
        PortFault::System(_) => None,
    }
}

/// Returns the remedy of an error of a node, where the text of the error does not say it.
#[cfg(feature = "node")]
fn of_node(error: &NodeError) -> Option<Remedy> {
    match error {
        NodeError::NoPort => Some(Remedy::NamePort),
        NodeError::Open { fault, .. } => of_port(fault),
        NodeError::Version { theirs, .. } if *theirs < VERSION => Some(Remedy::UpdateFirmware),
        NodeError::Version { .. } => Some(Remedy::UpdateProgram),
        NodeError::OtherBoard { .. } => Some(Remedy::AcceptBoard),
        NodeError::PlaceTaken(_) => Some(Remedy::TakePlace),
        NodeError::SessionRecord { .. } | NodeError::BoardRecord { .. } => Some(Remedy::WriteSettingsAnew),
        NodeError::Gone(_) => Some(Remedy::CheckCable),
        NodeError::Count { .. } => Some(Remedy::FindAngle),
        NodeError::Estop | NodeError::Driver => Some(Remedy::FindAngleIfLost),
        _ => None,
    }
}

/// Returns the remedy of an error of a Klipper board, where the text of the error does not say it.
#[cfg(feature = "klipper")]
fn of_klipper(error: &KlipperError) -> Option<Remedy> {
    match error {
        KlipperError::NoPort => Some(Remedy::NamePort),
        KlipperError::Open { fault, .. } => of_port(fault),
        KlipperError::OtherBoard { .. } => Some(Remedy::AcceptBoard),
        KlipperError::AfterReset { error, .. } => of_klipper(error),
        KlipperError::NoPins => Some(Remedy::WritePins),
        KlipperError::Configured { .. } => Some(Remedy::ResetBoard),
        KlipperError::PlaceTaken(_) => Some(Remedy::TakePlace),
        KlipperError::SessionRecord { .. } | KlipperError::BoardRecord { .. } => {
            Some(Remedy::WriteSettingsAnew)
        }
        KlipperError::Gone(_) => Some(Remedy::CheckCable),
        KlipperError::Count { .. } => Some(Remedy::FindAngle),
        KlipperError::Shutdown { .. } | KlipperError::HeldUp | KlipperError::DeadMan { .. } => {
            Some(Remedy::FindAngleIfLost)
        }
        _ => None,
    }
}

/// Returns the remedy of an error of a grbl board, where the text of the error does not say it.
#[cfg(feature = "grbl")]
fn of_grbl(error: &GrblError) -> Option<Remedy> {
    match error {
        GrblError::NoPort => Some(Remedy::NamePort),
        GrblError::Open { fault, .. } => of_port(fault),
        GrblError::Steep { .. } => Some(Remedy::ConfigureOrRaise),
        GrblError::SoftLimits => Some(Remedy::Configure),
        GrblError::SettingsChanged { .. } => Some(Remedy::AcceptSettings),
        GrblError::OtherBoard { .. } => Some(Remedy::AcceptBoard),
        GrblError::PlaceTaken(_) => Some(Remedy::TakePlace),
        GrblError::SettingsRecord { .. } | GrblError::BoardRecord { .. } => Some(Remedy::WriteSettingsAnew),
        GrblError::Gone(_) => Some(Remedy::CheckCable),
        GrblError::Count { .. } => Some(Remedy::FindAngle),
        _ => None,
    }
}
