//! A step of a rack: volumes of one or more pumps that begin together.

use pump_ctl::plan::Cruise;

use crate::bench::SeriesRequest;
use crate::dosing::{DoseRequest, FlowProfile};
use crate::record::{Purpose, ShortText};

/// Step of a rack.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RackStep {
    /// Begin of the step.
    pub begin: Begin,
    /// Flows of the step, one for each pump that takes part.
    pub flows: Vec<Flow>,
    /// True if the speeds follow the rollers' angles for smooth flows.
    pub smooth: bool,
}

/// Begin of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Begin {
    /// Time since the rack began, in s.
    At {
        /// Time, in s.
        time_s: f64,
    },
    /// Time after the step before has ended and its lines have settled, in s.
    After {
        /// Time, in s.
        time_s: f64,
    },
}

/// Flow of one pump in a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Flow {
    /// Number of the pump in the rack, from 0.
    pub pump: usize,
    /// Amount of the step as it is typed, with the share of the pump, for the report and the log.
    pub asked: ShortText,
    /// Volume, in mL. Negative in reverse.
    pub volume_ml: f64,
    /// Cruise flow, in mL/s. `None` takes the pump file's default rate.
    pub rate_ml_s: Option<f64>,
    /// Flow over time that the pump follows at its rollers. `None` for a dose.
    pub profile: Option<FlowProfile>,
}

impl Flow {
    /// Returns the request to the pump's bench.
    pub(super) fn request(&self, smooth: bool) -> SeriesRequest {
        let cruise = self.rate_ml_s.map(|ml_s| Cruise::Flow { ml_s });
        let request = match self.profile {
            None => DoseRequest::dose(self.volume_ml).with_cruise(cruise).with_smooth(smooth),
            Some(_) => DoseRequest::new(Purpose::Run, self.volume_ml),
        };
        let request = request.with_asked(self.asked.as_str());
        SeriesRequest { request, profile: self.profile.clone() }
    }
}
