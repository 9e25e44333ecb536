//! The refusal of a dose that cannot be planned.

use core::fmt;

use pump_model::{Allowed, ModelError, Port, Shown};
use thiserror::Error;

use crate::parameter::Parameter;

use super::set_by::SetBy;
use crate::step::Direction;

/// The fastest dose that holds every limit, in the terms of the request.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Nearest {
    /// Mean flow at the cruise speed.
    Flow {
        /// Mean flow, mL/s.
        ml_s: f64,
    },
    /// Cruise speed of the pump head.
    Speed {
        /// Speed of the pump head, r/min.
        rpm: f64,
    },
    /// Total time, settling included.
    Within {
        /// Total time, s.
        time_s: f64,
    },
    /// No speed that was tried holds every limit.
    Nothing,
    /// The line breaks a pressure limit of the user at rest, so no speed holds it.
    RestBreaks,
}

impl fmt::Display for Nearest {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flow { ml_s } => write!(to, "{ml_s} mL/s is the fastest that holds every limit"),
            Self::Speed { rpm } => write!(to, "{rpm} r/min is the fastest that holds every limit"),
            Self::Within { time_s } => {
                write!(to, "{time_s} s is the shortest time that holds every limit")
            }
            Self::Nothing => write!(to, "no speed holds every limit"),
            Self::RestBreaks => write!(
                to,
                "the line breaks it at rest: limits are absolute, so add the ambient pressure to a gauge one, or \
                 write that with its unit, as 20kPag"
            ),
        }
    }
}

/// A volume for people: in µL where mL would need many zeros.
struct Volume(f64);

impl fmt::Display for Volume {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let microlitres = 1e3 * self.0;
        if (0.001..100.0).contains(&microlitres.abs()) {
            write!(to, "{microlitres:.3} µL")
        } else if (1e-6..0.001).contains(&microlitres.abs()) {
            write!(to, "{:.3} nL", 1e3 * microlitres)
        } else {
            write!(to, "{} mL", Shown(self.0))
        }
    }
}

/// Returns the port that discharges in this direction.
fn discharge(direction: Direction) -> &'static str {
    match direction {
        Direction::Forward => Port::Outlet.name(),
        Direction::Reverse => Port::Inlet.name(),
    }
}

