//! `[drive]`: the drive that turns the motor.

mod driver_fault;
mod klipper;
mod klipper_pin;
mod pins;
pub(crate) mod tmc_range;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use driver_fault::DriverFault;
pub use klipper::{KlipperTable, TmcTable};
pub use klipper_pin::{KlipperPin, KlipperPinError, PinPull};
pub use pins::{Pins, PinsTable};

use super::motor::MotorTable;
use super::range::{WrongValue, allow, within, within_if_given};
use crate::words::words;

/// The table `[drive]`.
///
/// ```
/// use pump_bench::pump_file::{Axis, DriveTable, DriverName};
///
/// let table = DriveTable::of(DriverName::Grbl).with_port("/dev/ttyUSB0").with_axis(Axis::Y);
/// assert_eq!((table.rate_baud(), table.axis), (115_200, Axis::Y));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct DriveTable {
    /// Driver that turns the motor.
    pub driver: DriverName,
    /// Serial port of the controller, such as `/dev/ttyUSB0`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<PathBuf>,
    /// Rate of the serial port, in bits per second. `None` takes the driver's usual rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub baud: Option<u32>,
    /// Axis of the controller that turns the pump head.
    #[serde(default)]
    pub axis: Axis,
    /// True if the pump runs in reverse when the axis counts up.
    #[serde(default)]
    pub invert: bool,
    /// Time that an idle motor holds in a session before it is released, in s. `None` holds it as long as the
    /// session lasts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_timeout_s: Option<f64>,
    /// Angle of the rotor at which the index sensor answers when the pump runs forward, in deg. `None` if
    /// there is no sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index_angle_deg: Option<f64>,
    /// Largest error of the index angle, in deg.
    #[serde(default = "usual_index_width_deg")]
    pub index_width_deg: f64,
    /// Time without a word of this computer after which a node decelerates and a Klipper board stops, in ms. `None`
    /// takes 500 ms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_man_ms: Option<u16>,
    /// Pace of a simulated motor. `None` takes no time for a motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
    /// Times and polarity of a step driver's pins, which a node keeps to. `None` takes those of a DRV8825.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pins: Option<PinsTable>,
    /// Pins and stepper driver at a board with the Klipper firmware, which needs them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub klipper: Option<KlipperTable>,
}

/// Shortest and longest dead-man time, and the usual one, in ms. The board's queue holds 200 ms at least.
const DEAD_MAN_MS: (u16, u16, u16) = (100, 10_000, 500);

/// Slowest line to a node, in bits per second. Each of four axes that move is asked for its state every 20 ms, and the
/// answers are some 2 kB/s an axis, of ten bits a byte. Segments of a plan come on top.
const LEAST_NODE_BAUD: u32 = 115_200;

/// Returns the width that a forked light barrier on a disc of a few centimetres keeps to, in deg.
fn usual_index_width_deg() -> f64 {
    0.5
}

/// A driver of the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriverName {
    /// Virtual stepper, pump and vessel. Nothing moves.
    Sim,
    /// Axis of a controller that speaks the protocol of grbl 1.1 over a serial port: grbl, grblHAL, FluidNC.
    Grbl,
    /// Axis of a board that runs this project's own firmware and makes each step at the plan's time.
    Node,
    /// Motor at a board that runs the Klipper firmware and makes each step at the plan's time.
    Klipper,
}

/// An axis of a controller. grbl 1.1 has the first three, a node the first four: its axes 0 to 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub enum Axis {
    /// Axis with the settings 100, 110 and 120.
    #[default]
    X,
    /// Axis with the settings 101, 111 and 121.
    Y,
    /// Axis with the settings 102, 112 and 122.
    Z,
    /// Axis with the settings 103, 113 and 123.
    A,
    /// Axis with the settings 104, 114 and 124.
    B,
    /// Axis with the settings 105, 115 and 125.
    C,
}

impl TryFrom<String> for Axis {
    type Error = String;

    /// Reads an axis, in capitals or not.
    fn try_from(text: String) -> Result<Self, String> {
        let unknown = |error| format!("{error}; a node has X, Y, Z and A alone");
        text.to_uppercase().parse().map_err(unknown)
    }
}

