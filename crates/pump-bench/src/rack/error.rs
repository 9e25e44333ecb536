//! Racks that cannot be run.

use std::path::PathBuf;

use thiserror::Error;

use crate::config::ConfigError;
use crate::dosing::DoseError;
use crate::notice::Remedy;
use crate::report::{Ending, ErrorFacts, ErrorKind, Explain, with_sources};
use crate::units::QuantityError;

/// Rack that cannot be run. Nothing has moved.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RackError {
    /// The file cannot be read.
    #[error("cannot read the rack {}", .path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Reason that the system gives.
        source: std::io::Error,
    },
    /// The text is not TOML, or it has unknown, missing or mistyped keys.
    #[error("rack {}: {message}", .path.display())]
    Syntax {
        /// Path of the file.
        path: PathBuf,
        /// Message of the parser, with line and column.
        message: String,
    },
    /// A value is not allowed.
    #[error("rack {}: {key} is `{value}`; allowed: {allowed}", .path.display())]
    Value {
        /// Path of the file.
        path: PathBuf,
        /// Key in the file, with the number of its step.
        key: String,
        /// Value in the file.
        value: String,
        /// Values that are allowed.
        allowed: String,
    },
    /// A quantity cannot be read.
    #[error("rack {}: {key}", .path.display())]
    Quantity {
        /// Path of the file.
        path: PathBuf,
        /// Key in the file, with the number of its step.
        key: String,
        /// Fault of the quantity.
        source: Box<QuantityError>,
    },
    /// A pump of the rack cannot be found or used.
    #[error("pump `{pump}` of the rack")]
    Pump {
        /// Name of the pump in the rack.
        pump: String,
        /// Fault of the pump.
        source: Box<ConfigError>,
    },
    /// Two pumps of the rack share something that one pump alone can have.
    #[error("the pumps `{pump}` and `{other}` of the rack {shared}; {instead}")]
    Shared {
        /// Name of a pump in the rack.
        pump: String,
        /// Name of the other pump.
        other: String,
        /// Thing that they share, in words.
        shared: String,
        /// Way out, in words.
        instead: &'static str,
    },
    /// Real motors keep no other pace than that of time.
    #[error(
        "pump `{pump}` of the rack has a real motor, which takes its time; the pace `fast` is for simulated ones"
    )]
    RealPace {
        /// Name of the pump in the rack.
        pump: String,
    },
    /// A step begins before the one before it.
    #[error(
        "step {step} of the rack begins at {at_s:.3} s, before step {before} at {before_s:.3} s; put the steps in the \
         order of their times"
    )]
    TimeGoesBack {
        /// Number of the step, from 1.
        step: usize,
        /// Begin of the step, in s.
        at_s: f64,
        /// Number of the step before.
        before: usize,
        /// Begin of the step before, in s.
        before_s: f64,
    },
    /// A pump would begin a step before it is done with another one.
    #[error(
        "step {step} of the rack begins at {at_s:.3} s, and pump `{pump}` is done with step {before} and its line has \
         settled at {done_s:.3} s; begin it then or later"
    )]
    Overlap {
        /// Name of the pump in the rack.
        pump: String,
        /// Number of the step, from 1.
        step: usize,
        /// Begin of the step, in s.
        at_s: f64,
        /// Number of the step that is under way.
        before: usize,
        /// End of that step, with the time in which the line settles, in s.
        done_s: f64,
    },
    /// Pumps that run at once need more than their board has.
    #[error(
        "the fastest moments of pumps of the rack that run at once add up to {needed} {unit}, and the board at {} has \
         {all} for all its axes: {}; run them more slowly, with fewer microsteps, or one after another; a smooth flow \
         is faster in its moments than a plain one", .port.display(), .pumps.join(", ")
    )]
    BoardFull {
        /// Port of the board.
        port: PathBuf,
        /// Each pump with its step and its part, in words.
        pumps: Vec<String>,
        /// Sum of what the pumps need.
        needed: u64,
        /// Most that the board has for all its axes.
        all: u32,
        /// Unit of both.
        unit: &'static str,
    },
    /// A pump refuses its part of the rack.
    #[error("pump `{pump}` of the rack{}", .step.map_or(String::new(), |step| format!(", step {step}")))]
    Dose {
        /// Name of the pump in the rack.
        pump: String,
        /// Number of the step, from 1. `None` if no single step is refused.
        step: Option<usize>,
        /// Refusal.
        source: Box<DoseError>,
    },
    /// The rest of an interrupted share would be made without the shares that were to begin with it.
    #[error(
        "pump `{pump}` of the rack has an unfinished share that has not moved, and no share of {} is unfinished: it \
         ended, or it never began, and the rest by itself may lose the ratio", .others.join(", ")
    )]
    Alone {
        /// Name of the pump in the rack.
        pump: String,
        /// Names of the pumps that were to begin with it.
        others: Vec<String>,
    },
    /// Several pumps refuse their parts until a person has decided about each of them.
    #[error("{}", self.each().map(|error| with_sources(error)).collect::<Vec<_>>().join("; "))]
    Several {
        /// Refusal of the first pump in the order of the rack.
        first: Box<Self>,
        /// Refusals of the other pumps.
        others: Vec<Self>,
    },
    /// Somebody asked to stop before anything moved.
    #[error("stopped by the user before anything moved")]
    Stopped,
}

