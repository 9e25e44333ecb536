//! What is on record of a pump, for programs and for people.

use std::fmt::Write;

use pump_model::math::degrees;
use serde::Serialize;

use crate::bench::Bench;
use crate::dosing::DoseError;
use crate::numbers::between;
use crate::record::PhaseSource;
use crate::record::Wear;

/// What is on record (`schema` `status/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Status {
    /// `status/1`.
    pub schema: &'static str,
    /// Pump id.
    pub pump: String,
    /// Driver.
    pub driver: &'static str,
    /// Whether anything was ever recorded.
    pub recorded: bool,
    /// Angle of the rotor, deg.
    pub angle_deg: f64,
    /// How far off it may be, deg.
    pub half_width_deg: f64,
    /// Whether the angle is known at all.
    pub angle_known: bool,
    /// Where the angle comes from.
    pub angle_source: PhaseSource,
    /// How often since it was last found the rotor was let go, its device reset or lost; the second time it is unknown.
    pub disturbances: u8,
    /// The device's own count of steps when it was last seen; null if it has none.
    pub device_count: Option<i64>,
    /// What doses owe, mL, positive toward the outlet.
    pub carry_ml: f64,
    /// What the tube has gone through.
    pub wear: Wear,
    /// Volume that a tube lasts, mL; null if it is not known.
    pub tube_life_ml: Option<f64>,
    /// The calibration that doses use; null if they use none.
    pub calibration: Option<CalibrationStatus>,
    /// A dose that was begun and not finished.
    pub unfinished: Option<UnfinishedStatus>,
    /// Who has the pump at the moment, so that what is unfinished is in motion; null if nobody has.
    pub in_use_by: Option<String>,
    /// The folder of the journal.
    pub folder: String,
}

/// The calibration that doses use.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationStatus {
    /// Its number.
    pub version: u32,
    /// When it was made, UTC.
    pub date: String,
}

/// A dose that was begun and not finished.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct UnfinishedStatus {
    /// What was asked, mL.
    pub requested_ml: f64,
    /// What was planned, mL.
    pub planned_ml: f64,
    /// Smallest volume that it may have delivered, mL.
    pub delivered_least_ml: f64,
    /// Largest.
    pub delivered_most_ml: f64,
    /// Planned steps; negative in reverse.
    pub steps: i64,
    /// At least these were made, without their sign.
    pub steps_made_least: u64,
    /// At most these.
    pub steps_made_most: u64,
    /// When it began, seconds since 1970 by the clock of that day.
    pub began_unix_s: u64,
}

impl Status {
    /// Reads the record of a bench; needs no lock.
    pub fn of(bench: &Bench) -> Result<Self, DoseError> {
        let recorded = bench.story()?.state;
        let state = recorded.unwrap_or(bench.fresh());
        let unfinished = state.unfinished.map(|dose| {
            let (delivered_least_ml, delivered_most_ml) = dose.delivered_ml(bench.model());
            UnfinishedStatus {
                requested_ml: dose.intent.requested_ml,
                planned_ml: dose.intent.planned_ml,
                delivered_least_ml,
                delivered_most_ml,
                steps: dose.intent.steps,
                steps_made_least: dose.made_least,
                steps_made_most: dose.made_most,
                began_unix_s: dose.intent.unix_s,
            }
        });
        Ok(Self {
            schema: "status/1",
            pump: bench.file().pump.id.clone(),
            driver: bench.driver().as_str(),
            recorded: recorded.is_some(),
            angle_deg: degrees(state.angle_rad),
            half_width_deg: degrees(state.half_width_rad),
            angle_known: state.phase().is_known(bench.model().pitch_rad()),
            angle_source: if state.phase().is_known(bench.model().pitch_rad()) {
                state.source
            } else {
                PhaseSource::Assumed
            },
            disturbances: state.disturbances,
            device_count: state.count,
            carry_ml: state.carry_ml,
            wear: state.wear,
            tube_life_ml: bench.file().tube.life_ml,
            calibration: bench
                .calibrations()
                .active()?
                .map(|stored| CalibrationStatus { version: stored.version, date: stored.calibration.date }),
            unfinished,
            in_use_by: bench.folder().holder(),
            folder: bench.folder().path().display().to_string(),
        })
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a status is plain data: {error}"))
    }

    /// The same in words.
    pub fn text(&self) -> String {
        let (pump, driver) = (&self.pump, self.driver);
        if !self.recorded {
            return format!(
                "{pump} ({driver}): nothing on record; {}\n",
                if self.angle_known {
                    "a fresh simulated pump stands at 0°"
                } else {
                    "where the rollers stand is unknown"
                }
            );
        }
        let angle = match self.half_width_deg {
            _ if !self.angle_known => "an unknown angle".to_owned(),
            0.0 => format!("{:.4}°", self.angle_deg),
            width => format!("{:.4}° ± {width:.2}°", self.angle_deg),
        };
        let mut text = format!(
            "{pump} ({driver}): rotor at {angle}, {:.2} µL carried to the next dose\n",
            1e3 * self.carry_ml,
        );
        // Writing to a String cannot fail.
        if self.disturbances == 1 && self.angle_known {
            text += "the rotor was let go, or its device reset, since its angle was found: another time, and it is unknown\n";
        }
        let Wear { volume_ml, revolutions, motion_s } = self.wear;
        let time = if motion_s < 3600.0 {
            format!("{:.1} min", motion_s / 60.0)
        } else {
            format!("{:.1} h", motion_s / 3600.0)
        };
        let life = self.tube_life_ml.map_or(String::new(), |life_ml| format!(" of {life_ml} mL"));
        let _ = writeln!(
            text,
            "tube: {volume_ml:.1} mL{life} in {revolutions:.1} revolutions and {time} of motion"
        );
        if let Some(CalibrationStatus { version, date }) = &self.calibration {
            let _ = writeln!(text, "doses use calibration {version} of {date}");
        }
        if let Some(dose) = &self.unfinished {
            let (asked_ml, made) =
                (dose.requested_ml, between(dose.delivered_least_ml, dose.delivered_most_ml));
            let _ = match &self.in_use_by {
                Some(holder) => writeln!(
                    text,
                    "in motion, by {holder}: a dose of {asked_ml} mL, of which {made} are delivered by the end of this stretch"
                ),
                None => writeln!(
                    text,
                    "unfinished: a dose of {asked_ml} mL, of which {made} were delivered; `dose resume` makes the rest, `dose \
                     discard` leaves it"
                ),
            };
        }
        text
    }
}