/// The pace of a simulated motor. A real one keeps real time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pace {
    /// Motions take the time of their plans.
    Real,
    /// Motions take no time.
    Fast,
}

words!(Pace { Real = "real", Fast = "fast" });
words!(DriverName { Sim = "sim", Grbl = "grbl", Node = "node", Klipper = "klipper" });
words!(Axis { X = "X", Y = "Y", Z = "Z", A = "A", B = "B", C = "C" });

impl DriveTable {
    /// Returns the table of a driver with the usual settings.
    pub fn of(driver: DriverName) -> Self {
        Self {
            driver,
            port: None,
            baud: None,
            axis: Axis::default(),
            invert: false,
            hold_timeout_s: None,
            index_angle_deg: None,
            index_width_deg: usual_index_width_deg(),
            dead_man_ms: None,
            pace: None,
            pins: None,
            klipper: None,
        }
    }

    /// Returns the table with the pins and the stepper driver at a board with the Klipper firmware.
    #[must_use]
    pub fn with_klipper(self, klipper: KlipperTable) -> Self {
        Self { klipper: Some(klipper), ..self }
    }

    /// Returns the table with the times and the polarity of a step driver's pins.
    #[must_use]
    pub fn with_pins(self, pins: PinsTable) -> Self {
        Self { pins: Some(pins), ..self }
    }

    /// Returns the table with the time without a word of this computer after which a node decelerates, in ms.
    #[must_use]
    pub fn with_dead_man_ms(self, dead_man_ms: u16) -> Self {
        Self { dead_man_ms: Some(dead_man_ms), ..self }
    }

    /// Returns the times and the polarity of the step driver's pins: those that are given, or the usual ones.
    pub fn pins_or_usual(&self) -> Pins {
        self.pins.unwrap_or_default().or_usual()
    }

    /// Returns the dead-man time, in ms: the one that is given, or the usual one.
    pub fn dead_man_or_usual_ms(&self) -> u16 {
        self.dead_man_ms.unwrap_or(DEAD_MAN_MS.2)
    }

    /// Returns the table with the serial port of the controller.
    #[must_use]
    pub fn with_port(self, port: impl Into<PathBuf>) -> Self {
        Self { port: Some(port.into()), ..self }
    }

    /// Returns the table with a rate of the serial port, in bits per second.
    #[must_use]
    pub fn with_baud(self, baud: u32) -> Self {
        Self { baud: Some(baud), ..self }
    }

    /// Returns the table with the axis that turns the pump head.
    #[must_use]
    pub fn with_axis(self, axis: Axis) -> Self {
        Self { axis, ..self }
    }

    /// Returns the table of a pump that runs in reverse when the axis counts up, or forward.
    #[must_use]
    pub fn with_invert(self, invert: bool) -> Self {
        Self { invert, ..self }
    }

    /// Returns the table with the time that an idle motor holds before it is released, in s.
    #[must_use]
    pub fn with_hold_timeout_s(self, hold_timeout_s: f64) -> Self {
        Self { hold_timeout_s: Some(hold_timeout_s), ..self }
    }

    /// Returns the table with the angle at which the index sensor answers, in deg.
    #[must_use]
    pub fn with_index_angle_deg(self, index_angle_deg: f64) -> Self {
        Self { index_angle_deg: Some(index_angle_deg), ..self }
    }

    /// Returns the table with the pace of a simulated motor.
    #[must_use]
    pub fn with_pace(self, pace: Pace) -> Self {
        Self { pace: Some(pace), ..self }
    }

    /// Returns the rate of the serial port, in bits per second: the one that is given, or the driver's usual one.
    ///
    /// Most grbl boards on a USB cable speak 115200. A node needs more for a smooth flow. The Klipper firmware speaks
    /// 250000 (Klipper3d/klipper, `docs/Config_Reference.md`, `[mcu]`).
    pub fn rate_baud(&self) -> u32 {
        self.baud.unwrap_or(match self.driver {
            DriverName::Sim | DriverName::Grbl => 115_200,
            DriverName::Node => 460_800,
            DriverName::Klipper => 250_000,
        })
    }

