//! The configuration of a board: its objects, and the checksum by which it is known again.
//!
//! Source: Klipper3d/klipper, `docs/MCU_Commands.md`, "Common startup commands" and the sections after it.

use crc32fast::Hasher;

use super::commands::Commands;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::pump_file::{KlipperTable, PinPull};

/// Objects of a board, by their numbers. They never change, so that any configuration of this drive can be brought to
/// rest.
pub(in crate::drives::klipper) mod oid {
    /// Stepper.
    pub(in crate::drives::klipper) const STEPPER: u8 = 0;
    /// Trigger group that stops the stepper when this computer falls silent.
    pub(in crate::drives::klipper) const DEAD_MAN: u8 = 1;
    /// Output that gives the motor current.
    pub(in crate::drives::klipper) const ENABLE: u8 = 2;
    /// Input of the index sensor.
    pub(in crate::drives::klipper) const INDEX: u8 = 3;
    /// Trigger group that tells of the index sensor, and stops nothing.
    pub(in crate::drives::klipper) const INDEX_GROUP: u8 = 4;
    /// Line to a stepper driver.
    pub(in crate::drives::klipper) const DRIVER_LINE: u8 = 5;
    /// Number of objects.
    pub(super) const COUNT: u8 = 6;
}

/// Configuration of a board, as commands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Configuration {
    commands: Vec<Vec<u8>>,
    /// True if forward is the low level of the direction pin. No command tells it, and the count hangs on it.
    is_reversed: bool,
}

impl Configuration {
    /// Makes the configuration of a motor at these pins. `inverts` swaps the directions once more.
    pub(in crate::drives::klipper) fn new(
        table: &KlipperTable,
        inverts: bool,
        dictionary: &Dictionary,
        format: &Commands,
        hz: u32,
    ) -> Result<Self, KlipperError> {
        let pin = |name: &str| dictionary.pin(name);
        let pulse = (table.pulse_us() * f64::from(hz) * 1e-6).ceil() as u32;
        let (step, dir) = (pin(&table.step.name)?, pin(&table.dir.name)?);
        let mut commands = vec![
            format.allocate_oids.encode(&[oid::COUNT.into()])?,
            format.config_stepper.encode(&[
                oid::STEPPER.into(),
                step.into(),
                dir.into(),
                table.step.inverted.into(),
                pulse.into(),
            ])?,
            format.config_trsync.encode(&[oid::DEAD_MAN.into()])?,
        ];
        if let Some(enable) = &table.enable {
            // Without current until the drive gives it, and after a shutdown. No longest time: the motor holds on after
            // the computer has gone, so that its count stays that of the rotor.
            let off = enable.inverted.into();
            let values = [oid::ENABLE.into(), pin(&enable.name)?.into(), off, off, 0_u32.into()];
            commands.push(format.config_digital_out.encode(&values)?);
        }
        if let Some(index) = &table.index {
            let pull = match index.pull {
                PinPull::None => 0_u8,
                PinPull::Up => 1,
                // -1 as the board's 8 bits.
                PinPull::Down => u8::MAX,
            };
            let values = [oid::INDEX.into(), pin(&index.name)?.into(), pull.into()];
            commands.push(format.config_endstop.encode(&values)?);
            commands.push(format.config_trsync.encode(&[oid::INDEX_GROUP.into()])?);
        }
        Ok(Self { commands, is_reversed: table.dir.inverted != inverts })
    }

    /// Adds the command of a further object.
    pub(in crate::drives::klipper) fn push(&mut self, command: Vec<u8>) {
        self.commands.push(command);
    }

    /// Returns the commands in their order.
    pub(in crate::drives::klipper) fn commands(&self) -> &[Vec<u8>] {
        &self.commands
    }

    /// Returns true if forward is the low level of the direction pin.
    pub(in crate::drives::klipper) fn is_reversed(&self) -> bool {
        self.is_reversed
    }

    /// Returns the checksum that the board keeps of this configuration. It is of the session too, so that a board which
    /// was reset and configured alike by another program is told from one that still counts.
    pub(in crate::drives::klipper) fn checksum(&self, session: u64) -> u32 {
        let mut hasher = Hasher::new();
        hasher.update(&session.to_le_bytes());
        hasher.update(&[self.is_reversed.into()]);
        self.commands.iter().for_each(|command| hasher.update(command));
        // A board that is not configured says 0.
        hasher.finalize().max(1)
    }
}
