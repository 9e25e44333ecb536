//! `[drive]`: what turns the motor.

use std::fmt::Display;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::words::words;

/// `[drive]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveTable {
    /// What turns the motor.
    pub driver: DriverName,
    /// Serial port of the controller, as `/dev/ttyUSB0`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<PathBuf>,
    /// Bits per second; boards at the end of a USB cable mostly speak 115200.
    #[serde(default = "usual_baud")]
    pub baud: u32,
    /// Which of the controller's axes is the pump head.
    #[serde(default)]
    pub axis: Axis,
    /// Whether the axis runs in reverse when it counts up.
    #[serde(default)]
    pub invert: bool,
    /// How long the motor holds with nothing to do in a session before it is let go, s; none holds as long as it lasts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_timeout_s: Option<f64>,
    /// Angle of the rotor at which the index sensor answers when the pump runs forward, deg; none: there is no sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index_angle_deg: Option<f64>,
    /// How far off that angle may be, deg.
    #[serde(default = "usual_index_width_deg")]
    pub index_width_deg: f64,
}

fn usual_baud() -> u32 {
    115_200
}

/// What a forked light barrier on a disc of a few centimetres keeps to.
fn usual_index_width_deg() -> f64 {
    0.5
}

/// The drivers that exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriverName {
    /// A virtual stepper, pump and vessel: nothing moves.
    Sim,
    /// An axis of a controller that speaks grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC.
    Grbl,
}

/// Axes of a controller. grbl 1.1 has the first three.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Axis {
    /// Settings 100, 110, 120.
    #[default]
    X,
    /// Settings 101, 111, 121.
    Y,
    /// Settings 102, 112, 122.
    Z,
    /// Settings 103, 113, 123.
    A,
    /// Settings 104, 114, 124.
    B,
    /// Settings 105, 115, 125.
    C,
}

words!(DriverName { Sim = "sim", Grbl = "grbl" });

impl Axis {
    /// Its place among the axes, 0 for X.
    pub fn number(self) -> usize {
        self as usize
    }

    /// Its letter.
    pub fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
            Self::A => 'A',
            Self::B => 'B',
            Self::C => 'C',
        }
    }
}

impl DriveTable {
    /// A driver with what is usual.
    pub fn of(driver: DriverName) -> Self {
        Self {
            driver,
            port: None,
            baud: usual_baud(),
            axis: Axis::default(),
            invert: false,
            hold_timeout_s: None,
            index_angle_deg: None,
            index_width_deg: usual_index_width_deg(),
        }
    }

    /// Hands each value with its key, and what is allowed of it, to `value`.
    pub(super) fn check<E>(
        &self,
        value: impl Fn(bool, &'static str, &dyn Display, &'static str) -> Result<(), E>,
    ) -> Result<(), E> {
        value((300..=4_000_000).contains(&self.baud), "[drive] baud", &self.baud, "300 to 4000000")?;
        if let Some(time_s) = self.hold_timeout_s {
            value(time_s >= 0.0 && time_s.is_finite(), "[drive] hold_timeout_s", &time_s, "0 or more")?;
        }
        if let Some(angle) = self.index_angle_deg {
            value(angle.abs() <= 360.0, "[drive] index_angle_deg", &angle, "-360 to 360")?;
        }
        let width = self.index_width_deg;
        value((0.0..=180.0).contains(&width), "[drive] index_width_deg", &width, "0 to 180")
    }
}
