//! The options that answer questions of a first run.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use pump_bench::pump_file::{Axis, DriverName, OutletEnd};
use pump_bench::setup::{Answers, HeadAnswer, MotorSocket};
use pump_bench::units::{
    self, FULL_STEPS_PER_REV, MICROSTEPS, Pressure, ROLLERS, STEPS_PER_REV, StatedReading, TubeSize, count,
    stated_reading,
};
use pump_model::units::{degrees, rpm};

use super::head::length_or_unknown;
use crate::failure::Failure;
use crate::options::choice::choice;
use crate::options::limits::ambient_kpa;

/// The contact angle in deg, without the last digits that rad have left.
pub(super) fn contact_in_deg(rad: f64) -> f64 {
    (1e9 * degrees(rad)).round() / 1e9
}

/// Dimensions that a head has if it is drawn.
const DRAWING: [&str; 5] = ["tube", "backplate", "roller", "offset", "contact"];

/// The answers that a command line gives.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("drawing").multiple(true).conflicts_with_all(["head", "ml_per_rev", "from"]))]
pub(super) struct AnswerOptions {
    /// Head of the catalogue, as masterflex-ls-16 (`dose pumps list --catalogue`)
    #[arg(long, value_name = "NAME", help_heading = "Head")]
    #[arg(conflicts_with_all = ["ml_per_rev", "from"])]
    head: Option<String>,
    /// Volume of a revolution, as 0.5mL
    #[arg(long, value_name = "VOLUME", help_heading = "Head", value_parser = units::volume_ml)]
    #[arg(conflicts_with = "from")]
    ml_per_rev: Option<f64>,
    /// Diameter of the tube's bore, as 1.6mm, or unknown, beside --ml-per-rev
    #[arg(long, value_name = "LENGTH", help_heading = "Head", value_parser = length_or_unknown)]
    bore: Option<f64>,
    /// Number of rollers
    #[arg(long, value_name = "N", help_heading = "Head")]
    #[arg(value_parser = count("number of rollers", ROLLERS))]
    rollers: Option<u32>,
    /// Pump file to begin with, in place of a head
    #[arg(long, value_name = "FILE", help_heading = "Head")]
    from: Option<PathBuf>,
    /// Tube of a drawn head: bore x outer diameter, as 10x14mm
    #[arg(long, value_name = "SIZE", help_heading = "Head", value_parser = units::tube_size, group = "drawing")]
    tube: Option<TubeSize>,
    /// Radius of the backplate, as 63mm
    #[arg(long, value_name = "RADIUS", help_heading = "Head", value_parser = units::length_mm, group = "drawing")]
    backplate: Option<f64>,
    /// Radius of a roller, as 20mm
    #[arg(long, value_name = "RADIUS", help_heading = "Head", value_parser = units::length_mm, group = "drawing")]
    roller: Option<f64>,
    /// From the shaft to a roller's axis, as 40mm
    #[arg(long, value_name = "LENGTH", help_heading = "Head", value_parser = units::length_mm, group = "drawing")]
    offset: Option<f64>,
    /// Contact angle: the backplate spans 180deg and twice this, as 30deg
    #[arg(long, value_name = "ANGLE", help_heading = "Head", value_parser = units::angle_rad, group = "drawing")]
    #[arg(allow_hyphen_values = true)]
    contact: Option<f64>,
    /// Steps per revolution of the motor, microsteps included, as 3200
    #[arg(long, value_name = "N", help_heading = "Motor", conflicts_with_all = ["full_steps", "microsteps"])]
    #[arg(value_parser = count("number of steps per revolution", STEPS_PER_REV))]
    steps_per_rev: Option<u32>,
    /// Full steps per revolution of the motor [default: 200]
    #[arg(long, value_name = "N", help_heading = "Motor")]
    #[arg(value_parser = count("number of full steps per revolution", FULL_STEPS_PER_REV))]
    full_steps: Option<u32>,
    /// Microsteps per full step, as the stepper driver is set, as 16
    #[arg(long, value_name = "N", help_heading = "Motor")]
    #[arg(value_parser = count("number of microsteps", MICROSTEPS))]
    microsteps: Option<u32>,
    /// Revolutions of the motor per revolution of the pump head [default: 1]
    #[arg(long, value_name = "RATIO", help_heading = "Motor")]
    gear: Option<f64>,
    /// Fastest speed of the pump head [default: 100rpm]
    #[arg(long, value_name = "SPEED", help_heading = "Motor", value_parser = units::speed_rad_s)]
    max_speed: Option<f64>,
    /// Driver of the motor: sim, or grbl, node or klipper for a board
    #[arg(long, value_name = "sim|grbl|node|klipper", help_heading = "Motor", value_parser = choice(&[
        (DriverName::Sim, "A simulated stepper, pump and vessel"),
        (DriverName::Grbl, "A board that speaks grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC"),
        (DriverName::Node, "A board with this project's own firmware, which makes each step at the plan's time"),
        (DriverName::Klipper, "A printer board with the Klipper firmware, which makes each step at the plan's time"),
    ]))]
    driver: Option<DriverName>,
    /// Serial port of the board, as /dev/ttyUSB0
    #[arg(long, value_name = "DEVICE", help_heading = "Motor")]
    port: Option<PathBuf>,
    /// Axis of the board
    #[arg(long, value_name = "X|Y|Z|A|B|C", help_heading = "Motor", value_parser = axis)]
    axis: Option<Axis>,
    /// Socket of a board with the Klipper firmware, as skr-mini-e3-v3:X, or pins, as step=PB13,dir=PB12,enable=!PB14
    #[arg(long, value_name = "SOCKET", help_heading = "Motor")]
    socket: Option<MotorSocket>,
    /// Current of the motor (RMS) at a socket whose stepper driver the board sets, as 0.5A
    #[arg(long, value_name = "CURRENT", help_heading = "Motor", value_parser = units::current_a)]
    current: Option<f64>,
    /// Current of that motor at rest (RMS), as 0.3A [default: that of the turning motor]
    #[arg(long, value_name = "CURRENT", help_heading = "Motor", value_parser = units::current_a)]
    hold_current: Option<f64>,
    /// Way in which the pump runs as the axis counts up
    #[arg(long, value_name = "forward|reverse", help_heading = "Motor", value_parser = is_reverse)]
    direction: Option<IsReverse>,
    /// Write the board's settings where they do not fit the pump, and say which
    #[arg(long, help_heading = "Motor")]
    configure: bool,
    /// Altitude of the pump, as 500m; it gives the air's pressure (ISO 2533)
    #[arg(long, value_name = "HEIGHT", help_heading = "Place", value_parser = units::height_mm)]
    #[arg(conflicts_with = "ambient")]
    altitude: Option<f64>,
    /// Pressure of the air around the pump, as 98.2kPaa
    #[arg(long, value_name = "PRESSURE", help_heading = "Place", value_parser = units::pressure)]
    ambient: Option<Pressure>,
    /// Height of the pump above the supply's surface, as 1.2m
    #[arg(long, value_name = "HEIGHT", help_heading = "Place", value_parser = units::height_mm)]
    #[arg(allow_hyphen_values = true)]
    suction_lift: Option<f64>,
    /// Height of the vessel above the pump, as 0.5m
    #[arg(long, value_name = "HEIGHT", help_heading = "Place", value_parser = units::height_mm)]
    #[arg(allow_hyphen_values = true)]
    discharge_lift: Option<f64>,
    /// Where the outlet ends: in air, from which drops fall, or immersed in the vessel's liquid
    #[arg(long, value_name = "air|immersed", help_heading = "Place", value_parser = choice(&[
        (OutletEnd::Air, "Drops hang from it and fall"),
        (OutletEnd::Immersed, "Below the surface of the liquid in the vessel"),
    ]))]
    outlet_end: Option<OutletEnd>,
    /// Diameter of the outlet's end, as 1.6mm, or unknown
    #[arg(long, value_name = "LENGTH", help_heading = "Place", value_parser = length_or_unknown)]
    nozzle_bore: Option<f64>,
    /// Rate of a dose that names none, as 0.2mL/s
    #[arg(long, value_name = "FLOW", help_heading = "First dose", value_parser = units::flow_ml_s)]
    rate: Option<f64>,
    /// How far the head turns when one revolution is asked of it: 1, or as 1/4 or 90deg
    #[arg(long, value_name = "TURNS", help_heading = "First dose", value_parser = turns)]
    pub(super) turned: Option<f64>,
    /// Volume that fills the line, as 5mL; 0 for a line that is full
    #[arg(long, value_name = "VOLUME", help_heading = "First dose", value_parser = volume_or_0)]
    pub(super) prime: Option<f64>,
    /// Volume of the dose that is weighed, as 5mL [default: what fits the head]
    #[arg(long, value_name = "VOLUME", help_heading = "First dose", value_parser = units::volume_ml)]
    pub(super) volume: Option<f64>,
    /// Reading of the scale for that dose, as 4.93g
    #[arg(long, value_name = "READING", help_heading = "First dose", value_parser = stated_reading)]
    #[arg(conflicts_with_all = ["scale_port", "scale_command"])]
    pub(super) weight: Option<StatedReading>,
    /// Temperature of the water that is weighed, as 22degC [default: 25degC]
    #[arg(long, value_name = "TEMPERATURE", help_heading = "First dose", value_parser = units::temperature_degc)]
    pub(super) temperature: Option<f64>,
}

