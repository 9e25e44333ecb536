//! The record of a pump, and its JSON for programs. `status_text.rs` has its words for people.

mod board;
mod by_weight;
mod row;
mod safety;

use pump_model::units::degrees;
use serde::Serialize;

pub use self::board::BoardStatus;
pub use self::by_weight::LastByWeight;
pub use self::row::StatusRow;
pub use self::safety::{SafetyStatus, StandStatus};
use crate::bench::Bench;
use crate::calibration::{RunLog, Stored, Weighing};
use crate::dosing::DoseError;
use crate::record::{AngleLoss, LogEnd, PhaseSource, Purpose, Story, Unfinished, Wear};

/// The record of a pump (`schema` `status/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Status {
    /// `status/1`.
    pub schema: &'static str,
    /// Id of the pump.
    pub pump: String,
    /// Driver of the motor.
    pub driver: String,
    /// True if anything was ever recorded.
    pub recorded: bool,
    /// Angle of the rotor, deg; null if the angle is unknown.
    pub angle_deg: Option<f64>,
    /// Largest error of the angle either way, deg.
    pub half_width_deg: f64,
    /// True if the angle is known.
    pub angle_known: bool,
    /// Source of the angle.
    pub angle_source: PhaseSource,
    /// Cause for which the angle, once known, is unknown; null if it is known, and if it was never found.
    pub angle_lost_by: Option<AngleLoss>,
    /// Number of times that the rotor was let go, or its device reset or lost, since its angle was found; the second
    /// time the angle is unknown.
    pub disturbances: u8,
    /// The device's own count of steps when it was last seen; null if it has none.
    pub device_count: Option<i64>,
    /// Carry to the next dose, mL, positive toward the outlet.
    pub carry_ml: f64,
    /// Half width of the range around the carry that holds the true carry, mL; 0 if the carry is known exactly.
    pub carry_half_width_ml: f64,
    /// Volume, revolutions and time that the tube has pumped.
    pub wear: Wear,
    /// Volume that a tube lasts, mL; null if nobody has said it.
    pub tube_life_ml: Option<f64>,
    /// Time in motion that a tube lasts, h; null if nobody has said it.
    pub tube_life_h: Option<f64>,
    /// Revolutions that a tube lasts; null if nobody has said it.
    pub tube_life_revolutions: Option<f64>,
    /// Calibration that doses use; null if they use none.
    pub calibration: Option<CalibrationStatus>,
    /// Dose that was begun and not finished; null if there is none.
    pub unfinished: Option<UnfinishedStatus>,
    /// Weighing of the last dose, if a balance ended it; null otherwise.
    pub last_by_weight: Option<LastByWeight>,
    /// Guided calibration that was begun and not finished; null if there is none.
    pub unfinished_calibration: Option<UnfinishedCalibration>,
    /// Volumes that the safety limits count, and the stand of the pump if one is reached.
    pub safety: SafetyStatus,
    /// Board that the record names; null without one that can be told from others.
    pub board: Option<BoardStatus>,
    /// Process that holds the pump, so that the unfinished dose is in motion; null if none does.
    pub in_use_by: Option<String>,
    /// Folder of the journal.
    pub folder: String,
}

/// The calibration that doses use.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CalibrationStatus {
    /// Number of the calibration.
    pub version: u32,
    /// Date on which the calibration was made, UTC.
    pub date: String,
    /// Model angle of the rollers where the record says 0, deg.
    pub zero_deg: f64,
    /// Roller volume V_r that short doses found, mL; null if the pump file's holds.
    pub roller_volume_ml: Option<f64>,
    /// Standard uncertainty of that roller volume, mL.
    pub roller_volume_standard_ml: Option<f64>,
    /// Engagement angle phi that short doses found, deg; null if the pump file's holds.
    pub engagement_deg: Option<f64>,
    /// Standard uncertainty of that engagement angle, deg.
    pub engagement_standard_deg: Option<f64>,
}

impl CalibrationStatus {
    fn of(stored: Stored) -> Self {
        let Stored { version, calibration } = stored;
        let pulse = calibration.pulse;
        Self {
            version,
            date: calibration.date,
            zero_deg: calibration.zero_deg,
            roller_volume_ml: pulse.map(|pulse| pulse.roller_volume_ml),
            roller_volume_standard_ml: pulse.map(|pulse| pulse.roller_volume_standard_ml),
            engagement_deg: pulse.map(|pulse| pulse.engagement_deg),
            engagement_standard_deg: pulse.map(|pulse| pulse.engagement_standard_deg),
        }
    }
}

/// A dose that was begun and not finished.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct UnfinishedStatus {
    /// Number of its last motion in the log; null in a record of an early version.
    pub number: Option<u64>,
    /// Purpose of the motion, for its words.
    #[serde(skip)]
    pub purpose: Purpose,
    /// Volume that was asked for, mL.
    pub requested_ml: f64,
    /// Volume that was planned, mL.
    pub planned_ml: f64,
    /// Smallest volume that it may have delivered, mL.
    pub delivered_least_ml: f64,
    /// Largest volume that it may have delivered, mL.
    pub delivered_most_ml: f64,
    /// Volume that turns to find the angle pumped while it was unfinished, mL; negative in reverse. It counts as not
    /// delivered.
    pub searched_ml: f64,
    /// Planned motor steps of its last motion; negative in reverse.
    pub steps: i64,
    /// Fewest net steps of its last motion that may have been made in its direction. Negative if the rotor may
    /// stand behind its start.
    pub steps_made_least: i64,
    /// Most net steps of its last motion that may have been made in its direction.
    pub steps_made_most: i64,
    /// True if the steps of all its motions are known exactly: the rollers' angle alone makes its volumes unsure.
    #[serde(skip)]
    pub steps_are_exact: bool,
    /// Volumes of a revolution, mL, when it was begun and by the pump file of now, if they differ: its volumes are by
    /// the first.
    #[serde(skip)]
    pub other_volumes: Option<(f64, f64)>,
    /// True if the board may know more than the record, and tells it once it is met again.
    #[serde(skip)]
    pub board_may_tell: bool,
    /// Time at which it began, seconds since 1970 by the clock of that day.
    pub began_unix_s: u64,
    /// True if it is a run that was to go on until it is stopped: `requested_ml` is then the most that one run makes.
    pub until_stopped: bool,
    /// True if it is a flow over time, of which no rest can be made: its times have passed. It can be accepted alone.
    pub over_time: bool,
    /// True if a balance was to end it. Its rest is made by volume.
    pub by_weight: bool,
    /// Mass that the balance was to show, g; null if no balance was to end it.
    pub target_g: Option<f64>,
    /// End of its last motion; null as long as the log does not have it.
    pub end: Option<LogEnd>,
    /// Cause of a fault with its sources, or who or what stopped it; null where there is none, or nobody says.
    pub cause: Option<String>,
}

