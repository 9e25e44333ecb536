//! The errors of a dose that was refused or failed.

mod kinds;
mod motor_words;
mod no_rest_by_weight;
mod weight_fault;

use std::path::PathBuf;

use pump_ctl::plan::{FlowError, PlanError};
use pump_model::Shown;
use thiserror::Error;

use crate::balance::BalanceError;
use crate::calibration::CalibrationError;
use crate::displacement::DisplacementError;
use crate::drives::DriveError;
use crate::numbers::{between, significant};
use crate::pump_file::{HomePolicy, PumpFileError};
use crate::record::FolderError;
use crate::record::JournalError;
use crate::record::Stamp;
use crate::safety::{Stand, clock_behind};

use super::flow_profile::{FlowWayOut, ProfileError};
use super::request::RunBound;
use super::tube_life::LifeUnit;
use super::unknown_angle::disturbed;
use motor_words::motor_in_words;

pub use no_rest_by_weight::NoRestByWeight;
pub use weight_fault::WeightFault;

/// Error of a dose that was refused or failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DoseError {
    /// The pump file cannot be used.
    #[error(transparent)]
    PumpFile(#[from] PumpFileError),
    /// The dose cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The rest of an unfinished dose needs the rollers' angle, which is not known well enough.
    #[error(transparent)]
    RestWithoutAngle(PlanError),
    /// The motion is faster than the device makes it, whatever the pump file allows. Nothing has moved.
    #[error(
        "the {driver} driver makes {most_steps_s:.0} steps/s at most, and so {limit_rpm:.2} of the {file_rpm} r/min \
         that the pump file allows; dose slower{}",
        match driver.as_str() {
            "node" => ", or with fewer microsteps; long pulses in [drive.pins] take of it too",
            "klipper" => {
                ", or with fewer microsteps: a quarter of the microcontroller's benchmark in Klipper's documentation \
                 is asked for, and a long [drive.klipper] step_pulse_us takes of it too"
            }
            _ => "",
        }
    )]
    DeviceSpeed {
        /// Name of the drive.
        driver: String,
        /// Most steps a second that the device makes.
        most_steps_s: f64,
        /// Fastest speed of the pump head at these steps, in r/min.
        limit_rpm: f64,
        /// Fastest speed of the pump head by the pump file, in r/min.
        file_rpm: f64,
        /// Refusal of the plan within the device's limit.
        source: Box<Self>,
    },
    /// The table of a flow over time cannot be used. Nothing has moved.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// The flow over time cannot be met. Nothing has moved.
    #[error("this flow over time cannot be met")]
    Flow(#[source] FlowError),
    /// The flow over time cannot be met by this motor, and a gentler one could. Nothing has moved.
    #[error("this flow over time cannot be met{way_out}")]
    SteepFlow {
        /// Flows that could be met.
        way_out: FlowWayOut,
        /// First instant that cannot be met.
        source: FlowError,
    },
    /// The folder of the journal cannot be used. Nothing has moved.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The journal cannot be used. Nothing has moved.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A calibration cannot be made or used. Nothing has moved.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The displacement of the pump is not known at the dose's speed.
    #[error(transparent)]
    Displacement(#[from] DisplacementError),
    /// Values of the pump were filled in by the program, and nobody has confirmed them. Nothing has moved.
    #[error(
        "the motor of pump {pump} does not move: the program filled in {values}, and nobody has confirmed {}",
        if *changed { "these values since they changed" } else { "these values" }
    )]
    Unconfirmed {
        /// Id of the pump.
        pump: String,
        /// Values that the program filled in, in words.
        values: String,
        /// True if a person confirmed other values before.
        changed: bool,
    },
    /// The pump file turns the motor in another way than when it moved last: by other steps, at another place of the
    /// board, or in the other direction. Nothing has moved.
    #[error(
        "the motor of pump {pump} does not move: its pump file now drives it with {now}; when it last moved, it was \
         driven with {then}"
    )]
    TurnedOtherwise {
        /// Id of the pump.
        pump: String,
        /// Way of the pump file, in words.
        now: String,
        /// Way of the last motion, in words.
        then: String,
    },
    /// A safety limit is reached, or the pump was ordered to stand. It stands until a person clears it. Nothing has
    /// moved.
    #[error(
        "pump {pump} {} {}{}: {stand}{}{}",
        if *is_recorded { "stands" } else { "would stand" },
        stand.place(),
        if *is_new { String::new() } else { format!(" since {}", Stamp::new(stand.unix_s, 0)) },
        if *clock_behind_s == 0 { String::new() } else { format!("; {}", clock_behind(*clock_behind_s)) },
        if *is_recorded { "" } else { "; nothing has moved, and the pump does not stand for this plan" }
    )]
    Stands {
        /// Id of the pump.
        pump: String,
        /// Limit, with the volumes that would have exceeded it, or the reason of the order.
        stand: Box<Stand>,
        /// True if this dose would have exceeded the limit. False if an earlier one would have.
        is_new: bool,
        /// True if the stand is on record. A dry run records none.
        is_recorded: bool,
        /// Time by which the clock is behind the latest on record, at a limit of 24 h, in s. 0 if it is not.
        clock_behind_s: u64,
    },
    /// The stand of the pump cannot be cleared.
    #[error("pump {pump} is not cleared: {why}")]
    NotCleared {
        /// Id of the pump.
        pump: String,
        /// Reason, as the message words it.
        why: &'static str,
    },
    /// The pump cannot be ordered to stand. It is as it was.
    #[error("pump {pump} is not put to stand: {why}")]
    NotPutToStand {
        /// Id of the pump.
        pump: String,
        /// Reason, as the message words it.
        why: &'static str,
    },
    /// The angle was disturbed, and the pump file has doses without a person refused then, or has them turn to the
    /// sensor, which a rack does not. Nothing has moved.
    #[error(
        "the rollers' angle {}; [safety] home = \"{home}\" {}",
        disturbed(*within_deg),
        match home {
            HomePolicy::Sensor => "turns no pump of a rack, whose motions have their times",
            _ => "makes no dose without a person then",
        }
    )]
    Disturbed {
        /// Choice of the pump file.
        home: HomePolicy,
        /// Half width of the range of the angle, in deg. `None` if the angle is unknown.
        within_deg: Option<f64>,
    },
    /// An earlier dose is unfinished.
    #[error(
        "a dose of {} mL is unfinished: {} were delivered",
        significant(*requested_ml, 6), between(*least_ml, *most_ml)
    )]
    Unfinished {
        /// Volume asked for, in mL.
        requested_ml: f64,
        /// Smallest volume that the dose may have delivered, in mL.
        least_ml: f64,
        /// Largest volume that the dose may have delivered, in mL.
        most_ml: f64,
    },
    /// The carry from earlier doses would reverse the dose.
    #[error(
        "{} mL requested and {:+.2} µL carried from earlier doses would have the pump run the \
         other way, by {owed_ml:.4} mL",
        Shown(*asked_ml), 1e3 * carry_ml
    )]
    RunsTheOtherWay {
        /// Volume asked for, in mL.
        asked_ml: f64,
        /// Carry from earlier doses, in mL.
        carry_ml: f64,
        /// Volume that the pump would deliver, in mL.
        owed_ml: f64,
    },
    /// The retraction after the dose cannot be made. Nothing has moved.
    #[error("{} mL cannot be sucked back after the dose", Shown(*volume_ml))]
    SuckBack {
        /// Volume to suck back, in mL.
        volume_ml: f64,
        /// Refusal of the way back.
        source: PlanError,
    },
    /// The unfinished dose has delivered its volume on the way to an end at low flow.
    #[error(
        "the dose of {} mL has delivered {delivered_ml:.4} mL on its way to an end at low flow, \
         so no rest is left that could end anywhere",
        Shown(*requested_ml)
    )]
    BeyondRequest {
        /// Volume asked for in all, in mL.
        requested_ml: f64,
        /// Volume delivered so far, in mL.
        delivered_ml: f64,
    },
    /// The angle of the unfinished dose is known, so nothing is left to find.
    #[error("a dose is unfinished, and the rollers' angle is known exactly")]
    AngleIsKnown,
    /// The dose would use up the tube.
    #[error(
        "the tube has {} {used:.1} {unit}, and this dose of {planned:.4} {unit} would exceed its \
         life of {} {unit}",
        unit.verb(), Shown(*life)
    )]
    TubeWorn {
        /// Measure of the life.
        unit: LifeUnit,
        /// Life of the tube.
        life: f64,
        /// Part that the tube has behind it.
        used: f64,
        /// Part that the planned dose takes, in either direction.
        planned: f64,
    },
    /// The rotor has moved since the dose was prepared.
    #[error(
        "the dose was planned from {planned_deg:.4} deg, and the rotor stands at {stands_deg:.4} deg now; \
         prepare the dose again"
    )]
    Stale {
        /// Start angle of the plan, in deg.
        planned_deg: f64,
        /// Angle on record, in deg.
        stands_deg: f64,
    },
    /// The drive cannot be used. Nothing has moved.
    #[error(transparent)]
    Connection(DriveError),
    /// The device cannot turn as slowly as the dose needs.
    #[error(
        "the dose would peak at {speed_rpm:.4} r/min, and {driver} cannot turn slower than {least_rpm:.4} \
         r/min ({least_ml_s:.4} mL/s): it would run at that speed instead; ask for that rate or more, or \
         use finer microsteps"
    )]
    TooSlow {
        /// Name of the drive.
        driver: String,
        /// Fastest speed of the plan, in r/min.
        speed_rpm: f64,
        /// Slowest speed of the device, in r/min, rounded up.
        least_rpm: f64,
        /// Mean flow at the slowest speed, in mL/s, rounded up.
        least_ml_s: f64,
    },
    /// The pump file does not give the angle of the mark or of the sensor.
    #[error("pump `{pump}` has no {key}, the angle at which {what}; give it in the pump file, in degrees")]
    NoAngle {
        /// Id of the pump.
        pump: String,
        /// Table and key of the pump file.
        key: &'static str,
        /// Event at the angle, as the message words it.
        what: &'static str,
    },
    /// The index sensor did not answer within a revolution.
    #[error(
        "the index sensor did not answer within {turned_deg:.1} deg, which pumped {pumped_ml:.1} mL; check \
         its wiring and the disc; the turn is on record, and the rollers' angle is known as well as before"
    )]
    NoIndex {
        /// Angle that the rotor has turned, in deg.
        turned_deg: f64,
        /// Volume that the rotor has pumped, in mL.
        pumped_ml: f64,
    },
    /// The unfinished dose has delivered more than was asked for.
    #[error(
        "{} of the {} mL asked for were delivered: there is no rest to make",
        between(*least_ml, *most_ml), Shown(*requested_ml)
    )]
    NoRest {
        /// Volume asked for, in mL.
        requested_ml: f64,
        /// Smallest volume that the dose may have delivered, in mL.
        least_ml: f64,
        /// Largest volume that the dose may have delivered, in mL.
        most_ml: f64,
    },
    /// The unfinished run followed a flow over time, whose times have passed.
    #[error(
        "the unfinished run followed a flow over time, and was cut off after {}; its times have passed, so no rest can \
         be made",
        between(*least_ml, *most_ml)
    )]
    NoRestOfProfile {
        /// Smallest volume that the run may have delivered, in mL.
        least_ml: f64,
        /// Largest volume that the run may have delivered, in mL.
        most_ml: f64,
    },
    /// The device finished the dose after the process that ran it had ended.
    #[error(
        "the device has finished the dose that was cut off: it is on record as done, and there is nothing \
         to resume"
    )]
    WasFinished,
    /// No unfinished dose is on record to resume or to accept.
    #[error("no unfinished dose is on record: there is nothing to {0}")]
    NothingUnfinished(&'static str),
    /// Another dose than the one that was named is unfinished, or none.
    #[error("dose `{}` is not unfinished any more; {now}", dose.escape_debug())]
    NotUnfinished {
        /// Number of the dose, or the order that made it.
        dose: String,
        /// Dose that is unfinished now, in words.
        now: String,
    },
    /// The motor was stopped because its next steps could not be recorded.
    #[error("the dose was stopped after {delivered_ml:.4} mL because its progress could not be recorded")]
    NotJournalled {
        /// Volume delivered, in mL.
        delivered_ml: f64,
        /// Cause of the failure.
        source: JournalError,
    },
    /// The motor was stopped because its next steps were not recorded in time.
    #[error(
        "the dose was stopped after {delivered_ml:.4} mL because the disk took more than {took_s:.2} s to record \
         its next steps in {}, and {}",
        .journal.display(),
        if *must_not_pause {
            "a dose in a given time, at a smooth flow or with pressure limits may not pause"
        } else {
            "30 s is the longest wait"
        }
    )]
    SlowDisk {
        /// Volume delivered, in mL.
        delivered_ml: f64,
        /// Longest time that the disk took for an entry of the journal, in s.
        took_s: f64,
        /// Path of the journal.
        journal: PathBuf,
        /// True if the dose may not pause.
        must_not_pause: bool,
    },
    /// A dose by weight ended before the balance showed what was asked for.
    #[error(
        "{} by the model, and {} by the balance",
        if *from_stated_angle {
            format!("{turned_ml:.4} mL were delivered")
        } else {
            format!("about {} mL were delivered from an unknown angle", significant(*turned_ml, 2))
        },
        weighed_g.map_or("nothing is known".to_owned(), |mass_g| format!("{} g", significant(mass_g, 6)))
    )]
    ByWeight {
        /// Fault that ended the dose.
        #[source]
        fault: WeightFault,
        /// Volume delivered by the model, in mL.
        turned_ml: f64,
        /// Mass delivered by the last reading, in g. `None` without a reading.
        weighed_g: Option<f64>,
        /// True if the dose was planned from an angle that the record states. The rotor may have been turned by hand
        /// since.
        from_stated_angle: bool,
    },
    /// A balance cannot end the rest of the unfinished dose. Nothing has moved.
    #[error("the rest of this dose cannot be made by weight")]
    NoRestByWeight(#[source] NoRestByWeight),
    /// The balance cannot be read before a dose by weight. Nothing has moved.
    #[error(transparent)]
    Balance(#[from] BalanceError),
    /// A dose by weight is asked for in a way that no balance can end.
    #[error("a dose by weight {why}; its volume is {} mL", Shown(*volume_ml))]
    NotByWeight {
        /// Reason, as the message words it.
        why: String,
        /// Volume asked for, in mL.
        volume_ml: f64,
    },
    /// A run of continuous flow is asked for in a way that no run has. Nothing has moved.
    #[error("a run of continuous flow {why}")]
    NoRun {
        /// Reason, as the message words it.
        why: &'static str,
    },
    /// A run until it was stopped has ended by itself. It is complete and on record.
    #[error("the run ended by itself after {} mL, since {bound}", significant(*delivered_ml, 6))]
    RanOut {
        /// Bound at which it ended.
        bound: RunBound,
        /// Volume delivered, in mL.
        delivered_ml: f64,
    },
    /// An earlier run of continuous flow was stopped or cut off.
    #[error("a run of continuous flow is unfinished: {} were delivered", between(*least_ml, *most_ml))]
    UnfinishedRun {
        /// Smallest volume that the run may have delivered, in mL.
        least_ml: f64,
        /// Largest volume that the run may have delivered, in mL.
        most_ml: f64,
    },
    /// The drive failed in motion.
    #[error(
        "{} were delivered{}, and the drive failed",
        between(*least_ml, *most_ml),
        // Two different bounds mean that nobody knows where the rotor stands.
        motor_in_words(error, least_ml == most_ml)
    )]
    Drive {
        /// Error of the drive.
        #[source]
        error: DriveError,
        /// Smallest volume delivered, in mL.
        least_ml: f64,
        /// Largest volume delivered, in mL.
        most_ml: f64,
        /// True if a dose is left to resume or to accept.
        unfinished: bool,
        /// True for a flow over time, which is left to accept alone.
        over_time: bool,
    },
    /// The thread that ran the pump has panicked, which is an error of the program.
    #[error(
        "the program failed while it ran this pump, by an error of its own; nobody has counted the last steps"
    )]
    Panicked,
    /// The dose is delivered and on record, but its retraction failed.
    #[error("{delivered_ml:.4} mL were delivered and are on record, but the retraction failed")]
    Retraction {
        /// Volume delivered, in mL.
        delivered_ml: f64,
        /// Cause of the failure.
        source: Box<Self>,
    },
    /// The rotor was turned, and then its angle, found or unknown, could not be recorded.
    #[error(
        "the rotor was turned and {}, but this could not be recorded",
        angle_deg.map_or("nobody knows its angle".to_owned(), |deg| format!("stands at {deg:.4} deg"))
    )]
    AngleNotRecorded {
        /// Angle of the rotor, in deg. `None` if it is unknown.
        angle_deg: Option<f64>,
        /// Cause of the failure.
        source: JournalError,
    },
    /// The dose is over, but its end could not be recorded.
    #[error(
        "{delivered_ml:.4} mL were delivered and the rotor stands at {end_angle_deg:.4} deg, but this could \
         not be recorded"
    )]
    NotRecorded {
        /// Volume delivered, in mL.
        delivered_ml: f64,
        /// Angle at which the rotor stands, in deg.
        end_angle_deg: f64,
        /// Cause of the failure.
        source: JournalError,
    },
}