/// True if the pump runs in reverse as the axis counts up.
#[derive(Debug, Clone, Copy)]
pub(super) struct IsReverse(bool);

fn is_reverse(text: &str) -> Result<IsReverse, String> {
    match text {
        "forward" => Ok(IsReverse(false)),
        "reverse" => Ok(IsReverse(true)),
        _ => Err(format!("`{text}` is neither forward nor reverse")),
    }
}

/// Reads the letter of an axis.
pub(super) fn axis(text: &str) -> Result<Axis, String> {
    Axis::try_from(text.to_owned())
}

/// Reads how far the head turned, in turns.
pub(super) fn turns(text: &str) -> Result<f64, String> {
    pump_bench::setup::turns(text).map_err(|error| error.to_string())
}

/// Reads a volume, or 0.
pub(super) fn volume_or_0(text: &str) -> Result<f64, String> {
    match text.trim() {
        "0" | "0mL" | "0 mL" => Ok(0.0),
        text => units::volume_ml(text).map_err(|error| error.to_string()),
    }
}

impl AnswerOptions {
    /// Writes the answers of the command line over those on record.
    pub(super) fn write_to(&self, answers: &mut Answers) -> Result<(), Failure> {
        if let Some(head) = self.head(answers.head.as_ref())? {
            answers.head = Some(head);
        }
        if self.bore.is_some() && !matches!(answers.head, None | Some(HeadAnswer::Volume { .. })) {
            return Err(Failure::refused(
                "--bore stands beside a volume per revolution; any other head knows its own",
            ));
        }
        if self.steps_per_rev.is_some() {
            (answers.steps_per_rev, answers.full_steps, answers.microsteps) =
                (self.steps_per_rev, None, None);
        }
        if self.microsteps.is_some() {
            answers.steps_per_rev = None;
        }
        if self.altitude.is_some() || self.ambient.is_some() {
            (answers.altitude_m, answers.ambient_kpa) = (None, None);
        }
        let ambient_kpa = self.ambient.map(ambient_kpa).transpose()?;
        put(&mut answers.rollers, self.rollers);
        put(&mut answers.tube_bore_mm, self.bore);
        put(&mut answers.full_steps, self.full_steps);
        put(&mut answers.microsteps, self.microsteps);
        put(&mut answers.gear, self.gear);
        put(&mut answers.max_speed_rpm, self.max_speed.map(rpm));
        put(&mut answers.driver, self.driver);
        put(&mut answers.port, self.port.clone());
        put(&mut answers.axis, self.axis);
        if let Some(socket) = &self.socket {
            answers.set_socket(socket.clone());
        }
        put(&mut answers.current_a, self.current);
        put(&mut answers.hold_a, self.hold_current);
        put(&mut answers.invert, self.direction.map(|IsReverse(is_reverse)| is_reverse));
        put(&mut answers.configure, self.configure.then_some(true));
        put(&mut answers.altitude_m, self.altitude.map(|mm| 1e-3 * mm));
        put(&mut answers.ambient_kpa, ambient_kpa);
        put(&mut answers.suction_lift_mm, self.suction_lift);
        put(&mut answers.discharge_lift_mm, self.discharge_lift);
        put(&mut answers.outlet_end, self.outlet_end);
        put(&mut answers.nozzle_bore_mm, self.nozzle_bore);
        put(&mut answers.rate_ml_s, self.rate);
        put(&mut answers.prime_ml, self.prime);
        put(&mut answers.volume_ml, self.volume);
        Ok(())
    }

