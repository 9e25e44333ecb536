//! The configuration of a board: its objects, and the checksum by which it is known again.
//!
//! Source: Klipper3d/klipper, `docs/MCU_Commands.md`, "Common startup commands" and the sections after it.

use crc32fast::Hasher;

use super::board_motor::BoardMotor;
use super::commands::Commands;
use super::driver_line;
use super::objects::Objects;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::pump_file::{KlipperTable, PinPull};

/// Configuration of a board, as commands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Configuration {
    commands: Vec<Vec<u8>>,
    /// Objects of each motor.
    objects: Vec<Objects>,
}

impl Configuration {
    /// Makes the configuration of these motors.
    pub(in crate::drives::klipper) fn new(
        motors: &[BoardMotor],
        dictionary: &Dictionary,
        format: &Commands,
        hz: u32,
    ) -> Result<Self, KlipperError> {
        let count = (motors.len() as u8).saturating_mul(Objects::COUNT);
        let mut made =
            Self { commands: vec![format.allocate_oids.encode(&[count.into()])?], objects: Vec::new() };
        for (place, motor) in motors.iter().enumerate() {
            let shares_line = |other: &BoardMotor| {
                let lines = other.pins.tmc.as_ref().zip(motor.pins.tmc.as_ref());
                lines.is_some_and(|(other, own)| driver_line::is_shared(other, own))
            };
            let line = motors.iter().take(place).position(shares_line);
            let objects = Objects::of(place as u8, line.unwrap_or(place) as u8);
            made.add_motor(&motor.pins, objects, (dictionary, format), hz)?;
            if line.is_none() {
                let line = driver_line::command(motor.pins.tmc.as_ref(), objects, dictionary, hz)?;
                made.commands.extend(line);
            }
            made.objects.push(objects);
        }
        Ok(made)
    }

    /// Adds the objects of a motor at these pins, but its stepper driver's line.
    fn add_motor(
        &mut self,
        table: &KlipperTable,
        objects: Objects,
        (dictionary, format): (&Dictionary, &Commands),
        hz: u32,
    ) -> Result<(), KlipperError> {
        let pin = |name: &str| dictionary.pin(name);
        let pulse = (table.pulse_us() * f64::from(hz) * 1e-6).ceil() as u32;
        let (step, dir) = (pin(&table.step.name)?, pin(&table.dir.name)?);
        self.commands.push(format.config_stepper.encode(&[
            objects.stepper.into(),
            step.into(),
            dir.into(),
            table.step.inverted.into(),
            pulse.into(),
        ])?);
        self.commands.push(format.config_trsync.encode(&[objects.dead_man.into()])?);
        if let Some(enable) = &table.enable {
            // Without current until the drive gives it, and after a shutdown. No longest time: the motor holds on after
            // the computer has gone, so that its count stays that of the rotor.
            let off = enable.inverted.into();
            let values = [objects.enable.into(), pin(&enable.name)?.into(), off, off, 0_u32.into()];
            self.commands.push(format.config_digital_out.encode(&values)?);
        }
        if let Some(index) = &table.index {
            let pull = match index.pull {
                PinPull::None => 0_u8,
                PinPull::Up => 1,
                // -1 as the board's 8 bits.
                PinPull::Down => u8::MAX,
            };
            let values = [objects.index.into(), pin(&index.name)?.into(), pull.into()];
            self.commands.push(format.config_endstop.encode(&values)?);
            self.commands.push(format.config_trsync.encode(&[objects.index_group.into()])?);
        }
        Ok(())
    }

    /// Returns the objects of the motor at a place.
    pub(super) fn objects(&self, place: usize) -> Objects {
        self.objects.get(place).copied().unwrap_or(Objects::of(0, 0))
    }

    /// Returns the commands in their order.
    pub(in crate::drives::klipper) fn commands(&self) -> &[Vec<u8>] {
        &self.commands
    }

    /// Returns the checksum that the board keeps of this configuration. It is of the session too, so that a board which
    /// was reset and configured alike by another program is told from one that still counts.
    pub(in crate::drives::klipper) fn checksum(&self, session: u64) -> u32 {
        let mut hasher = Hasher::new();
        hasher.update(&session.to_le_bytes());
        self.commands.iter().for_each(|command| hasher.update(command));
        // A board that is not configured says 0.
        hasher.finalize().max(1)
    }
}
