//! The answers of a first run: what a person has said of a pump so far, and how far the run has come.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::motor_socket::MotorSocket;
use super::topic::Topic;
use crate::pump_file::{Axis, DriverName, OutletEnd};

/// Schema of the record of a first run.
pub(super) const SCHEMA: &str = "setup/1";

/// Answers of a first run (`schema` `setup/1`). An answer that was not given yet is `None`.
///
/// ```
/// use pump_bench::setup::{Answers, HeadAnswer};
///
/// let mut answers = Answers::of("acid");
/// answers.head = Some(HeadAnswer::Volume { ml_per_rev: 0.5 });
/// assert_eq!(Answers::parse(&answers.to_toml()).unwrap(), answers);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Answers {
    /// `setup/1`.
    pub schema: String,
    /// Name of the pump. It is the pump's id too.
    pub name: String,
    /// Time of the last answer by the system clock, in seconds since 1970.
    pub unix_s: u64,
    /// Questions that a person has answered. An answer that an option or another pump gave is not among them.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub asked: BTreeSet<Topic>,
    /// Number of rollers.
    pub rollers: Option<u32>,
    /// Diameter of the tube's bore beside a volume of a revolution, in mm. 0 for a bore that nobody knows.
    pub tube_bore_mm: Option<f64>,
    /// Steps per revolution of the motor, microsteps included. `None` where full steps and microsteps are said.
    pub steps_per_rev: Option<u32>,
    /// Full steps per revolution of the motor.
    pub full_steps: Option<u32>,
    /// Microsteps per full step.
    pub microsteps: Option<u32>,
    /// Revolutions of the motor per revolution of the pump head.
    pub gear: Option<f64>,
    /// Fastest speed of the pump head, in r/min. `None` keeps the usual one.
    pub max_speed_rpm: Option<f64>,
    /// Driver of the motor.
    pub driver: Option<DriverName>,
    /// Serial port of the board.
    pub port: Option<PathBuf>,
    /// Axis of the board.
    pub axis: Option<Axis>,
    /// Socket of a board with the Klipper firmware.
    pub socket: Option<MotorSocket>,
    /// Current of the motor at a socket with a stepper driver that is set over its wire, in A (RMS).
    pub current_a: Option<f64>,
    /// Current of that motor at rest, in A (RMS). `None` takes that of the turning motor.
    pub hold_a: Option<f64>,
    /// True if the pump runs in reverse when the axis counts up.
    pub invert: Option<bool>,
    /// True if the board's settings may be written where they do not fit the pump.
    pub configure: Option<bool>,
    /// Altitude of the pump, in m.
    pub altitude_m: Option<f64>,
    /// Pressure of the air, in kPa absolute, in place of the altitude.
    pub ambient_kpa: Option<f64>,
    /// Height of the pump above the supply's surface, in mm.
    pub suction_lift_mm: Option<f64>,
    /// Height of the vessel above the pump, in mm.
    pub discharge_lift_mm: Option<f64>,
    /// Place of the outlet's end.
    pub outlet_end: Option<OutletEnd>,
    /// Diameter of the outlet's end in air, in mm. 0 for one that nobody knows.
    pub nozzle_bore_mm: Option<f64>,
    /// Rate of a dose that names none, in mL/s.
    pub rate_ml_s: Option<f64>,
    /// Volume that fills the line, in mL. 0 for a line that is full.
    pub prime_ml: Option<f64>,
    /// Volume of the dose that is weighed, in mL.
    pub volume_ml: Option<f64>,
    /// Head of the pump.
    pub head: Option<HeadAnswer>,
    /// Steps of the run that are done.
    #[serde(default)]
    pub done: Done,
}

/// Head of a pump, as a person knows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum HeadAnswer {
    /// Name of a head of the catalogue.
    Catalogue(String),
    /// Volume of a revolution.
    Volume {
        /// Volume of a revolution, in mL.
        ml_per_rev: f64,
    },
    /// Dimensions of a drawing.
    Drawing {
        /// Diameter of the tube's bore, in mm.
        bore_mm: f64,
        /// Outer diameter of the tube, in mm.
        outer_mm: f64,
        /// Radius of the backplate, in mm.
        backplate_mm: f64,
        /// Radius of a roller, in mm.
        roller_mm: f64,
        /// Distance from the shaft to a roller's axis, in mm.
        offset_mm: f64,
        /// Contact angle, in deg.
        contact_deg: f64,
    },
    /// Pump file that describes the head, the motor and the lines.
    File(PathBuf),
}

