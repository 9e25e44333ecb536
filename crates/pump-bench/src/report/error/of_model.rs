//! The facts of errors of the model, the planner and the fits.

use pump_ctl::plan::{FlowError, PlanError};
use pump_model::identification::IdentificationError;
use pump_model::{IntegrationError, ModelError, Shown};

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::displacement::DisplacementError;
use crate::simulation::MethodError;

impl Explain for ModelError {
    fn facts(&self) -> ErrorFacts {
        match self {
            Self::OutOfRange { value, allowed, .. } => {
                ErrorFacts::of(ErrorKind::Range).value(Shown(*value)).allowed(allowed)
            }
            _ => ErrorFacts::of(ErrorKind::Model),
        }
    }
}

impl Explain for FlowError {
    fn facts(&self) -> ErrorFacts {
        let limit = || ErrorFacts::of(ErrorKind::Limit);
        let range = || ErrorFacts::of(ErrorKind::Range);
        match self {
            Self::Plan(error) => error.facts(),
            Self::Reverses { .. } => ErrorFacts::of(ErrorKind::Plan),
            Self::UnsureAngle { half_width_deg, step_deg } => ErrorFacts::of(ErrorKind::Angle)
                .value(format!("{half_width_deg:.4} deg"))
                .allowed(format!("{step_deg:.4} deg at most")),
            Self::Time { time_s, .. } => range()
                .value(format!("{} s", Shown(*time_s)))
                .allowed("0 s first, then times that do not go back"),
            Self::TimeGoesBack { time_s, before_s, .. } => range()
                .value(format!("{} s", Shown(*time_s)))
                .allowed(format!("{} s or more", Shown(*before_s))),
            Self::Flow { flow_ml_s, .. } | Self::TurnsBack { flow_ml_s, .. } => {
                range().value(format!("{} mL/s", Shown(*flow_ml_s)))
            }
            Self::Nothing { rows } => range().value(format!("{rows} rows")),
            Self::TooFast { needed_rpm, limit_rpm, .. } => limit()
                .value(format!("{needed_rpm:.2} r/min"))
                .allowed(format!("{limit_rpm:.2} r/min at most")),
            Self::TooSteep { needed_rad_s2, limit_rad_s2, .. } => limit()
                .value(format!("{needed_rad_s2:.1} rad/s2"))
                .allowed(format!("{limit_rad_s2:.1} rad/s2 at most")),
            Self::Step { off_steps, .. } => {
                limit().value(format!("{off_steps:.1} steps")).allowed("1 step at most")
            }
            Self::TooManySteps { .. } => limit().allowed("1e9 steps at most"),
            Self::Pressure { reached_kpa, limit_kpa, is_most, .. } => {
                let bound = if *is_most { "at most" } else { "at least" };
                limit().value(format!("{reached_kpa:.2} kPa")).allowed(format!("{limit_kpa:.2} kPa {bound}"))
            }
            Self::Torque { needed_n_m, limit_n_m, .. } => {
                limit().value(format!("{needed_n_m:.3} N m")).allowed(format!("{limit_n_m:.3} N m at most"))
            }
            _ => limit(),
        }
    }
}

