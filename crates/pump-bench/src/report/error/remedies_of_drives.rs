//! The remedies of the errors of drives.

use crate::drives::DriveError;
#[cfg(feature = "grbl")]
use crate::drives::GrblError;
use crate::notice::Remedy;

impl DriveError {
    /// Returns the remedies that a person has. A device of another program has remedies of its own.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Unable { instead, .. } => vec![*instead],
            #[cfg(feature = "grbl")]
            Self::Device(error) => error.downcast_ref::<GrblError>().and_then(of_grbl).into_iter().collect(),
            #[cfg(not(feature = "grbl"))]
            Self::Device(_) => Vec::new(),
            Self::Busy { .. }
            | Self::Interrupted
            | Self::Name { .. }
            | Self::Other { .. }
            | Self::NotGiven { .. }
            | Self::NotBuilt { .. }
            | Self::Sim(_) => Vec::new(),
        }
    }
}

/// Returns the remedy of an error of a grbl board, where the text of the error does not say it.
#[cfg(feature = "grbl")]
fn of_grbl(error: &GrblError) -> Option<Remedy> {
    match error {
        GrblError::NoPort => Some(Remedy::NamePort),
        GrblError::Steep { .. } => Some(Remedy::ConfigureOrRaise),
        GrblError::SoftLimits => Some(Remedy::Configure),
        GrblError::SettingsChanged { .. } => Some(Remedy::AcceptSettings),
        GrblError::SettingsRecord { .. } => Some(Remedy::WriteSettingsAnew),
        GrblError::Gone(_) => Some(Remedy::CheckCable),
        GrblError::Count { .. } => Some(Remedy::FindAngle),
        _ => None,
    }
}