/// The refusal of a dose, with the nearest dose that is possible where there is one.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PlanError {
    /// A parameter is outside its range.
    #[error("{parameter} is {}; allowed: {allowed}", Shown(*value))]
    OutOfRange {
        /// Parameter that was given.
        parameter: Parameter,
        /// Value that was given.
        value: f64,
        /// Values that are accepted.
        allowed: Allowed,
    },
    /// The volume is less than half a motor step.
    #[error(
        "{} with {} carried from earlier doses is less than half a motor step at this angle; the smallest \
         dose here is {}",
        Volume(*requested_ml), Volume(*carry_in_ml), Volume(*smallest_ml)
    )]
    LessThanHalfAStep {
        /// Volume asked for, mL.
        requested_ml: f64,
        /// Carry of earlier doses, mL.
        carry_in_ml: f64,
        /// Smallest dose from this angle, mL: half of the first step less the carry.
        smallest_ml: f64,
    },
    /// The dose takes more than 1e9 motor steps.
    #[error(
        "the dose would take {steps:.3e} motor steps; a dose may take 1e9 at most: dose less, or use fewer \
         microsteps"
    )]
    TooManySteps {
        /// Motor steps of the dose.
        steps: f64,
    },
    /// The flow needs more speed than the motor may have.
    #[error(
        "a rate of {} mL/s needs {} r/min; the pump's limit of {limit_rpm:.2} r/min gives \
         {limit_ml_s} mL/s at most",
        Shown(*flow_ml_s), Shown(*needed_rpm)
    )]
    RateTooHigh {
        /// Flow asked for, mL/s.
        flow_ml_s: f64,
        /// Speed that gives this flow, r/min.
        needed_rpm: f64,
        /// Speed limit, r/min.
        limit_rpm: f64,
        /// Flow at the speed limit, mL/s.
        limit_ml_s: f64,
    },
    /// The speed is above the motor's largest.
    #[error("a speed of {:.3} r/min is above the pump's limit of {limit_rpm:.2} r/min", Shown(*speed_rpm))]
    SpeedTooHigh {
        /// Speed asked for, r/min.
        speed_rpm: f64,
        /// Speed limit, r/min.
        limit_rpm: f64,
    },
    /// The dose would take more than 5e6 s, longer than any controller keeps time.
    #[error(
        "the dose would take {duration_s:.3e} s; a dose may take 5e6 s (58 days) at most: raise the rate or \
         allow less time"
    )]
    TooSlow {
        /// Duration of the dose, s.
        duration_s: f64,
    },
    /// The rotor is past the point at which it could still stop for the new volume.
    #[error(
        "the dose can no longer end at {} mL: the rotor has delivered {delivered_ml:.4} mL and can \
         stop after {nearest_ml:.4} mL at the earliest; let it stop, and dose the rest",
        Shown(*asked_ml)
    )]
    CannotStopThere {
        /// New volume of the dose, mL.
        asked_ml: f64,
        /// Volume delivered so far, mL.
        delivered_ml: f64,
        /// Volume of the dose if the rotor stops as soon as it can, mL.
        nearest_ml: f64,
    },
    /// The step lies at the end of the plan or beyond it.
    #[error("the plan has {steps} steps, so it cannot change after step {made}; change it before its end")]
    NoSuchStep {
        /// Number of the step that was given.
        made: u64,
        /// Steps of the plan.
        steps: u64,
    },
    /// The angle is so uncertain that a speed that follows it could make the flow less smooth.
    #[error(
        "a smooth flow needs the rollers' angle, which is {}: at this rate a speed that follows it could make a ripple \
         of {ripple_percent:.0} % (RMS), and constant speed makes {constant_percent:.0} %; {}, or dose at constant \
         speed",
        Known(*half_width_deg), Way(*half_width_deg)
    )]
    SmoothWithoutAngle {
        /// Half width of the start angle, deg.
        half_width_deg: f64,
        /// Worst RMS ripple of the flow if the speed changes at the wrong angles, %.
        ripple_percent: f64,
        /// RMS ripple of the flow at constant speed, %.
        constant_percent: f64,
    },
    /// The flow is nowhere low enough for an end at low flow.
    #[error(
        "a dose cannot end at low flow: the rollers deliver {least_ml_rad:.4} mL/rad or more at every angle, \
         and low flow is {limit_ml_rad:.4} mL/rad or less, half of the flow between pulses; let the dose end \
         anywhere"
    )]
    NoLowFlow {
        /// Smallest flow per radian at the outlet, mL/rad.
        least_ml_rad: f64,
        /// Largest flow that counts as low, mL/rad.
        limit_ml_rad: f64,
    },
    /// The angle is too uncertain for an end at low flow.
    #[error(
        "a dose that ends at low flow needs the rollers' angle, which is {}: the dose could end elsewhere in the \
         pitch; find the angle first, or let the dose end anywhere",
        Known(*half_width_deg)
    )]
    LowFlowWithoutAngle {
        /// Half width of the start angle, deg.
        half_width_deg: f64,
        /// Widest stretch of low flow, deg. It is 0 if nothing is known of the angle.
        widest_deg: f64,
    },
    /// Every end at low flow is farther from the volume than no dose at all.
    #[error(
        "no end at low flow is nearer to {} mL with the carry than no dose at all; ask for \
         {smallest_ml:.4} mL, the smallest dose from this angle that ends there, or let the dose end anywhere",
        Shown(*requested_ml)
    )]
    NoLowFlowEnd {
        /// Volume asked for, mL.
        requested_ml: f64,
        /// Volume of the first end at low flow less the carry, mL.
        smallest_ml: f64,
    },
    /// The motor steps are so coarse that none ends at low flow.
    #[error("a motor step of {step_deg:.3} degrees passes over all angles of low flow; use more microsteps")]
    LowFlowTooNarrow {
        /// Angle of a motor step at the pump head, deg.
        step_deg: f64,
    },
    /// No speed meets the time.
    #[error(
        "the dose cannot be done within {} s; the fastest found takes {fastest_s} s, settling \
         included",
        Shown(*asked_s)
    )]
    TimeTooShort {
        /// Time asked for, s.
        asked_s: f64,
        /// Time of the fastest dose, s.
        fastest_s: f64,
    },
    /// The pressure at the discharge port would be too high.
    #[error(
        "the {} pressure would reach {predicted_kpa:.2} kPa absolute, above the limit of {:.2} \
         kPa; {nearest}",
        discharge(*direction),
        Shown(*limit_kpa)
    )]
    OutletPressure {
        /// Direction of the dose. The outlet discharges in forward motion, and the inlet in reverse.
        direction: Direction,
        /// Largest predicted pressure, kPa absolute.
        predicted_kpa: f64,
        /// Limit of this pressure, kPa absolute.
        limit_kpa: f64,
        /// Fastest dose that holds every limit.
        nearest: Nearest,
    },
    /// The pressure at the suction port would be too low.
    #[error(
        "the {} pressure would fall to {predicted_kpa:.2} kPa absolute, below the limit of {:.2} \
         kPa{set_by}; {nearest}",
        discharge(direction.reversed()),
        Shown(*limit_kpa)
    )]
    InletPressure {
        /// Direction of the dose. The inlet sucks in forward motion, and the outlet in reverse.
        direction: Direction,
        /// Smallest predicted pressure, kPa absolute.
        predicted_kpa: f64,
        /// Limit of this pressure, kPa absolute.
        limit_kpa: f64,
        /// Origin of the limit.
        set_by: SetBy,
        /// Fastest dose that holds every limit.
        nearest: Nearest,
    },
    /// The pressure at the discharge port would be too low.
    #[error(
        "the {} pressure would fall to {predicted_kpa:.2} kPa absolute where the flow falls and the line \
         runs on, below the limit of {limit_kpa:.2} kPa{set_by}; {nearest}",
        discharge(*direction)
    )]
    OutletSuction {
        /// Direction of the dose. The outlet discharges in forward motion, and the inlet in reverse.
        direction: Direction,
        /// Smallest predicted pressure, kPa absolute.
        predicted_kpa: f64,
        /// Limit of this pressure, kPa absolute.
        limit_kpa: f64,
        /// Origin of the limit.
        set_by: SetBy,
        /// Fastest dose that holds every limit.
        nearest: Nearest,
    },
    /// The dose needs more torque than the motor has.
    #[error(
        "the motor would need {needed_n_m:.4} N m at a speed at which it has {limit_n_m:.4} N m; {nearest}"
    )]
    Torque {
        /// Predicted torque where it comes nearest to the motor's, N m.
        needed_n_m: f64,
        /// Torque of the motor at that speed, N m. It is 0 beyond the motor's last point.
        limit_n_m: f64,
        /// Fastest dose that holds every limit.
        nearest: Nearest,
    },
    /// The model refuses the dose.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Refuses a value of `parameter` that is not allowed.
pub(in crate::plan) fn within(parameter: Parameter, value: f64, allowed: Allowed) -> Result<(), PlanError> {
    if allowed.admits(value) { Ok(()) } else { Err(PlanError::OutOfRange { parameter, value, allowed }) }
}

/// How well an angle is known by its half width, in deg.
struct Known(f64);

impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 180.0 { write!(f, "known within {:.1} degrees", self.0) } else { f.write_str("unknown") }
    }
}

/// Way to a smooth flow from an angle of this half width, in degrees. At a rate that leaves the motor no room the speed
/// can hardly follow an angle, however well that is known.
struct Way(f64);

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0 < 180.0 {
            "dose more slowly, which leaves the speed room to follow, find the angle better"
        } else {
            "find the angle first"
        })
    }
}
