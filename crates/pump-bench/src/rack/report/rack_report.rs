//! The report of a rack, and its JSON for programs.

use libm::sqrt;
use serde::{Serialize, Serializer};

use super::pump_row::{RackPumpReport, sum};
use crate::dosing::DoseError;
use crate::notice::Wording;
use crate::rack::rack::Rack;
use crate::record::Stamp;
use crate::words::words_of_reports;

/// End of a rack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RackEnd {
    /// A rehearsal: nothing moved.
    Planned,
    /// Every pump has completed its steps.
    Completed,
    /// Somebody stopped all pumps.
    Stopped,
    /// A pump failed, and all were stopped.
    Fault,
}

words_of_reports!(RackEnd {
    Planned = "planned",
    Completed = "completed",
    Stopped = "stopped",
    Fault = "fault",
});

/// Fault of the pump that stopped all others.
#[derive(Debug)]
#[non_exhaustive]
pub struct RackFault {
    /// Name of the pump in the rack.
    pub pump: String,
    /// Fault.
    pub error: DoseError,
}

impl Serialize for RackFault {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&self.pump)
    }
}

/// Sum over the pumps of a rack.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RackTotal {
    /// Volume that was asked for, mL.
    pub requested_ml: f64,
    /// Volume that was delivered, mL, or planned in a rehearsal.
    pub delivered_ml: f64,
    /// Smallest volume that may have been delivered, mL.
    pub delivered_least_ml: f64,
    /// Largest volume that may have been delivered, mL.
    pub delivered_most_ml: f64,
    /// Expanded uncertainty of the sum, mL: the pumps err independently of each other.
    pub expanded_uncertainty_ml: f64,
}

impl RackTotal {
    /// Returns the smallest and the largest volume that may have been delivered, in mL.
    pub fn delivered_range_ml(&self) -> (f64, f64) {
        (self.delivered_least_ml, self.delivered_most_ml)
    }
}

/// The report of a rack (`schema` `rack/1`).
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct RackReport {
    /// `rack/1`.
    pub schema: &'static str,
    /// Name of the rack.
    pub rack: String,
    /// Time at which the first dose began, RFC 3339; null if none did.
    pub time: Option<Stamp>,
    /// True if no motor moved.
    pub simulated: bool,
    /// End of the rack: `planned`, `completed`, `stopped` or `fault`.
    pub end: RackEnd,
    /// True if every pump has completed its steps.
    pub completed: bool,
    /// Name of the pump that failed first; null if none did.
    pub fault: Option<RackFault>,
    /// Number of steps.
    pub steps: usize,
    /// Planned time from the begin to the last motor step, s.
    pub planned_s: f64,
    /// Time from the begin to the last motor step that was made, s; null in a rehearsal, and if nothing moved.
    pub ended_s: Option<f64>,
    /// Row of each pump.
    pub pumps: Vec<RackPumpReport>,
    /// Sum over the pumps.
    pub total: RackTotal,
}

impl RackReport {
    /// Reports the rows of a rack.
    pub(in crate::rack) fn of(
        rack: &Rack,
        end: RackEnd,
        fault: Option<RackFault>,
        planned_s: f64,
        pumps: Vec<RackPumpReport>,
    ) -> Self {
        let sum = |of: fn(&RackPumpReport) -> f64| sum(pumps.iter().map(of));
        let squares = sum(|row| row.expanded_uncertainty_ml * row.expanded_uncertainty_ml);
        let total = RackTotal {
            requested_ml: sum(|row| row.requested_ml),
            delivered_ml: sum(|row| row.delivered_ml),
            delivered_least_ml: sum(|row| row.delivered_least_ml),
            delivered_most_ml: sum(|row| row.delivered_most_ml),
            expanded_uncertainty_ml: sqrt(squares),
        };
        let ends = pumps.iter().flat_map(|row| &row.doses);
        let ends = ends.filter_map(|dose| Some(dose.begin_s + dose.dose.measured_motion_s?));
        let ends = ends.chain(pumps.iter().filter_map(|row| row.failed_end_s));
        let ended_s =
            ends.fold(None, |last: Option<f64>, end_s| Some(last.map_or(end_s, |last| last.max(end_s))));
        let times = pumps.iter().filter_map(|row| row.doses.first()?.dose.time);
        Self {
            schema: "rack/1",
            rack: rack.name().to_owned(),
            time: times.min_by_key(|time| time.unix_s),
            simulated: rack.is_simulated(),
            end,
            completed: end == RackEnd::Completed,
            fault,
            steps: rack.steps().len(),
            planned_s,
            ended_s,
            pumps,
            total,
        }
    }

    /// Returns the report with its remedies in a front end's words.
    #[must_use]
    pub fn worded(mut self, words: Wording) -> Self {
        self.pumps = self.pumps.into_iter().map(|row| row.worded(words)).collect();
        self
    }

    /// Returns true if a pump has made a motor step.
    pub fn has_moved(&self) -> bool {
        let moved = |row: &RackPumpReport| {
            row.delivered_least_ml != 0.0
                || row.delivered_most_ml != 0.0
                || row.doses.iter().any(|dose| dose.dose.steps_made.is_some_and(|made| made != 0))
        };
        self.end != RackEnd::Planned && self.pumps.iter().any(moved)
    }

    /// Returns what became of the pumps beside the one that failed, as a clause. `None` if there is no other, and if no
    /// pump has failed.
    pub fn others_in_words(&self) -> Option<&'static str> {
        let failed = &self.fault.as_ref()?.pump;
        let mut others = self.pumps.iter().filter(|row| row.name != *failed).peekable();
        others.peek()?;
        let completed = others.clone().filter(|row| row.completed).count();
        Some(match completed {
            0 => "every other pump was stopped",
            all if all == others.count() => "every other pump has completed its steps",
            _ => "every other pump that had not completed its steps was stopped",
        })
    }

    /// Returns the report as one line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
    }
}
