//! Why a dose cannot be planned.

use pump_model::ModelError;
use thiserror::Error;

/// A dose that is refused, with the nearest that could be had.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PlanError {
    /// A single parameter outside its range.
    #[error("{parameter} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// Name of the parameter, with its unit.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// What is accepted.
        allowed: &'static str,
    },
    /// Less than half a step.
    #[error(
        "{requested_ml} mL with {carry_in_ml:.6} mL carried from earlier doses is less than half a motor step at this \
         angle; the smallest dose here is {smallest_ml:.6} mL"
    )]
    LessThanHalfAStep {
        /// What was asked, mL.
        requested_ml: f64,
        /// What earlier doses owe, mL.
        carry_in_ml: f64,
        /// Half of the first step less the carry, mL.
        smallest_ml: f64,
    },
    /// More steps than anyone waits for.
    #[error(
        "the dose would take {steps:.3e} motor steps; a dose may take 1e9 at most: dose less, or use fewer microsteps"
    )]
    TooManySteps {
        /// How many.
        steps: f64,
    },
    /// The flow needs more speed than the motor may have.
    #[error(
        "a rate of {flow_ml_s} mL/s needs {needed_rpm:.2} r/min; the pump's limit of {limit_rpm:.2} r/min gives \
         {limit_ml_s:.3} mL/s at most"
    )]
    RateTooHigh {
        /// What was asked, mL/s.
        flow_ml_s: f64,
        /// Speed for it, r/min.
        needed_rpm: f64,
        /// Speed limit, r/min.
        limit_rpm: f64,
        /// Flow at the speed limit, mL/s.
        limit_ml_s: f64,
    },
    /// Faster than the motor may turn.
    #[error("a speed of {speed_rpm:.3} r/min is above the pump's limit of {limit_rpm:.2} r/min")]
    SpeedTooHigh {
        /// What was asked, r/min.
        speed_rpm: f64,
        /// Speed limit, r/min.
        limit_rpm: f64,
    },
    /// So slow that the dose would take longer than any controller keeps time.
    #[error(
        "the dose would take {duration_s:.3e} s; a dose may take 5e6 s (58 days) at most: raise the rate or allow less time"
    )]
    TooSlow {
        /// How long it would take, s.
        duration_s: f64,
    },
    /// The rotor cannot stop or turn round for the new volume.
    #[error(
        "a volume of {asked_ml} mL cannot be had any more: the rotor, which has delivered {delivered_ml:.4} mL, stands after \
         {nearest_ml:.4} mL at the earliest; let it stop, and dose the rest"
    )]
    CannotStopThere {
        /// New volume of the dose, mL.
        asked_ml: f64,
        /// What is delivered by then, mL.
        delivered_ml: f64,
        /// Volume of the dose if the rotor is stopped as soon as it can be, mL.
        nearest_ml: f64,
    },
    /// More steps than the plan has.
    #[error("the plan has {steps} steps; after {made} there is nothing to change")]
    NoSuchStep {
        /// What was given.
        made: u64,
        /// Steps of the plan.
        steps: u64,
    },
    /// The time is too short.
    #[error(
        "the dose cannot be done within {asked_s} s; the fastest found takes {fastest_s:.3} s, settling included"
    )]
    TimeTooShort {
        /// What was asked, s.
        asked_s: f64,
        /// Time of the fastest dose, s.
        fastest_s: f64,
    },
    /// Too much pressure where the pump pushes.
    #[error(
        "the outlet pressure would reach {predicted_kpa:.2} kPa absolute, above the limit of {limit_kpa:.2} kPa; \
         lower the rate"
    )]
    OutletPressure {
        /// Largest predicted pressure, kPa absolute.
        predicted_kpa: f64,
        /// The limit, kPa absolute.
        limit_kpa: f64,
    },
    /// Too little pressure where the pump sucks.
    #[error(
        "the inlet pressure would fall to {predicted_kpa:.2} kPa absolute, below the limit of {limit_kpa:.2} kPa; \
         lower the rate"
    )]
    InletPressure {
        /// Smallest predicted pressure, kPa absolute.
        predicted_kpa: f64,
        /// The limit, kPa absolute.
        limit_kpa: f64,
    },
    /// The model refuses.
    #[error(transparent)]
    Model(#[from] ModelError),
}
