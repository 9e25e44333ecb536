//! The change of a dose under way.

use super::cruise::Cruise;

/// A change of a dose under way: the moment, the new volume and the new speed.
///
/// ```
/// use pump_ctl::plan::{Cruise, Retarget};
///
/// let change = Retarget::new(6000, 30.0, Cruise::Flow { ml_s: 10.0 }).with_smooth(true);
/// assert_eq!((change.made, change.volume_ml, change.smooth), (6000, 30.0, Some(true)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Retarget {
    /// Number of steps of the plan that are made when the change takes over.
    pub made: u64,
    /// Volume of the whole dose, counted from its start, mL. Negative in reverse.
    pub volume_ml: f64,
    /// Speed of the rest. A time counts from the change.
    pub cruise: Cruise,
    /// Choice between a smooth flow and constant speed. `None` keeps that of the plan.
    pub smooth: Option<bool>,
}

impl Retarget {
    /// Makes a change that takes over when `made` steps are made. A smooth flow stays smooth.
    pub const fn new(made: u64, volume_ml: f64, cruise: Cruise) -> Self {
        Self { made, volume_ml, cruise, smooth: None }
    }

    /// Returns the change with a smooth flow of the rest, or with constant speed.
    #[must_use]
    pub const fn with_smooth(self, smooth: bool) -> Self {
        Self { smooth: Some(smooth), ..self }
    }
}