impl Explain for PlanError {
    fn facts(&self) -> ErrorFacts {
        let limit = || ErrorFacts::of(ErrorKind::Limit);
        let plan = || ErrorFacts::of(ErrorKind::Plan);
        match self {
            Self::OutOfRange { value, allowed, .. } => {
                ErrorFacts::of(ErrorKind::Range).value(Shown(*value)).allowed(allowed)
            }
            Self::LessThanHalfAStep { requested_ml, smallest_ml, .. } => {
                plan().value(ml(*requested_ml)).allowed(format!("{} or more", ml(*smallest_ml)))
            }
            Self::TooManySteps { steps } => {
                limit().value(format!("{steps:.3e} steps")).allowed("1e9 steps at most")
            }
            Self::RateTooHigh { flow_ml_s, limit_ml_s, .. } => limit()
                .value(format!("{} mL/s", Shown(*flow_ml_s)))
                .allowed(format!("{limit_ml_s} mL/s at most")),
            Self::SpeedTooHigh { speed_rpm, limit_rpm } => limit()
                .value(format!("{:.3} r/min", Shown(*speed_rpm)))
                .allowed(format!("{limit_rpm:.2} r/min at most")),
            Self::TooSlow { duration_s } => {
                limit().value(format!("{duration_s:.3e} s")).allowed("5e6 s at most")
            }
            Self::CannotStopThere { asked_ml, nearest_ml, .. } => {
                plan().value(ml(*asked_ml)).allowed(format!("{} or more", ml(*nearest_ml)))
            }
            Self::NoSuchStep { made, steps } => {
                plan().value(format!("step {made}")).allowed(format!("before step {steps}"))
            }
            Self::SmoothWithoutAngle { half_width_deg, .. }
            | Self::LowFlowWithoutAngle { half_width_deg, .. } => {
                ErrorFacts::of(ErrorKind::Angle).value(format!("± {half_width_deg:.1} deg"))
            }
            Self::NoLowFlow { .. } | Self::LowFlowTooNarrow { .. } => plan(),
            Self::NoLowFlowEnd { requested_ml, smallest_ml } => {
                plan().value(ml(*requested_ml)).allowed(format!("{} or more", ml(*smallest_ml)))
            }
            Self::TimeTooShort { asked_s, fastest_s } => {
                limit().value(format!("{} s", Shown(*asked_s))).allowed(format!("{fastest_s} s or more"))
            }
            Self::OutletPressure { predicted_kpa, limit_kpa, .. } => limit()
                .value(format!("{predicted_kpa:.2} kPa"))
                .allowed(format!("{limit_kpa:.2} kPa absolute at most")),
            Self::InletPressure { predicted_kpa, limit_kpa, .. }
            | Self::OutletSuction { predicted_kpa, limit_kpa, .. } => limit()
                .value(format!("{predicted_kpa:.2} kPa"))
                .allowed(format!("{limit_kpa:.2} kPa absolute or more")),
            Self::Torque { needed_n_m, limit_n_m, .. } => {
                limit().value(format!("{needed_n_m:.4} N m")).allowed(format!("{limit_n_m:.4} N m at most"))
            }
            Self::Model(error) => error.facts(),
            _ => plan(),
        }
    }
}

fn ml(volume_ml: f64) -> String {
    format!("{} mL", Shown(volume_ml))
}

impl Explain for DisplacementError {
    fn facts(&self) -> ErrorFacts {
        let limit = ErrorFacts::of(ErrorKind::Limit);
        match self {
            Self::OutsideSpeeds { asked, least_rpm, most_rpm } => {
                limit.value(asked).allowed(format!("{least_rpm} to {most_rpm} r/min"))
            }
            Self::OutsideFlows { flow_ml_s, least_ml_s, most_ml_s, .. } => limit
                .value(format!("{} mL/s", Shown(*flow_ml_s)))
                .allowed(format!("{least_ml_s:.4} to {most_ml_s:.4} mL/s")),
            Self::NotConstant => ErrorFacts::of(ErrorKind::PumpFile),
            Self::Model(error) => error.facts(),
        }
    }
}

impl Explain for IdentificationError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Identification);
        match self {
            Self::TooFew { given, needed, .. } => facts.value(given).allowed(format!("{needed} at least")),
            Self::OutOfRange { value, allowed, .. } => facts.value(Shown(*value)).allowed(allowed),
            Self::Unexplained { explained_percent, least_percent } => facts
                .value(format!("{explained_percent:.1} %"))
                .allowed(format!("{least_percent} % at least")),
            _ => facts,
        }
    }
}

impl Explain for IntegrationError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of(ErrorKind::Model)
    }
}

impl Explain for MethodError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of(ErrorKind::Model)
    }
}