impl UnfinishedStatus {
    fn of(bench: &Bench, story: &Story, dose: &Unfinished) -> Self {
        let (delivered_least_ml, delivered_most_ml) = dose.delivered_ml(bench.model());
        let logged = dose.intent.told.and_then(|told| bench.logged(told.number));
        Self {
            number: dose.intent.told.map(|told| told.number),
            purpose: dose.intent.purpose,
            requested_ml: dose.intent.whole_requested_ml(),
            planned_ml: dose.intent.whole.map_or(0.0, |whole| whole.booked_ml) + dose.intent.planned_ml,
            delivered_least_ml,
            delivered_most_ml,
            searched_ml: dose.searched_ml(),
            steps: dose.intent.steps,
            steps_made_least: dose.made_least,
            steps_made_most: dose.made_most,
            steps_are_exact: dose.has_exact_steps(),
            other_volumes: story.other_volumes,
            board_may_tell: story.board_may_tell(dose),
            began_unix_s: dose.intent.unix_s,
            until_stopped: dose.intent.terms.until_stopped,
            over_time: dose.intent.terms.profile,
            by_weight: dose.intent.terms.by_weight,
            target_g: Weighing::of(bench.file())
                .reading_g(dose.intent.whole_requested_ml())
                .filter(|_| dose.intent.terms.by_weight),
            end: logged.as_ref().map(|entry| entry.end),
            cause: logged.and_then(|entry| entry.cause),
        }
    }
}

/// A guided calibration that was begun and not finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct UnfinishedCalibration {
    /// Number of readings on record; null if they cannot be read.
    pub readings: Option<usize>,
    /// Number of readings that the calibration needs; null if it cannot be read.
    pub planned: Option<usize>,
}

impl UnfinishedCalibration {
    /// Reads the guided calibration that is unfinished, if one is.
    pub(super) fn of(bench: &Bench) -> Option<Self> {
        match RunLog::of(bench.folder()).unfinished(&bench.calibrations()) {
            Ok(found) => found.map(|found| Self {
                readings: Some(found.runs.len()),
                planned: Some(found.planned.speeds_rpm.len()),
            }),
            // Nothing else depends on the readings. Who goes on with them is told what is wrong.
            Err(_) => Some(Self { readings: None, planned: None }),
        }
    }
}

impl Status {
    /// Reads the record of a bench. It needs no lock.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] or [`DoseError::Calibration`] where the record cannot be read.
    pub fn of(bench: &Bench) -> Result<Self, DoseError> {
        let story = bench.story()?;
        let recorded = story.state;
        let in_use_by = bench.folder().holder();
        // A motion that nobody makes any more was cut off.
        let under_way = story.cut_off.map(|(_, motion)| motion).filter(|_| in_use_by.is_some());
        let state = match recorded {
            // A process that has the pump has met its board.
            Some(state) if in_use_by.is_none() => bench.as_told(state),
            recorded => recorded.unwrap_or(bench.fresh()),
        };
        let unfinished = state.unfinished.map(|dose| UnfinishedStatus::of(bench, &story, &dose));
        let angle_known = state.phase().is_known(bench.model().pitch_rad());
        Ok(Self {
            schema: "status/1",
            pump: bench.file().pump.id.clone(),
            driver: bench.drive_id().to_owned(),
            recorded: recorded.is_some(),
            angle_deg: angle_known.then_some(degrees(state.angle_rad)),
            half_width_deg: degrees(state.half_width_rad.min(0.5 * bench.model().pitch_rad())),
            angle_known,
            angle_source: if angle_known { state.source } else { PhaseSource::Assumed },
            // A motion that goes on hides the angle for as long as it lasts.
            angle_lost_by: state.lost_by.filter(|_| !angle_known && under_way.is_none()),
            disturbances: state.disturbances,
            device_count: state.count,
            carry_ml: state.carry_ml,
            carry_half_width_ml: state.carry_within_ml(bench.model()),
            wear: state.wear,
            tube_life_ml: bench.file().tube.life_ml,
            tube_life_h: bench.file().tube.life_h,
            tube_life_revolutions: bench.file().tube.life_rev,
            calibration: bench.calibrations().active()?.map(CalibrationStatus::of),
            unfinished,
            last_by_weight: LastByWeight::of(&state),
            unfinished_calibration: UnfinishedCalibration::of(bench),
            safety: SafetyStatus::of(bench, recorded.as_ref(), under_way.as_ref()),
            board: BoardStatus::of(bench),
            in_use_by,
            folder: bench.folder().path().display().to_string(),
        })
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a status is plain data: {error}"))
    }
}
