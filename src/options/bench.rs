//! The bench that a command works on: a pump, its record and its motor.

use std::env;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use pump_bench::Bench;
use pump_bench::pump_file::{DriverName, PumpFile};

use super::motor::{DriverOption, MotorOptions, PortOption};
use super::pump::{PumpOption, RecordOption};
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::say;

/// A bench whose motor may turn.
#[derive(Debug, Args)]
pub(crate) struct BenchOptions {
    #[command(flatten)]
    pub(crate) pump: PumpOption,
    #[command(flatten)]
    pub(crate) record: RecordOption,
    #[command(flatten)]
    pub(crate) motor: MotorOptions,
}

/// A bench of which only the record is used.
#[derive(Debug, Args)]
pub(crate) struct RecordOptions {
    #[command(flatten)]
    pub(crate) pump: PumpOption,
    #[command(flatten)]
    record: RecordOption,
    #[command(flatten)]
    driver: DriverOption,
}

impl BenchOptions {
    /// The bench with the pump file as it is.
    pub(crate) fn bench(&self) -> Result<Bench, Failure> {
        self.bench_of(self.pump.file()?)
    }

    /// The bench with this pump file.
    pub(crate) fn bench_of(&self, file: PumpFile) -> Result<Bench, Failure> {
        let MotorOptions { driver, port, configure, accept_settings, confirm_pump, .. } = &self.motor;
        let given = [
            ("--port", port.port.is_some()),
            ("--configure", *configure),
            ("--accept-settings", *accept_settings),
            ("--confirm-pump", *confirm_pump),
        ];
        refuse_unless_real(&file, driver, &given)?;
        if self.motor.pace.is_some() && !is_simulated(&file, driver) {
            return Err(Failure::refused(
                "--pace is that of a simulated motor, and a real one keeps real time; leave it out, or add --driver \
                 sim",
            ));
        }
        let keeps_none = match driver.driver.unwrap_or(file.driver()) {
            DriverName::Node => Some("a node"),
            DriverName::Klipper => Some("a Klipper board"),
            DriverName::Sim | DriverName::Grbl => None,
        };
        if let Some(board) = keeps_none.filter(|_| *configure) {
            return Err(Failure::refused(format!(
                "--configure writes the settings of a grbl board, and {board} keeps none: each command sends it \
                 those of the pump file; leave it out",
            )));
        }
        Ok(self
            .simulated(file)?
            .at_port(port.port.clone())
            .configuring(*configure)
            .accepting_settings(*accept_settings)
            .confirming_pump(*confirm_pump))
    }

    /// True if the motor of this pump file is simulated.
    pub(crate) fn is_simulated(&self, file: &PumpFile) -> bool {
        is_simulated(file, &self.motor.driver)
    }

    /// The bench with this pump file, without the options of real motors.
    pub(crate) fn simulated(&self, file: PumpFile) -> Result<Bench, Failure> {
        let MotorOptions { driver, wait, .. } = &self.motor;
        let bench = Bench::new(file, driver.driver, &self.record.folder(&self.pump.config()?)?)?;
        let limit = wait.map(|wait_s| Duration::try_from_secs_f64(wait_s).unwrap_or(Duration::MAX));
        let bench = match limit {
            Some(limit) => bench.waiting(limit, |text| say(&format!("{text}\n"))),
            None => bench,
        };
        // A program tries an order out that comes later, by another record.
        let is_trial = env::var_os("DOSE_TRIAL").is_some();
        Ok(bench.paced(self.motor.pace).stopping_on(interrupt::stop_request()).planning_afresh(is_trial))
    }
}

impl RecordOptions {
    /// The bench with the pump file as it is.
    pub(crate) fn bench(&self) -> Result<Bench, Failure> {
        self.bench_of(self.pump.file()?, None)
    }

    /// The folder in which records are kept.
    pub(crate) fn folder(&self) -> Result<PathBuf, Failure> {
        self.record.folder(&self.pump.config()?)
    }

    /// The driver that is named in place of that of a pump file.
    pub(crate) fn driver(&self) -> Option<DriverName> {
        self.driver.driver
    }

    /// The bench with this pump file, and the motor at this port.
    pub(crate) fn bench_of(&self, file: PumpFile, port: Option<&PortOption>) -> Result<Bench, Failure> {
        let port: Option<PathBuf> = port.and_then(|port| port.port.clone());
        refuse_unless_real(&file, &self.driver, &[("--port", port.is_some())])?;
        let folder = self.folder()?;
        Ok(Bench::new(file, self.driver.driver, &folder)?.at_port(port))
    }
}

/// Refuses options of real motors if the motor is simulated.
fn refuse_unless_real(file: &PumpFile, driver: &DriverOption, given: &[(&str, bool)]) -> Result<(), Failure> {
    let given = given.iter().find(|(_, given)| *given);
    match given {
        Some((name, _)) if is_simulated(file, driver) => Err(Failure::refused(format!(
            "{name} means nothing to a simulated motor; to move a real one name its driver, as --driver grbl"
        ))),
        _ => Ok(()),
    }
}

fn is_simulated(file: &PumpFile, driver: &DriverOption) -> bool {
    driver.driver.unwrap_or(file.driver()) == DriverName::Sim
}
