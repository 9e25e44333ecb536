//! The motor: its driver, its port and its settings.

use std::path::PathBuf;

use clap::Args;
use pump_bench::pump_file::{DriverName, Pace};
use pump_bench::units;

use super::choice::choice;

/// The driver, which names the record too.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motor")]
pub(crate) struct DriverOption {
    /// sim, grbl, node or klipper
    #[arg(
        long_help = "Driver of the motor. The default is the pump file's, and sim without one: a simulated \
        motor."
    )]
    #[arg(long, value_name = "DRIVER", value_parser = choice(&[
        (DriverName::Sim, "A simulated stepper, pump and vessel"),
        (DriverName::Grbl, "A board that speaks grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC"),
        (DriverName::Node, "A board with this project's own firmware, which makes each step at the plan's time"),
        (DriverName::Klipper, "A board with the Klipper firmware, which makes each step at the plan's time"),
    ]))]
    pub(crate) driver: Option<DriverName>,
}

/// The port of the motor's controller.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motor")]
pub(crate) struct PortOption {
    /// Serial port, as /dev/ttyUSB0
    #[arg(
        long_help = "Serial port of the motor's controller, as /dev/ttyUSB0. The default is the pump file's."
    )]
    #[arg(long, value_name = "DEVICE")]
    pub(crate) port: Option<PathBuf>,
}

/// Everything that a command needs that turns the motor or connects to it.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motor")]
pub(crate) struct MotorOptions {
    #[command(flatten)]
    pub(crate) driver: DriverOption,
    #[command(flatten)]
    pub(crate) port: PortOption,
    /// Write the controller's settings where they do not fit the pump, and say which
    #[arg(long)]
    pub(crate) configure: bool,
    /// Accept another controller than the last time, or other settings of it
    #[arg(long)]
    pub(crate) accept_settings: bool,
    /// Wait so long while another command has the pump or its port, as 60s [default: refuse at once]
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) wait: Option<f64>,
    /// Move the pump from here, also while `dose serve` has it
    #[arg(long, hide_short_help = true)]
    pub(crate) no_service: bool,
    /// Pace of a simulated motor [default: the pump file's, or fast; of a rack real]
    #[arg(long, value_name = "real|fast", value_parser = choice(&[
        (Pace::Real, "It takes the time of its plan"),
        (Pace::Fast, "It takes no time; the motors of a rack keep step with each other"),
    ]))]
    pub(crate) pace: Option<Pace>,
    /// Say that the pump's values are those of your pump, where nobody wrote them
    #[arg(
        long_help = "Say that the pump's values are those of your pump. A real motor does not move while its steps \
        per revolution, its direction or its head are filled in: those of a built-in pump, and those beside \
        `confirmed = false` in a pump file. The record keeps the word until such a value changes."
    )]
    #[arg(long)]
    pub(crate) confirm_pump: bool,
}
