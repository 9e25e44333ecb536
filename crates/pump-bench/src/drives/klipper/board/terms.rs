//! The terms on which a board is met.

use std::path::PathBuf;
use std::time::Duration;

use super::session_record::SessionRecord;
use crate::drives::Opening;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::tmc::{Chopper, TmcError, TmcSettings};
use crate::drives::known_board::KnownBoard;
use crate::pump_file::{DriveTable, KlipperTable, MotorTable, TmcTable, tmc_range};

/// Terms on which a board is met.
#[derive(Debug, Clone)]
pub(in crate::drives::klipper) struct Terms {
    pub(in crate::drives::klipper) port: PathBuf,
    pub(in crate::drives::klipper) baud: u32,
    pub(in crate::drives::klipper) pins: KlipperTable,
    pub(in crate::drives::klipper) inverts: bool,
    /// Terms on which the device is opened.
    pub(in crate::drives::klipper) opening: Opening,
    /// Marks of the board that its port tells.
    pub(in crate::drives::klipper) at_port: KnownBoard,
    /// Time without a word of this program after which the board stops the motor.
    pub(in crate::drives::klipper) dead_man: Duration,
    /// File that holds the board's session.
    pub(in crate::drives::klipper) record: Option<PathBuf>,
    /// Session of this process, where there is no such file.
    pub(in crate::drives::klipper) last: Option<SessionRecord>,
    /// Address and settings of the stepper driver, if they are set over its line.
    pub(in crate::drives::klipper) driver: Option<(u8, TmcSettings)>,
}

impl Terms {
    /// Returns the terms of a drive table, or refuses one without pins.
    pub(in crate::drives::klipper) fn new(
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Self, KlipperError> {
        let pins = table.klipper.clone().ok_or(KlipperError::NoPins)?;
        let driver = pins.tmc.as_ref().map(|tmc| driver(tmc, motor)).transpose()?;
        Ok(Self {
            port: table.port.clone().unwrap_or_default(),
            baud: table.rate_baud(),
            pins,
            inverts: table.invert,
            opening: opening.clone(),
            at_port: KnownBoard::at_port(table.port.as_deref(), opening),
            dead_man: Duration::from_millis(table.dead_man_or_usual_ms().into()),
            record: opening.settings_record.clone(),
            last: None,
            driver,
        })
    }
}

/// Returns the address and the settings of a stepper driver. The microsteps are those of the pump file's motor.
fn driver(table: &TmcTable, motor: &MotorTable) -> Result<(u8, TmcSettings), TmcError> {
    let microsteps = tmc_range::microsteps(motor.steps_per_rev, motor.full_steps_per_rev)?;
    let currents = (table.run_a, table.hold_a());
    let settings =
        TmcSettings::new(table.address, currents, table.sense_ohm, microsteps, Chopper::default())?;
    Ok((table.address, settings))
}
