//! The facts of errors of sizing.

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::notice::Remedy;
use crate::sizing::SizingError;

impl Explain for SizingError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Limit);
        match self {
            Self::NoHead { flow_ml_s, least_ml_s, most_ml_s, .. } => facts
                .value(format!("{flow_ml_s:.6} mL/s"))
                .allowed(format!("{least_ml_s:.6} to {most_ml_s:.6} mL/s")),
            Self::Speed { needed_rpm, least_rpm, most_rpm, .. } => facts
                .value(format!("{needed_rpm:.4} r/min"))
                .allowed(format!("{least_rpm} to {most_rpm} r/min")),
            Self::NoLine { side } => ErrorFacts::of(ErrorKind::Usage)
                .value(format!("no hose at the {side}"))
                .allowed("a hose, as 6x10mm,1m"),
            Self::Air { kpa } => facts.value(format!("{kpa} kPa")).allowed("1 to 10000 kPa"),
            Self::Suction(short) => facts
                .value(format!("{:.4} kPa", short.reached_kpa))
                .allowed(format!("{:.4} kPa at least", short.limit_kpa)),
            Self::Discharge(short) => facts
                .value(format!("{:.4} kPa", short.reached_kpa))
                .allowed(format!("{:.4} kPa at most", short.limit_kpa)),
            Self::Fluid(error) => error.facts(),
            Self::Model(error) => error.facts(),
            Self::Displacement(error) => error.facts(),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        match self {
            Self::NoHead { .. } => vec![Remedy::ListHeads],
            _ => Vec::new(),
        }
    }
}