    /// The head that is given. A dimension alone changes the drawing on record.
    fn head(&self, before: Option<&HeadAnswer>) -> Result<Option<HeadAnswer>, Failure> {
        if let Some(name) = &self.head {
            return Ok(Some(HeadAnswer::Catalogue(name.clone())));
        }
        if let Some(ml_per_rev) = self.ml_per_rev {
            return Ok(Some(HeadAnswer::Volume { ml_per_rev }));
        }
        if let Some(path) = &self.from {
            let path = std::path::absolute(path).map_err(|error| Failure::unread(path, &error))?;
            return Ok(Some(HeadAnswer::File(path)));
        }
        let tube = self.tube.map(|tube| (tube.bore_mm, tube.outer_mm));
        let given = (tube, [self.backplate, self.roller, self.offset, self.contact.map(contact_in_deg)]);
        if given == (None, [None; 4]) {
            return Ok(None);
        }
        let (drawn_tube, drawn) = match before {
            Some(HeadAnswer::Drawing {
                bore_mm,
                outer_mm,
                backplate_mm,
                roller_mm,
                offset_mm,
                contact_deg,
            }) => (Some((*bore_mm, *outer_mm)), [backplate_mm, roller_mm, offset_mm, contact_deg].map(Some)),
            _ => (None, [None; 4]),
        };
        let at = |index: usize| given.1[index].or(drawn[index].copied());
        let dimensions = (given.0.or(drawn_tube), at(0), at(1), at(2), at(3));
        let (
            Some((bore_mm, outer_mm)),
            Some(backplate_mm),
            Some(roller_mm),
            Some(offset_mm),
            Some(contact_deg),
        ) = dimensions
        else {
            return Err(Failure::refused(format!(
                "a drawing takes --{}; one of them alone changes a drawing that is on record",
                DRAWING.join(", --")
            )));
        };
        Ok(Some(HeadAnswer::Drawing { bore_mm, outer_mm, backplate_mm, roller_mm, offset_mm, contact_deg }))
    }
}

/// Replaces an answer by the one that is given.
fn put<T>(answer: &mut Option<T>, given: Option<T>) {
    if given.is_some() {
        *answer = given;
    }
}
