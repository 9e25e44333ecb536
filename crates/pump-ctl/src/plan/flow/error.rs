//! The refusal of a flow over time.

use pump_model::{Port, Shown};
use thiserror::Error;

use crate::plan::words::{PlanError, SetBy};

/// The refusal of a flow over time, with the first row or instant that cannot be met. Rows count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FlowError {
    /// The motor or the start angle cannot be used.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The flow of the head reverses, so that no speed makes a flow at every angle.
    #[error(
        "the flow of this head reverses within a pitch, down to {least_ml_rad:.4} mL/rad; a flow over time needs a \
         head whose flow is positive at every angle"
    )]
    Reverses {
        /// Smallest flow per radian at the outlet, mL/rad.
        least_ml_rad: f64,
    },
    /// The start angle is not known to a motor step.
    #[error(
        "a flow over time needs the rollers' angle to a motor step of {step_deg:.4} degrees, and it is known within \
         {half_width_deg:.4} degrees only; find the angle first"
    )]
    UnsureAngle {
        /// Half width of the start angle, deg.
        half_width_deg: f64,
        /// Angle of a motor step, deg.
        step_deg: f64,
    },
    /// The time of a row is no number, negative, or not that of the start in the first row.
    #[error(
        "row {row} has the time {} s; allowed: 0 in the first row, and finite times that do not go back",
        Shown(*time_s)
    )]
    Time {
        /// Number of the row.
        row: u64,
        /// Time of the row, s.
        time_s: f64,
    },
    /// The time of a row lies before that of the row before.
    #[error("row {row} has the time {} s after {} s; times do not go back", Shown(*time_s), Shown(*before_s))]
    TimeGoesBack {
        /// Number of the row.
        row: u64,
        /// Time of the row, s.
        time_s: f64,
        /// Time of the row before, s.
        before_s: f64,
    },
    /// The flow of a row is no number.
    #[error("row {row} has the flow {} mL/s; allowed: finite flows", Shown(*flow_ml_s))]
    Flow {
        /// Number of the row.
        row: u64,
        /// Flow of the row, mL/s.
        flow_ml_s: f64,
    },
    /// The flow changes its direction.
    #[error(
        "row {row} has the flow {} mL/s against the direction of the rows before; a flow over time runs one way",
        Shown(*flow_ml_s)
    )]
    TurnsBack {
        /// Number of the row.
        row: u64,
        /// Flow of the row, mL/s.
        flow_ml_s: f64,
    },
    /// The flow has fewer than two instants, or never flows.
    #[error(
        "a flow over time has two rows or more at different times, and one with a flow; rows of this one: {rows}"
    )]
    Nothing {
        /// Number of rows.
        rows: u64,
    },
    /// The flow needs more speed than the motor may have.
    #[error(
        "at {time_s:.4} s, in the stretch to row {row}, the flow needs {needed_rpm:.2} r/min where the rollers stand \
         then; the pump's limit is {limit_rpm:.2} r/min"
    )]
    TooFast {
        /// Number of the row at the end of the stretch.
        row: u64,
        /// First instant at which the flow cannot be met, s.
        time_s: f64,
        /// Speed that gives the flow, r/min.
        needed_rpm: f64,
        /// Speed limit, r/min.
        limit_rpm: f64,
    },
    /// The flow needs more acceleration than the motor has.
    #[error(
        "at {time_s:.4} s, in the stretch to row {row}, the flow needs {needed_rad_s2:.1} rad/s2 where the rollers \
         stand then; the pump's limit is {limit_rad_s2:.1} rad/s2"
    )]
    TooSteep {
        /// Number of the row at the end of the stretch.
        row: u64,
        /// First instant at which the flow cannot be met, s.
        time_s: f64,
        /// Acceleration that gives the flow, rad/s².
        needed_rad_s2: f64,
        /// Acceleration limit, rad/s².
        limit_rad_s2: f64,
    },
    /// The flow steps so far that the rotor would leave it by more than a motor step.
    #[error(
        "at {time_s:.4} s, in row {row}, the flow steps from {} to {} mL/s; at the pump's acceleration the angle would \
         leave it by {} motor steps, and 1 is allowed: let the flow change over {least_s:.4} s or more",
        Shown(*from_ml_s), Shown(*to_ml_s), Shown(libm::ceil(100.0 * off_steps) / 100.0)
    )]
    Step {
        /// Number of the row after the step.
        row: u64,
        /// Time of the step, s.
        time_s: f64,
        /// Flow before the step, mL/s.
        from_ml_s: f64,
        /// Flow after the step, mL/s.
        to_ml_s: f64,
        /// Largest distance of the angle from the flow's, motor steps.
        off_steps: f64,
        /// Time in which the rotor changes its speed so far, s.
        least_s: f64,
    },
    /// The flow takes more than 1e9 motor steps.
    #[error("the flow would take more than 1e9 motor steps by {:.4} s, in row {row}", Shown(*time_s))]
    TooManySteps {
        /// Number of the row.
        row: u64,
        /// Time of the row, s.
        time_s: f64,
    },
    /// A pressure would break its limit.
    #[error(
        "at {time_s:.4} s, in the stretch to row {row}, the pressure at the {port} would reach {reached_kpa:.2} kPa; \
         allowed: {} {limit_kpa:.2} kPa{set_by}",
        if *is_most { "at most" } else { "at least" }
    )]
    Pressure {
        /// Number of the row at the end of the stretch.
        row: u64,
        /// First instant at which the limit cannot be kept, s.
        time_s: f64,
        /// Port at which the pressure is reached.
        port: Port,
        /// Pressure with the change by the motor's steps, kPa absolute.
        reached_kpa: f64,
        /// Limit, kPa absolute.
        limit_kpa: f64,
        /// True if the limit is the largest pressure that is allowed.
        is_most: bool,
        /// Origin of the limit.
        set_by: SetBy,
    },
    /// The flow would take more torque than the motor has.
    #[error(
        "at {time_s:.4} s, in the stretch to row {row}, the flow would take {needed_n_m:.3} N m; the motor has \
         {limit_n_m:.3} N m at that speed"
    )]
    Torque {
        /// Number of the row at the end of the stretch.
        row: u64,
        /// First instant at which the motor has too little torque, s.
        time_s: f64,
        /// Torque that is needed, N m.
        needed_n_m: f64,
        /// Torque that the motor has, N m.
        limit_n_m: f64,
    },
}

impl FlowError {
    /// Returns the refusal with another number of its row, as that of a line in a file. `of` gets the number from 1.
    #[must_use]
    pub fn with_row(mut self, of: impl FnOnce(u64) -> u64) -> Self {
        match &mut self {
            Self::Time { row, .. }
            | Self::TimeGoesBack { row, .. }
            | Self::Flow { row, .. }
            | Self::TurnsBack { row, .. }
            | Self::TooFast { row, .. }
            | Self::TooSteep { row, .. }
            | Self::Step { row, .. }
            | Self::TooManySteps { row, .. }
            | Self::Pressure { row, .. }
            | Self::Torque { row, .. } => *row = of(*row),
            Self::Plan(_) | Self::Reverses { .. } | Self::UnsureAngle { .. } | Self::Nothing { .. } => {}
        }
        self
    }
}
