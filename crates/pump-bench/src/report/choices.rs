//! Choices that reports name by a word.

use pump_ctl::plan::{Finish, LimitedBy, SetBy};
use serde::Serializer;

use crate::words::{words, words_of_reports};

/// For whom a report is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// For programs: one JSON object a line.
    Json,
}

words!(Format { Text = "text", Json = "json" });

/// The basis of a dose's volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeBasis {
    /// The model alone.
    Model,
    /// The model of a drawing.
    Estimated,
    /// The volumes that were weighed.
    Calibrated,
}

words_of_reports!(VolumeBasis { Model = "model", Estimated = "estimated", Calibrated = "calibrated" });

/// The limit that keeps a dose from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedLimit {
    /// No limit: the dose cruises as fast as it was asked to.
    None,
    /// The motor's acceleration.
    Acceleration,
    /// The motor's largest speed.
    Speed,
    /// The pressure at the outlet.
    OutletPressure,
    /// The pressure at the inlet.
    InletPressure,
    /// The motor's torque.
    Torque,
}

words_of_reports!(SpeedLimit {
    None = "none",
    Acceleration = "acceleration",
    Speed = "speed",
    OutletPressure = "outlet_pressure",
    InletPressure = "inlet_pressure",
    Torque = "torque",
});

impl From<LimitedBy> for SpeedLimit {
    fn from(limit: LimitedBy) -> Self {
        match limit {
            LimitedBy::Nothing => Self::None,
            LimitedBy::Acceleration => Self::Acceleration,
            LimitedBy::Speed => Self::Speed,
            LimitedBy::OutletPressure | LimitedBy::OutletSuction => Self::OutletPressure,
            LimitedBy::InletPressure => Self::InletPressure,
            LimitedBy::Torque => Self::Torque,
        }
    }
}

/// The reason for the smallest pressure that is allowed at the port that sucks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SuctionLimit {
    /// The request or the pump file gives it.
    Given,
    /// The tube collapses below it.
    TubeCollapse,
    /// The fluid boils below it.
    VapourPressure,
}

words_of_reports!(SuctionLimit {
    Given = "given",
    TubeCollapse = "tube_collapse",
    VapourPressure = "vapour_pressure",
});

impl From<SetBy> for SuctionLimit {
    fn from(set_by: SetBy) -> Self {
        match set_by {
            SetBy::Given => Self::Given,
            SetBy::TubeCollapse => Self::TubeCollapse,
            SetBy::Vapour => Self::VapourPressure,
        }
    }
}

/// Serialises where a dose may end as `any` or `low-flow`.
pub(super) fn finish_word<S: Serializer>(finish: &Finish, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(match finish {
        Finish::Any => "any",
        Finish::LowFlow => "low-flow",
    })
}
