//! Displacements that the law of a pump does not give.

use pump_model::{ModelError, Shown};
use thiserror::Error;

/// A displacement that the pump file's law does not give.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DisplacementError {
    /// The law does not hold at the speed.
    #[error(
        "the pump file's speed law holds from {least_rpm} to {most_rpm} r/min, and {asked} is beyond; ask \
         for a speed within, or change least_rpm or most_rpm of its [speed_law] if it holds there, or write \
         kind = \"none\""
    )]
    OutsideSpeeds {
        /// Speed that was asked for, with its unit.
        asked: String,
        /// Slowest speed at which the law holds, in r/min.
        least_rpm: f64,
        /// Fastest speed at which the law holds, in r/min.
        most_rpm: f64,
    },
    /// The law gives the flow at no speed.
    #[error(
        "by the pump file's speed law the mean flow is {least_ml_s:.4} mL/s at {least_rpm:.4} r/min, its \
         slowest speed, and {most_ml_s:.4} mL/s at {at_rpm:.4} r/min at most, so {} mL/s is beyond; \
         ask for a flow within",
        Shown(*flow_ml_s)
    )]
    OutsideFlows {
        /// Flow that was asked for, in mL/s.
        flow_ml_s: f64,
        /// Flow at the slowest speed, in mL/s, rounded up.
        least_ml_s: f64,
        /// Slowest speed at which the law holds, in r/min.
        least_rpm: f64,
        /// Largest flow, in mL/s, rounded down.
        most_ml_s: f64,
        /// Speed of the largest flow, in r/min.
        at_rpm: f64,
    },
    /// The volume of a revolution depends on the speed where one volume is needed.
    #[error(
        "firmware plans with one volume of a revolution, and this file has a speed law; write kind = \"none\" \
         into its [speed_law] for the firmware"
    )]
    NotConstant,
    /// The model refuses the law or the pump.
    #[error(transparent)]
    Model(#[from] ModelError),
}