/// Steps of a first run that are done.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Done {
    /// Check number (CRC-32) of the pump file that was written. `None` until it is.
    pub written: Option<u32>,
    /// True once the motor has turned one revolution and the mark came back.
    #[serde(default)]
    pub turned: bool,
    /// True once somebody has seen that the pump turns the right way.
    #[serde(default)]
    pub directed: bool,
    /// Volume that the filling of the line left out when it ended, in mL: 0 once it came to its end. `None` before it.
    #[serde(default)]
    pub prime_left_ml: Option<f64>,
    /// True once the line is full.
    #[serde(default)]
    pub primed: bool,
    /// True once the dose is in the vessel, until it is weighed.
    #[serde(default)]
    pub dosed: bool,
    /// Number of the last dose of the run, in the pump's log. `None` before it, and in answers of an early version.
    #[serde(default)]
    pub dose: Option<u64>,
    /// Reading of the balance before the last dose of the run, in g. `None` for a dose that no balance stood ready for.
    #[serde(default)]
    pub before_g: Option<f64>,
    /// Number of doses that were weighed.
    #[serde(default)]
    pub weighed: u32,
    /// True once the run has ended with the pump file alone, as its owner asked for.
    #[serde(default)]
    pub file_alone: bool,
}

impl Answers {
    /// Returns the answers of a pump of this name, of which nothing else is said.
    pub fn of(name: impl Into<String>) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            name: name.into(),
            unix_s: 0,
            asked: BTreeSet::new(),
            rollers: None,
            tube_bore_mm: None,
            steps_per_rev: None,
            full_steps: None,
            microsteps: None,
            gear: None,
            max_speed_rpm: None,
            driver: None,
            port: None,
            axis: None,
            socket: None,
            current_a: None,
            hold_a: None,
            invert: None,
            configure: None,
            altitude_m: None,
            ambient_kpa: None,
            suction_lift_mm: None,
            discharge_lift_mm: None,
            outlet_end: None,
            nozzle_bore_mm: None,
            rate_ml_s: None,
            prime_ml: None,
            volume_ml: None,
            head: None,
            done: Done::default(),
        }
    }

    /// Reads the text of a record.
    ///
    /// # Errors
    /// Returns the parser's message for a text that is no record of a first run.
    pub fn parse(text: &str) -> Result<Self, String> {
        let answers: Self = toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
        if answers.schema == SCHEMA {
            Ok(answers)
        } else {
            Err(format!("schema is `{}`; allowed: {SCHEMA}", answers.schema))
        }
    }

    /// Returns the text of the record.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_else(|error| unreachable!("answers are plain values: {error}"))
    }

    /// Takes the answers of another pump where these have none. Name, axis, socket and direction are each pump's own.
    pub fn take_missing(&mut self, other: &Self) {
        fn missing<T: Clone>(answer: &mut Option<T>, other: &Option<T>) {
            if answer.is_none() {
                answer.clone_from(other);
            }
        }
        if !self.has_steps() {
            missing(&mut self.steps_per_rev, &other.steps_per_rev);
            missing(&mut self.microsteps, &other.microsteps);
            missing(&mut self.full_steps, &other.full_steps);
        }
        if !self.has_ambient() {
            missing(&mut self.altitude_m, &other.altitude_m);
            missing(&mut self.ambient_kpa, &other.ambient_kpa);
        }
        if self.head.is_none() {
            missing(&mut self.head, &other.head);
            missing(&mut self.rollers, &other.rollers);
            missing(&mut self.tube_bore_mm, &other.tube_bore_mm);
            missing(&mut self.rate_ml_s, &other.rate_ml_s);
            missing(&mut self.volume_ml, &other.volume_ml);
        }
        missing(&mut self.gear, &other.gear);
        missing(&mut self.max_speed_rpm, &other.max_speed_rpm);
        missing(&mut self.driver, &other.driver);
        missing(&mut self.port, &other.port);
        if self.current_a.is_none() && self.socket.as_ref().is_none_or(MotorSocket::has_driver_wire) {
            missing(&mut self.current_a, &other.current_a);
            missing(&mut self.hold_a, &other.hold_a);
        }
        missing(&mut self.suction_lift_mm, &other.suction_lift_mm);
        missing(&mut self.discharge_lift_mm, &other.discharge_lift_mm);
        missing(&mut self.outlet_end, &other.outlet_end);
        missing(&mut self.nozzle_bore_mm, &other.nozzle_bore_mm);
    }

    /// Returns true if the run came to its end: a dose was weighed, or the pump file alone was asked for. The answers
    /// of such a pump may be suggested for another one.
    pub fn is_finished(&self) -> bool {
        self.done.written.is_some() && (self.done.weighed > 0 || self.done.file_alone)
    }

    /// Returns true if a pump file describes the pump, so that it knows the rollers, the motor and the place.
    pub fn is_of_file(&self) -> bool {
        matches!(self.head, Some(HeadAnswer::File(_)))
    }

    /// Returns true if the motor's steps are said.
    pub fn has_steps(&self) -> bool {
        self.steps_per_rev.is_some() || self.microsteps.is_some()
    }

    /// Returns true if the pressure of the air is said.
    pub fn has_ambient(&self) -> bool {
        self.altitude_m.is_some() || self.ambient_kpa.is_some()
    }
}
