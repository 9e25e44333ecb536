//! Why a calibration cannot be made or used.

use std::path::PathBuf;

use pump_model::ModelError;
use thiserror::Error;

use crate::files::TableError;

/// A calibration that is refused, with what is wrong and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A file cannot be used.
    #[error("cannot {action} {}: {source}", .path.display())]
    File {
        /// What was tried.
        action: &'static str,
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A stored calibration cannot be read.
    #[error(
        "the calibration {} is damaged: {message}; `dose calibrate use none` doses without one", .path.display()
    )]
    Damaged {
        /// Which.
        path: PathBuf,
        /// Why.
        message: String,
    },
    /// The readings of a guided calibration that was begun cannot be read.
    #[error(
        "the readings of the guided calibration in {} are damaged: {message}; correct the file, or begin anew with \
         `dose calibrate run --anew`", .path.display()
    )]
    DamagedLog {
        /// File of the readings.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A table of runs cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// There is nothing to fit.
    #[error("{given} {of}; {needed} at least are needed")]
    TooFew {
        /// How many there are.
        given: usize,
        /// Of what.
        of: &'static str,
        /// How many are needed.
        needed: usize,
    },
    /// The model volume of a run depends on an angle that nobody knows.
    #[error(
        "run {run} turned {turned_deg} deg from an unknown angle; give start_angle_deg, or turn whole pitches \
         ({pitch_deg} deg)"
    )]
    UnknownAngle {
        /// Number of the run, from 1.
        run: usize,
        /// How far it turned, deg.
        turned_deg: f64,
        /// Angle between rollers, deg.
        pitch_deg: f64,
    },
    /// A reading cannot be right.
    #[error(
        "run {run} gave {measured_ml:.4} mL where the model gives {model_ml:.4} mL; more than twice or less than half is a \
         mistake in a unit, an angle or a reading"
    )]
    Implausible {
        /// Number of the run, from 1.
        run: usize,
        /// mL.
        measured_ml: f64,
        /// mL.
        model_ml: f64,
    },
    /// The density of the fluid is not known at this temperature.
    #[error(
        "{fluid} was weighed at {temperature_degc} °C, but its density is known at {known_degc} °C; put the density at the \
         temperature of the runs into the pump file's [fluid]"
    )]
    FluidTemperature {
        /// Its name.
        fluid: String,
        /// °C.
        temperature_degc: f64,
        /// °C.
        known_degc: f64,
    },
    /// Speed and displacement do not settle.
    #[error(
        "the fastest dose was not found in {rounds} rounds: the displacement changes too much with the speed; ask for a rate"
    )]
    NoSpeed {
        /// How often it was planned.
        rounds: u32,
    },
    /// The dose cruises at a speed that was not calibrated.
    #[error(
        "calibration {version} holds from {least_rpm:.4} to {most_rpm:.4} r/min ({least_ml_s:.4} to {most_ml_s:.4} mL/s), and \
         {asked} is beyond; dose within that, calibrate more speeds, or say `dose calibrate use none`"
    )]
    OutsideSpeeds {
        /// Its number.
        version: u32,
        /// Slowest speed, r/min.
        least_rpm: f64,
        /// Fastest, r/min.
        most_rpm: f64,
        /// Mean flow at the slowest, mL/s.
        least_ml_s: f64,
        /// Largest mean flow, mL/s.
        most_ml_s: f64,
        /// What was asked.
        asked: String,
    },
    /// The pump file is not the one that was calibrated.
    #[error(
        "calibration {version} was made of a pump with {then_ml:.6} mL per revolution, and the pump file now says \
         {now_ml:.6}; calibrate again, or say `dose calibrate use none`"
    )]
    OtherPump {
        /// Its number.
        version: u32,
        /// Model volume of a revolution when it was made, mL.
        then_ml: f64,
        /// The same now, mL.
        now_ml: f64,
    },
    /// There is no such version.
    #[error("there is no calibration {version} of this pump; there are: {known}")]
    NoSuchVersion {
        /// Its number.
        version: u32,
        /// What there is.
        known: String,
    },
    /// The runs are not those of a speed law.
    #[error(
        "the runs do not fit a speed law: s {scale:.4} and D {d_per_kpa:.2e} ± {:.1e} /kPa (k = 2) come out, and D must lie between 0 and \
         1; take more speeds, up to where the inlet pressure swings, or fit a line", 2.0 * .standard_per_kpa
    )]
    NoLaw {
        /// s.
        scale: f64,
        /// D, 1/kPa.
        d_per_kpa: f64,
        /// Its standard uncertainty, 1/kPa.
        standard_per_kpa: f64,
    },
    /// The fit found no parameters.
    #[error("the doses do not determine {what}: {why}")]
    Undetermined {
        /// What was sought.
        what: &'static str,
        /// Why it was not found.
        why: &'static str,
    },
    /// The corrected pump cannot be modelled.
    #[error(transparent)]
    Model(#[from] ModelError),
}
