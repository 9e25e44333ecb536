//! The whole dose of which a motion makes the rest.

use pump_ctl::plan::Turned;
use serde::{Deserialize, Serialize};

use super::intent::is_zero;

/// Whole dose of which a motion makes the rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Whole {
    /// Volume asked for in all, in mL. Negative in reverse.
    pub(crate) requested_ml: f64,
    /// Volume booked for the motions before this one, in mL.
    pub(crate) booked_ml: f64,
    /// Smallest volume of the motions before `turned`, in mL.
    pub(crate) least_ml: f64,
    /// Largest volume of the motions before `turned`, in mL.
    pub(crate) most_ml: f64,
    /// Turn of the dose before this motion, since the dose began or its rotor was last disturbed.
    pub(crate) turned: Turned,
    /// Volume that turns to find the angle pumped while the dose was unfinished, in mL, as [`Unfinished`] has it.
    ///
    /// [`Unfinished`]: super::Unfinished
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) searched_ml: f64,
}
