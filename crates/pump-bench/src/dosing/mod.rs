//! One dose: its request, its plan and prediction, and its uncertainty.

#[cfg(test)]
mod coverage;
mod displaced_pumps;
mod error;
mod flow_profile;
mod planner;
mod prepared;
mod request;
mod retraction;
mod ripple;
mod schedule;
mod stands;
mod swept;
mod tube_life;
mod uncertainty;
pub(crate) mod unknown_angle;
mod warnings;

pub(crate) use displaced_pumps::DisplacedPumps;
pub use error::{DoseError, NoRestByWeight, WeightFault};
pub use flow_profile::{FlowProfile, FlowWayOut, ProfileError};
pub use prepared::Prepared;
pub(crate) use prepared::{cruise_of, settle_of_s};
pub use request::{DoseRequest, RunBound, RunEnd};
pub use retraction::Retraction;
pub(crate) use ripple::{PulseErrors, SureRipples, sure_ripples};
pub use ripple::{RippleAt, RippleReport};
pub use schedule::{MAX_DOSES, Missed, Schedule, ScheduleAction, ScheduleError};
pub(crate) use stands::Stands;
pub(crate) use swept::Swept;
pub use tube_life::LifeUnit;
pub(crate) use tube_life::TubeLife;
#[cfg(test)]
pub(crate) use uncertainty::Budget;
pub(crate) use uncertainty::one_more;
pub(crate) use uncertainty::outlet::drop_ml;
pub(crate) use uncertainty::pressure_uncertainty_kpa;
pub(crate) use uncertainty::weighed_shares;
pub use uncertainty::{Share, SharePrior, ShareSource};
pub(crate) use unknown_angle::disturbed;
pub(crate) use warnings::copied_uncertainty;
