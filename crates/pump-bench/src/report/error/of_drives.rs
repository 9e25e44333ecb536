//! The values of the errors of drives.

use std::error::Error as StdError;

#[cfg(feature = "node")]
use pump_link::frame::VERSION;

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::drives::DriveError;
#[cfg(feature = "grbl")]
use crate::drives::GrblError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
#[cfg(feature = "node")]
use crate::drives::NodeError;
use crate::notice::Remedy;

impl Explain for DriveError {
    fn facts(&self) -> ErrorFacts {
        let drive = ErrorFacts::of(ErrorKind::Drive);
        match self {
            Self::Busy { holder, .. } => ErrorFacts::of(ErrorKind::Busy).value(holder),
            Self::Interrupted => ErrorFacts::of(ErrorKind::Stopped),
            Self::Unable { driver, .. } | Self::NotGiven { id: driver } => drive.value(driver),
            Self::Device(error) | Self::Refused(error) => of_device(error.as_ref()).unwrap_or(drive),
            Self::Name { id, allowed } => drive.value(id).allowed(allowed),
            Self::Other { bench, given } => drive.value(given).allowed(bench),
            Self::OtherDriver { driver, named, .. } => drive.value(named).allowed(driver),
            Self::NoBoard { port, .. } => drive.value(port.display()),
            Self::NotBuilt { driver } => drive.value(driver),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}

/// Returns the facts of a device's own error, with the values that tell it from others.
fn of_device(error: &(dyn StdError + Send + Sync + 'static)) -> Option<ErrorFacts> {
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

/// Returns the facts of an error of a node that has a value.
#[cfg(feature = "node")]
fn of_node(error: &NodeError) -> Option<ErrorFacts> {
    let drive = ErrorFacts::of(ErrorKind::Drive);
    Some(match error {
        NodeError::Open { port, .. } | NodeError::Silent { port, .. } | NodeError::Foreign { port, .. } => {
            drive.value(port.display())
        }
        NodeError::OtherBoard { found, recorded, .. } => drive.value(found).allowed(recorded),
        NodeError::PlaceTaken(taken) => drive.value(&taken.place),
        NodeError::NoAxis { axis, axes } => {
            drive.value(format!("axis {axis}")).allowed(format!("the first {axes} of the axes X, Y, Z and A"))
        }
        NodeError::Version { theirs, .. } => {
            drive.value(format!("protocol version {theirs}")).allowed(format!("protocol version {VERSION}"))
        }
        NodeError::Fast { steps_s, most_s } | NodeError::Pulse { steps_s, most_s } => {
            drive.value(format!("{steps_s:.0} steps/s")).allowed(format!("{most_s} steps/s at most"))
        }
        NodeError::StepsTaken { steps_s, free_s, .. } => {
            drive.value(format!("{steps_s:.0} steps/s")).allowed(format!("{free_s} steps/s at most"))
        }
        NodeError::LineFull { needed_bytes_s, free_bytes_s, .. } => drive
            .value(format!("{needed_bytes_s} bytes/s"))
            .allowed(format!("{free_bytes_s} bytes/s at most")),
        NodeError::Estop => drive.value("emergency stop"),
        NodeError::Driver => drive.value("fault of the stepper driver"),
        NodeError::Count { counted, expected } => {
            drive.value(format!("{counted} steps")).allowed(format!("{expected} steps"))
        }
        _ => return None,
    })
}

/// Returns the facts of an error of a Klipper board that has a value.
#[cfg(feature = "klipper")]
fn of_klipper(error: &KlipperError) -> Option<ErrorFacts> {
    let drive = ErrorFacts::of(ErrorKind::Drive);
    Some(match error {
        KlipperError::Open { port, .. }
        | KlipperError::Silent { port, .. }
        | KlipperError::Foreign { port, .. }
        | KlipperError::Shared { port } => drive.value(port.display()),
        KlipperError::AfterReset { error, .. } => return of_klipper(error),
        KlipperError::PlaceTaken(taken) => drive.value(&taken.place),
        KlipperError::OtherFirmware { app, .. } => drive.value(app).allowed("Klipper"),
        KlipperError::OtherBoard { found, recorded, .. } => drive.value(found).allowed(recorded),
        KlipperError::Configured { found, wanted } => {
            drive.value(format!("{found:08x}")).allowed(format!("{wanted:08x}"))
        }
        KlipperError::Shutdown { reason } => drive.value(reason),
        KlipperError::Queue { commands, slots, .. } => {
            drive.value(format!("{commands} commands")).allowed(format!("{slots} commands at most"))
        }
        KlipperError::Line { needed_bytes_s, allowed_bytes_s } => drive
            .value(format!("{needed_bytes_s} bytes/s"))
            .allowed(format!("{allowed_bytes_s} bytes/s at most")),
        KlipperError::Count { counted, expected } => {
            drive.value(format!("{counted} steps")).allowed(format!("{expected} steps"))
        }
        _ => return None,
    })
}

/// Returns the facts of an error of a grbl board that has a value.
#[cfg(feature = "grbl")]
fn of_grbl(error: &GrblError) -> Option<ErrorFacts> {
    let drive = ErrorFacts::of(ErrorKind::Drive);
    Some(match error {
        GrblError::Open { port, .. } | GrblError::NoGrbl { port, .. } => drive.value(port.display()),
        GrblError::OtherBoard { found, recorded, .. } => drive.value(found).allowed(recorded),
        GrblError::PlaceTaken(taken) => drive.value(&taken.place),
        GrblError::Count { counted, expected } => {
            drive.value(format!("{counted} steps")).allowed(format!("{expected} steps"))
        }
        _ => return None,
    })
}
