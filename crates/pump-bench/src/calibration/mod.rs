//! Calibrations: the displacement of a pump by weighed runs, with its uncertainty.

mod applied;
mod calibration;
mod checked;
mod date;
mod default_rate;
mod drift;
mod error;
mod fit;
mod last_dose;
mod making;
mod run;
mod run_log;
mod store;
mod verification;
mod weighing;

pub(crate) use applied::{Applied, Basis, Made, Sureness, WeighedTurn};
pub(crate) use calibration::head_in_words;
pub use calibration::{Calibration, Source};
pub use date::now as now_utc;
pub use default_rate::default_rate_left_out;
pub(crate) use default_rate::default_rate_uncovered;
pub use drift::{DRIFT_NEEDS, Drift, FactorAtTime};
pub use error::CalibrationError;
pub(crate) use fit::{AgainstSpeed, LawToFit, PulseSureness, Revolution, scatter_ml};
pub use fit::{
    Displacement, Expected, FittedPulse, LawFit, PhaseFit, Scatter, ScatterPrior, ShortDose, SpeedBend,
    short_doses_of_csv,
};
pub(crate) use last_dose::LastWeighing;
pub use last_dose::{Earlier, WeighedDose};
pub use making::Fit;
pub use run::{CalibrationRun, Reading, runs_of_csv};
pub(crate) use run::{PLAUSIBLE, turned_ml};
pub use run_log::{PlannedRuns, RunLog, UnfinishedRuns};
pub use store::{Calibrations, Stored};
pub use verification::{Tolerance, Verification, readings_of_csv};
pub(crate) use weighing::READ_DEGC;
pub use weighing::Weighing;
