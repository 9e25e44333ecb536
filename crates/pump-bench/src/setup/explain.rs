//! The facts of the errors of a first run, for programs.

use super::error::SetupError;
use crate::notice::Remedy;
use crate::report::{ErrorFacts, ErrorKind, Explain};

impl Explain for SetupError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Usage);
        match self {
            Self::Missing { what } => facts.value("nothing").allowed(what),
            Self::Name { name } => facts.value(name).allowed("1 to 64 of a-z, 0-9, - and _"),
            Self::Taken { name, .. } => facts.value(name).allowed("a name that no pump has"),
            Self::UnknownHead { name, nearest } => facts.value(name).allowed(nearest),
            Self::Rollers { published, rollers, .. } => facts.value(rollers).allowed(published),
            Self::Lift { lift_m, most_m, .. } => {
                facts.value(format!("{lift_m} m")).allowed(format!("less than {most_m:.2} m"))
            }
            Self::Bore { ml_per_rev, bore_mm, least_ml, most_ml } => facts
                .value(format!("{ml_per_rev} mL beside a bore of {bore_mm} mm"))
                .allowed(format!("{least_ml} to {most_ml} mL")),
            Self::Axis { axis, name, .. } => {
                facts.value(axis).allowed(format!("an axis other than that of {name}"))
            }
            Self::Socket { socket, name, .. } => {
                facts.value(socket).allowed(format!("a socket other than that of {name}"))
            }
            Self::Current { current_a, allowed, .. } => {
                facts.value(format!("{current_a} A")).allowed(allowed)
            }
            Self::Microsteps { microsteps, allowed, .. } => facts.value(microsteps).allowed(allowed),
            Self::Fast { rate_ml_s, most_ml_s, .. } => {
                facts.value(format!("{rate_ml_s} mL/s")).allowed(format!("{most_ml_s} mL/s at most"))
            }
            Self::Slow { rate_ml_s, least_ml_s, most_ml_s, .. }
            | Self::Board { rate_ml_s, least_ml_s, most_ml_s, .. } => {
                facts.value(format!("{rate_ml_s} mL/s")).allowed(format!("{least_ml_s} to {most_ml_s} mL/s"))
            }
            Self::NoPlace => ErrorFacts::of(ErrorKind::Config),
            Self::File { path, source, .. } => ErrorFacts::of_file(ErrorKind::Output, path, source),
            Self::Damaged { path, .. } => ErrorFacts::of(ErrorKind::Input).value(path.display()),
            Self::Changed { path } => ErrorFacts::of(ErrorKind::Output).value(path.display()),
            Self::Model(error) => error.facts(),
            Self::PumpFile(error) => error.facts(),
            Self::Config(error) => error.facts(),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        match self {
            Self::UnknownHead { .. } => vec![Remedy::ListHeads],
            Self::Fast { .. } => vec![Remedy::StateMaxSpeed],
            Self::Changed { .. } => vec![Remedy::ChangeFileAlone],
            Self::PumpFile(error) => error.remedies(),
            Self::Config(error) => error.remedies(),
            _ => Vec::new(),
        }
    }
}