    /// Refuses a table without the port that its driver needs.
    pub(super) fn check_port(&self) -> Result<(), WrongValue> {
        let needs_port = match self.driver {
            DriverName::Sim => false,
            DriverName::Grbl | DriverName::Node | DriverName::Klipper => true,
        };
        if needs_port && self.port.is_none() {
            let allowed = "a serial port, as \"/dev/ttyUSB0\"";
            return Err(WrongValue::missing("[drive] port", allowed));
        }
        Ok(())
    }

    /// Refuses the first value outside its range.
    pub(super) fn check(&self, motor: &MotorTable) -> Result<(), WrongValue> {
        let has_name = self.port.as_ref().is_none_or(|port| !port.as_os_str().is_empty());
        allow(has_name, "[drive] port", "\"\"", "a serial port, as \"/dev/ttyUSB0\"")?;
        if let Some(baud) = self.baud {
            within("[drive] baud", baud, 300..=4_000_000)?;
            let allowed = "115200 to 4000000 beside driver = \"node\"; the Pico's own firmware speaks 460800";
            let carries = self.driver != DriverName::Node || baud >= LEAST_NODE_BAUD;
            allow(carries, "[drive] baud", baud, allowed)?;
        }
        if let Some(time_s) = self.hold_timeout_s {
            allow(time_s >= 0.0 && time_s.is_finite(), "[drive] hold_timeout_s", time_s, "0 or more")?;
        }
        within_if_given("[drive] index_angle_deg", self.index_angle_deg, -360.0..=360.0)?;
        within("[drive] index_width_deg", self.index_width_deg, 0.0..=180.0)?;
        self.check_board_keys(motor)?;
        let is_simulated = self.driver == DriverName::Sim;
        let allowed = "beside driver = \"sim\" only, since a real motor keeps real time";
        allow(is_simulated || self.pace.is_none(), "[drive] pace", "given", allowed)?;
        if let Some(dead_man_ms) = self.dead_man_ms {
            let (least, most, _) = DEAD_MAN_MS;
            within("[drive] dead_man_ms", dead_man_ms, least..=most)?;
        }
        self.pins.map_or(Ok(()), |pins| pins.check())
    }

    /// Refuses keys of another board than the driver's, and a Klipper board without its pins.
    fn check_board_keys(&self, motor: &MotorTable) -> Result<(), WrongValue> {
        let is = |driver| self.driver == driver;
        let (is_node, is_klipper) = (is(DriverName::Node), is(DriverName::Klipper));
        let allowed = "beside driver = \"node\" only, since other boards have their own";
        allow(self.pins.is_none() || is_node, "[drive.pins]", "given", allowed)?;
        let allowed = "beside driver = \"node\" or \"klipper\" only, since other boards have their own";
        allow(self.dead_man_ms.is_none() || is_node || is_klipper, "[drive] dead_man_ms", "given", allowed)?;
        let allowed =
            "no axis beside driver = \"klipper\", whose pins in [drive.klipper] say which motor turns";
        allow(!is_klipper || self.axis == Axis::default(), "[drive] axis", self.axis, allowed)?;
        let is_of_node = !matches!(self.axis, Axis::B | Axis::C);
        allow(!is_node || is_of_node, "[drive] axis", self.axis, "X, Y, Z or A beside driver = \"node\"")?;
        let allowed = "beside driver = \"klipper\" only, since other boards have pins of their own";
        allow(self.klipper.is_none() || is_klipper, "[drive.klipper]", "given", allowed)?;
        match &self.klipper {
            Some(klipper) => {
                klipper.check(self.index_angle_deg.is_some())?;
                klipper.tmc.as_ref().map_or(Ok(()), |tmc| tmc.check_motor(motor))
            }
            None if is_klipper => {
                let allowed =
                    "a table with the pins step and dir, as step = \"PB13\", and enable if there is one";
                Err(WrongValue::missing("[drive.klipper]", allowed))
            }
            None => Ok(()),
        }
    }
}
