//! The row of a pump in the report of a rack.

use serde::Serialize;

use crate::dosing::DoseError;
use crate::notice::{Notice, Wording};
use crate::rack::member::Member;
use crate::report::{DoseReport, with_sources};

/// Part of a step that a pump has run, or a rehearsal has planned.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RackDose {
    /// Number of the step in the rack, from 1.
    pub step: usize,
    /// Begin since the rack began, s: the planned one, or that of a motion that began more than 0.1 s late.
    pub begin_s: f64,
    /// True if a rest of the dose is on record. A flow over time leaves none.
    pub unfinished: bool,
    /// Report of the dose, `dose/1`.
    pub dose: DoseReport,
}

/// Row of a pump.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RackPumpReport {
    /// Name of the pump in the rack.
    pub name: String,
    /// Id of the pump.
    pub pump: String,
    /// Name of the drive.
    pub driver: String,
    /// True if no motor moved.
    pub simulated: bool,
    /// Port to which the motor is connected; null if the motor is simulated.
    pub device: Option<String>,
    /// Volume that all steps ask of the pump, mL.
    pub requested_ml: f64,
    /// Volume that the pump has delivered, mL, or the planned one in a rehearsal. After a fault it is the middle of the
    /// volumes that may have been delivered.
    pub delivered_ml: f64,
    /// Smallest volume that may have been delivered, mL.
    pub delivered_least_ml: f64,
    /// Largest volume that may have been delivered, mL.
    pub delivered_most_ml: f64,
    /// Expanded uncertainty of the volume, mL, as if every step erred the same way.
    pub expanded_uncertainty_ml: f64,
    /// Carry to the next dose, mL; null if no step was begun.
    pub carry_ml: Option<f64>,
    /// Number of steps in which the pump takes part.
    pub steps: usize,
    /// Number of steps that the pump has completed.
    pub steps_completed: usize,
    /// Number of steps that the pump has not begun.
    pub steps_not_begun: usize,
    /// True if the pump has completed every step.
    pub completed: bool,
    /// True if a dose is unfinished and on record.
    pub unfinished: bool,
    /// True if the unfinished dose is a flow over time, of which no rest can be made.
    #[serde(skip)]
    pub over_time: bool,
    /// Time of the last step that a motion that failed has told, s. `None` without one.
    #[serde(skip)]
    pub(in crate::rack) failed_end_s: Option<f64>,
    /// Reason why the pump failed; null if it did not.
    pub error: Option<String>,
    /// Cause of the fault, without what this pump delivered. `None` if it did not fail.
    #[serde(skip)]
    pub(in crate::rack) cause: Option<String>,
    /// Warnings for the user, those of the doses included.
    pub warnings: Vec<Notice>,
    /// Doses of the pump in the order of its steps.
    pub doses: Vec<RackDose>,
}

impl RackPumpReport {
    /// Sums the doses of a pump of which `requested_ml` were asked in `steps` steps.
    pub(in crate::rack) fn of(
        member: &Member,
        steps: usize,
        requested_ml: f64,
        mut doses: Vec<RackDose>,
    ) -> Self {
        let bench = &member.bench;
        let mut warnings = Vec::new();
        for dose in &mut doses {
            for warning in std::mem::take(&mut dose.dose.warnings) {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        let volume_ml = |dose: &RackDose| dose.dose.delivered_ml.unwrap_or(dose.dose.planned_ml);
        let delivered_ml = sum(doses.iter().map(volume_ml));
        let range_ml = |dose: &RackDose| match dose.dose.delivered_ml {
            Some(_) => dose.dose.delivered_range_ml(),
            None => (dose.dose.planned_ml, dose.dose.planned_ml),
        };
        let delivered_least_ml = sum(doses.iter().map(|dose| range_ml(dose).0));
        let delivered_most_ml = sum(doses.iter().map(|dose| range_ml(dose).1));
        let steps_completed = doses.iter().filter(|dose| dose.dose.completed).count();
        Self {
            name: member.name.clone(),
            pump: bench.file().pump.id.clone(),
            driver: bench.drive_id().to_owned(),
            simulated: bench.is_simulated(),
            device: bench.board_port().map(|port| port.display().to_string()),
            requested_ml,
            delivered_ml,
            delivered_least_ml,
            delivered_most_ml,
            expanded_uncertainty_ml: sum(doses.iter().map(|dose| dose.dose.expanded_uncertainty_ml)),
            carry_ml: doses.last().map(|dose| dose.dose.carry_ml),
            steps,
            steps_completed,
            steps_not_begun: steps - doses.len(),
            completed: steps_completed == steps,
            unfinished: doses.last().is_some_and(|dose| dose.unfinished),
            over_time: false,
            failed_end_s: None,
            error: None,
            cause: None,
            warnings,
            doses,
        }
    }

    /// Adds the fault of a motion whose made part is as unsure as `expanded_ml`. Half the range of its volume comes on
    /// top, as in the log.
    /// `over_time` tells that the motion was a flow over time.
    pub(in crate::rack) fn failed(&mut self, error: &DoseError, expanded_ml: f64, over_time: bool) {
        self.error = Some(with_sources(error));
        self.cause = Some(match error {
            DoseError::Drive { error, .. } => with_sources(error),
            other => with_sources(other),
        });
        self.completed = false;
        self.unfinished = matches!(
            error,
            DoseError::Drive { unfinished: true, .. }
                | DoseError::SlowDisk { .. }
                | DoseError::NotJournalled { .. }
        );
        self.over_time = self.unfinished && over_time;
        let (least_ml, most_ml) = error.delivered_ml().unwrap_or((0.0, 0.0));
        if self.unfinished || (least_ml, most_ml) != (0.0, 0.0) {
            self.steps_not_begun = self.steps_not_begun.saturating_sub(1);
        }
        self.delivered_least_ml += least_ml;
        self.delivered_most_ml += most_ml;
        if (least_ml, most_ml) != (0.0, 0.0) {
            self.expanded_uncertainty_ml += expanded_ml + 0.5 * (most_ml - least_ml).abs();
        }
        self.delivered_ml += 0.5 * (least_ml + most_ml);
    }

    /// Returns the volume that the text and the log tell, mL.
    pub(super) fn told_ml(&self) -> f64 {
        let more = |dose: &RackDose| {
            dose.dose.delivered_ml.map_or(0.0, |delivered_ml| dose.dose.told_ml() - delivered_ml)
        };
        self.delivered_ml + sum(self.doses.iter().map(more))
    }

    /// Returns the row with its remedies in a front end's words.
    pub(super) fn worded(mut self, words: Wording) -> Self {
        self.warnings = self.warnings.iter().map(|notice| notice.told(words)).collect();
        let dose = |part: RackDose| RackDose { dose: part.dose.worded(words), ..part };
        self.doses = self.doses.into_iter().map(dose).collect();
        self
    }
}

/// Returns the sum of some volumes. That of none is 0, and not the -0 of `Iterator::sum`.
pub(super) fn sum(volumes_ml: impl Iterator<Item = f64>) -> f64 {
    volumes_ml.fold(0.0, |sum_ml, volume_ml| sum_ml + volume_ml)
}
