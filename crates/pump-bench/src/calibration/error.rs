//! Errors of calibrations.

use std::path::PathBuf;

use pump_model::{ModelError, Shown};
use thiserror::Error;

use crate::files::TableError;
use crate::numbers::{significant, two_digits};
use crate::pump_file::FluidError;

/// A calibration that cannot be made or used. The message says what is wrong and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A file cannot be read or written.
    #[error("cannot {action} {}", .path.display())]
    File {
        /// Action that was tried.
        action: &'static str,
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A stored calibration cannot be read.
    #[error("the calibration {} is damaged: {message}", .path.display())]
    Damaged {
        /// Path of its file.
        path: PathBuf,
        /// Fault in the file.
        message: String,
    },
    /// The readings of a guided calibration that was begun cannot be read.
    #[error(
        "the readings of the guided calibration in {} are damaged: {message}", .path.display()
    )]
    DamagedLog {
        /// Path of the file of readings.
        path: PathBuf,
        /// Fault in the file.
        message: String,
    },
    /// A table of runs cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// There are too few readings for a fit.
    #[error("{given} {of}; {needed} at least are needed")]
    TooFew {
        /// Number of readings.
        given: usize,
        /// Kind of reading.
        of: &'static str,
        /// Number of readings that is needed.
        needed: usize,
    },
    /// The model volume of a run depends on an angle that nobody knows.
    #[error(
        "run {run} turned {} deg from an unknown angle; give start_angle_deg, or turn whole pitches ({} deg)",
        Shown(*turned_deg), Shown(*pitch_deg)
    )]
    UnknownAngle {
        /// Number of the run, from 1.
        run: usize,
        /// Angle that the rotor turned, in deg.
        turned_deg: f64,
        /// Angle between rollers, in deg.
        pitch_deg: f64,
    },
    /// A run that is to be weighed would turn a part of a pitch from an unknown angle.
    #[error(
        "a run from an unknown angle turns whole pitches of {pitch_deg:.4} deg, and this one turns \
         {turned_deg:.4} deg in whole motor steps"
    )]
    PartOfPitch {
        /// Angle that the run would turn, in deg.
        turned_deg: f64,
        /// Angle between rollers, in deg.
        pitch_deg: f64,
    },
    /// There is no dose that a scale could have weighed.
    #[error(
        "no dose is on record that a scale could have weighed: none was made, or the pump was primed, purged, \
         calibrated, homed or given a new tube since"
    )]
    NoLastDose,
    /// Another dose than the one that was weighed is the last one.
    #[error(
        "the dose that was weighed is not the last one: another dose of {volume} came since, at {time}; empty the \
         vessel, dose and weigh again"
    )]
    DosedSince {
        /// Volume of the last dose, as it was typed.
        volume: String,
        /// Time at which the last dose began, RFC 3339.
        time: String,
    },
    /// The dose that was weighed is not on record.
    #[error("no dose `{}` is on record; the log names the doses", dose.escape_debug())]
    NoSuchDose {
        /// Number of the dose, or the order that made it.
        dose: String,
    },
    /// The last dose was cut off, and nobody knows closely enough how far the rollers turned.
    #[error(
        "the last dose turned {turned_deg:.3} deg, known to ± {half_width_deg:.3} deg only, since it was cut off; \
         a dose that is weighed must be known to 0.1 % of its turn"
    )]
    UnsureLastDose {
        /// Angle that the rotor turned, in deg.
        turned_deg: f64,
        /// Half width of the range that holds the true turn, in deg.
        half_width_deg: f64,
    },
    /// The last dose turned a part of a pitch from an angle that leaves its volume less sure than the model does.
    #[error(
        "the last dose turned {turned_deg:.3} deg from an angle that is not known to better than 2 deg, which leaves \
         its volume uncertain by {} %, and the model is certain to {} %; whole pitches of {pitch_deg:.3} deg deliver \
         the same volume from any angle, as doses of {} and {} mL do",
        two_digits(*unsure_percent),
        two_digits(*model_percent),
        significant(nearest_ml[0], 5),
        significant(nearest_ml[1], 5)
    )]
    LastDoseFromUnknownAngle {
        /// Angle that the rotor turned, in deg.
        turned_deg: f64,
        /// Angle between rollers, in deg.
        pitch_deg: f64,
        /// Uncertainty that the angle leaves in the volume, in percent, k = 2.
        unsure_percent: f64,
        /// Uncertainty of the model, in percent, k = 2.
        model_percent: f64,
        /// Volumes of whole pitches below and above, in mL.
        nearest_ml: [f64; 2],
    },
    /// The reading of the last dose lies far beyond the uncertainty that the dose had.
    #[error(
        "the reading is {} mL, and the last dose was {} mL ± {} mL (k = 2) by what is known of the pump: a vessel that \
         was not emptied, another tare or a slip of a digit makes such a difference",
        significant(*measured_ml, 5), significant(*expected_ml, 5), two_digits(*expanded_ml)
    )]
    UnlikelyReading {
        /// Volume of the reading, in mL.
        measured_ml: f64,
        /// Volume of the dose by the calibration in use, or else by the model, in mL.
        expected_ml: f64,
        /// Expanded uncertainty (k = 2) of the difference, in mL.
        expanded_ml: f64,
    },
    /// The calibration in use was weighed with another fluid.
    #[error(
        "calibration {version} was weighed with {weighed}, and this dose with {now}; a calibration is of one fluid"
    )]
    WeighedWith {
        /// Number of the calibration.
        version: u32,
        /// Name of the fluid that was weighed.
        weighed: String,
        /// Name of the fluid of the dose.
        now: String,
    },
    /// The last dose was of a fluid of which nothing is known by now.
    #[error("the last dose was of {dosed}, and {source}")]
    DosedWith {
        /// Name and temperature of the fluid.
        dosed: String,
        /// Error of the fluid.
        source: FluidError,
    },
    /// The fluid that a person states is not known.
    #[error(transparent)]
    Fluid(FluidError),
    /// The calibration in use was weighed otherwise, and one dose does not replace it without a word.
    #[error(
        "calibration {version}, in use, rests on {runs} runs; one dose does not replace it unless that is asked for"
    )]
    WeighedOtherwise {
        /// Number of the calibration in use.
        version: u32,
        /// Number of its runs.
        runs: usize,
    },
    /// A reading cannot be right.
    #[error(
        "run {run} gave {measured_ml:.4} mL where the model gives {model_ml:.4} mL; allowed: {:.4} to {:.4} mL; more \
         than twice or less than half is a mistake in a unit, a tare, an angle, a reading or the motor's steps per \
         revolution; look at them, and write the reading again",
        0.5 * model_ml,
        2.0 * model_ml
    )]
    Implausible {
        /// Number of the run, from 1.
        run: usize,
        /// Measured volume, in mL.
        measured_ml: f64,
        /// Model volume, in mL.
        model_ml: f64,
    },
    /// The reading of the last dose cannot be right.
    #[error(
        "the reading is {} mL of {fluid}, {} times the {} mL that the last dose delivered by the model; \
         allowed: {} to {} mL, half to twice the {} mL of the uncalibrated pump; check its unit, the tare, that the \
         vessel held this dose alone, and the fluid; a motor with other steps per revolution than the pump file's \
         makes such a difference too",
        significant(*measured_ml, 5),
        significant(measured_ml / planned_ml, 3),
        significant(*planned_ml, 5),
        significant(0.5 * model_ml, 4),
        significant(2.0 * model_ml, 4),
        significant(*model_ml, 5)
    )]
    ImplausibleReading {
        /// Volume of the reading, in mL.
        measured_ml: f64,
        /// Volume of the dose by the calibration that it was planned with, in mL.
        planned_ml: f64,
        /// Volume of the dose by the model, in mL.
        model_ml: f64,
        /// Name of the fluid whose density made a volume of the mass.
        fluid: String,
    },
    /// The density of the fluid is not known at this temperature.
    #[error(
        "{fluid} was weighed at {temperature_degc} °C, but its density is known at {known_degc} °C; put \
         the density at the temperature of the runs into the pump file's [fluid]"
    )]
    FluidTemperature {
        /// Name of the fluid.
        fluid: String,
        /// Temperature at which the fluid was weighed, in °C.
        temperature_degc: f64,
        /// Temperature at which the density is known, in °C.
        known_degc: f64,
    },
    /// The search for the fastest dose does not settle on a speed and its displacement.
    #[error(
        "the fastest dose was not found in {rounds} rounds: the displacement changes too much with the \
         speed; ask for a rate"
    )]
    NoSpeed {
        /// Number of plans that were made.
        rounds: u32,
    },
    /// The dose cruises at a speed that was not calibrated.
    #[error(
        "calibration {version} holds from {least_rpm:.4} to {most_rpm:.4} r/min ({least_ml_s:.4} to \
         {most_ml_s:.4} mL/s), and {asked} is beyond"
    )]
    OutsideSpeeds {
        /// Number of the calibration.
        version: u32,
        /// Slowest calibrated speed, in r/min.
        least_rpm: f64,
        /// Fastest calibrated speed, in r/min.
        most_rpm: f64,
        /// Mean flow at the slowest speed, in mL/s.
        least_ml_s: f64,
        /// Largest mean flow, in mL/s.
        most_ml_s: f64,
        /// Speed or flow that was asked for, in words.
        asked: String,
    },
    /// The pump file is not the one that was calibrated.
    #[error(
        "calibration {version} was made of a pump with {then_ml:.6} mL per revolution, and the pump file now \
         says {now_ml:.6}"
    )]
    OtherPump {
        /// Number of the calibration.
        version: u32,
        /// Model volume of a revolution when the calibration was made, in mL.
        then_ml: f64,
        /// Model volume of a revolution by the pump file now, in mL.
        now_ml: f64,
    },
    /// There is no calibration of this number.
    #[error("there is no calibration {version} of this pump; there are: {known}")]
    NoSuchVersion {
        /// Number that was asked for.
        version: u32,
        /// Numbers of the calibrations that exist, in words.
        known: String,
    },
    /// The runs are not those of a speed law.
    #[error(
        "the runs do not fit a speed law: the fit gives s {scale:.4} and D {d_per_kpa:.2e} ± {:.1e} /kPa \
         (k = 2), and D must lie between 0 and 1; take more speeds, up to where the inlet pressure swings, \
         or fit a line",
        2.0 * .standard_per_kpa
    )]
    NoLaw {
        /// s that was found.
        scale: f64,
        /// D that was found, in 1/kPa.
        d_per_kpa: f64,
        /// Standard uncertainty of D, in 1/kPa.
        standard_per_kpa: f64,
    },
    /// The fit found no parameters.
    #[error("the readings do not determine {what}: {why}")]
    Undetermined {
        /// Parameters that were sought.
        what: &'static str,
        /// Reason why they were not found.
        why: &'static str,
    },
    /// The pump cannot be modelled.
    #[error(transparent)]
    Model(#[from] ModelError),
}