impl RackError {
    /// Returns the refusal of each pump, or this one error.
    pub fn each(&self) -> impl Iterator<Item = &Self> {
        let (first, others) = match self {
            Self::Several { first, others } => (first.as_ref(), others.as_slice()),
            error => (error, [].as_slice()),
        };
        std::iter::once(first).chain(others)
    }

    /// Returns the name of the one pump of the rack that refuses. `None` if no single one does.
    pub fn pump(&self) -> Option<&str> {
        match self {
            Self::Pump { pump, .. } | Self::Dose { pump, .. } | Self::Alone { pump, .. } => Some(pump),
            _ => None,
        }
    }

    /// Returns the first of some refusals, or all of those that wait for a person if there are several.
    pub(super) fn of_several(refusals: Vec<Self>) -> Option<Self> {
        let mut refusals = refusals.into_iter();
        let first = refusals.next()?;
        Some(first.with_waiting(refusals.collect()))
    }

    /// Returns true for the refusal of a pump that waits for a person.
    pub(super) fn waits(&self) -> bool {
        matches!(self.ending(), Ending::Stands | Ending::Unfinished)
    }

    /// Returns the refusal with those others that wait for a person.
    pub(super) fn with_waiting(self, others: Vec<Self>) -> Self {
        let others: Vec<Self> = others.into_iter().filter(Self::waits).collect();
        if others.is_empty() { self } else { Self::Several { first: Box::new(self), others } }
    }
}

impl Explain for RackError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Rack);
        match self {
            Self::Read { path, source } => ErrorFacts::of_file(ErrorKind::Input, path, source),
            Self::Syntax { .. } => facts,
            Self::Value { value, allowed, .. } => facts.value(value).allowed(allowed),
            Self::Quantity { source, .. } => source.facts(),
            Self::Pump { source, .. } => source.facts(),
            Self::Shared { other, .. } => facts.value(other),
            Self::RealPace { .. } => facts.value("fast").allowed("real"),
            Self::TimeGoesBack { at_s, before_s, .. } => {
                facts.value(format!("{at_s:.3} s")).allowed(format!("{before_s:.3} s or later"))
            }
            Self::Overlap { at_s, done_s, .. } => {
                facts.value(format!("{at_s:.3} s")).allowed(format!("{done_s:.3} s or later"))
            }
            Self::BoardFull { needed, all, unit, .. } => {
                facts.value(format!("{needed} {unit}")).allowed(format!("at most {all} {unit}"))
            }
            Self::Dose { source, .. } => source.facts(),
            Self::Alone { .. } => ErrorFacts::of(ErrorKind::Unfinished),
            Self::Several { first, .. } => first.facts(),
            Self::Stopped => ErrorFacts::of(ErrorKind::Stopped),
        }
    }

    fn ending(&self) -> Ending {
        match self {
            Self::Dose { source, .. } => source.ending(),
            Self::Alone { .. } => Ending::Unfinished,
            Self::Several { first, .. } => first.ending(),
            Self::Stopped => Ending::Stopped,
            _ => Ending::Refused,
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Dose { source, .. } => source.remedies(),
            Self::Pump { source, .. } => source.remedies(),
            Self::Quantity { source, .. } => source.remedies(),
            Self::Alone { .. } => vec![Remedy::SeeStatusThenFinish],
            Self::Several { first, .. } => first.remedies(),
            _ => Vec::new(),
        }
    }
}
