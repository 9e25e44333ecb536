//! The identity of a drive: what its record and its plans must know before it is opened.

use super::abilities::Abilities;
use super::drive::Drive;
use super::error::DriveError;
use super::registry;
use crate::pump_file::DriverName;

/// Names that a drive may have.
const NAMES: &str = "1 to 64 of a-z, 0-9, `-` and `_`";

/// Names that a drive may not have.
const TAKEN: &str = "not that of another drive, which pump files name";

/// Identity of a drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Identity {
    /// Name of the drive, and of the folder of its record.
    pub(crate) id: String,
    /// True if no motor moves.
    pub(crate) is_simulated: bool,
    /// Abilities of the drive, whatever device it finds.
    pub(crate) abilities: Abilities,
}

impl Identity {
    /// Returns the identity of `drive`.
    ///
    /// # Errors
    ///
    /// [`DriveError::Name`] if its name cannot name a folder, or is that of another drive.
    pub(crate) fn of(drive: &dyn Drive) -> Result<Self, DriveError> {
        let id = drive.id().to_owned();
        let letters = |letter: char| matches!(letter, 'a'..='z' | '0'..='9' | '-' | '_');
        if !(1..=64).contains(&id.len()) || !id.chars().all(letters) {
            return Err(DriveError::Name { id, allowed: NAMES });
        }
        let identity = Self { id, is_simulated: drive.is_simulated(), abilities: drive.abilities() };
        match identity.id.parse::<DriverName>() {
            Ok(named) if registry::identity(named) != identity => {
                Err(DriveError::Name { id: identity.id, allowed: TAKEN })
            }
            _ => Ok(identity),
        }
    }
}
