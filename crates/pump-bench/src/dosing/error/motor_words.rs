//! Words for a motor whose drive failed.

use crate::drives::DriveError;
#[cfg(feature = "grbl")]
use crate::drives::GrblError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
#[cfg(feature = "node")]
use crate::drives::NodeError;

/// Says how the motor stands after an error of its drive in motion, with a comma before. `is_counted` is true if the
/// steps are known.
pub(super) fn motor_in_words(error: &DriveError, is_counted: bool) -> &'static str {
    let DriveError::Device(_source) = error else { return if is_counted { ", the motor holds" } else { "" } };
    #[cfg(feature = "node")]
    if let Some(error) = _source.downcast_ref::<NodeError>() {
        if error.cuts_current() {
            return ", the motor has no current";
        } else if error.hides_motor() {
            return "";
        }
    }
    #[cfg(feature = "klipper")]
    if let Some(error) = _source.downcast_ref::<KlipperError>() {
        if error.cuts_current() {
            return ", the motor has no current";
        } else if error.hides_motor() {
            return "";
        }
    }
    #[cfg(feature = "grbl")]
    if _source.downcast_ref().is_some_and(GrblError::hides_motor) {
        return "";
    }
    if is_counted { ", the motor holds" } else { "" }
}
