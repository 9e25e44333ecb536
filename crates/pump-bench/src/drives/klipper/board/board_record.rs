//! The record of a board, which its pumps share: the motors that it is configured with.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::board_motor::BoardMotor;
use super::session_record::{SessionRecord, check_schema, hexadecimal, read_json, write_json};
use crate::drives::Opening;
use crate::drives::klipper::error::KlipperError;
use crate::pump_file::KlipperTable;

/// Form of the record.
const SCHEMA: &str = "klipper-board/1";

/// Most sessions before the last one that are kept.
const ENDED_MOST: usize = 15;

/// Record as a file holds it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    session: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    before: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    by: Option<String>,
    cuts: u32,
    motors: Vec<BoardMotor>,
}

/// Record of a board.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct BoardRecord {
    /// Number of the session, which is drawn whenever the board is configured.
    pub(super) session: u64,
    /// Sessions before that this bench ended by a reset, each to configure the board for the next one. There is none
    /// before one that the board has lost.
    pub(super) before: Vec<u64>,
    /// Pump for which the board was configured.
    pub(super) by: Option<String>,
    /// Shutdowns of the session that this bench has ended. Each has taken the current of every motor.
    pub(super) cuts: u32,
    /// Motors of the configuration.
    pub(super) motors: Vec<BoardMotor>,
}

impl BoardRecord {
    /// Returns the place of the record of the board at `port`. `None` where pumps share no records.
    pub(super) fn path(opening: &Opening, port: &Path) -> Option<PathBuf> {
        let device = port.canonicalize().unwrap_or_else(|_| port.to_owned());
        let device = device.to_string_lossy();
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
        let name = format!("klipper-{}.json", device.chars().map(plain).collect::<String>());
        opening.boards.as_ref().map(|folder| folder.join(name))
    }

    /// Returns the record at `path`. There is none before a board was first met.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, KlipperError> {
        let Some(recorded) = read_json::<Recorded>(path)? else { return Ok(None) };
        check_schema(path, &recorded.schema, SCHEMA)?;
        let Recorded { session, before, by, cuts, motors, .. } = recorded;
        let before: Result<_, _> = before.iter().map(|before| hexadecimal(path, before)).collect();
        Ok(Some(Self { session: hexadecimal(path, &session)?, before: before?, by, cuts, motors }))
    }

    /// Writes the record to `path`. The disk has it afterwards.
    pub(super) fn write(&self, path: &Path) -> Result<(), KlipperError> {
        let Self { session, before, by, cuts, motors } = self.clone();
        let session = format!("{session:016x}");
        let before = before.iter().map(|before| format!("{before:016x}")).collect();
        write_json(path, &Recorded { schema: SCHEMA.to_owned(), session, before, by, cuts, motors })
    }

    /// Returns the sessions that this bench has ended with this one, to configure the board for the next.
    pub(super) fn ended(&self) -> Vec<u64> {
        let before = self.before.iter().rev().take(ENDED_MOST).rev();
        before.copied().chain([self.session]).collect()
    }

    /// Notes on the record at `path` that the motor of this pump was met at these pins. They may differ from those that
    /// the board was configured with in what it is not told, as an address.
    pub(super) fn note_met(
        path: Option<&Path>,
        pump: Option<&str>,
        pins: &KlipperTable,
    ) -> Result<(), KlipperError> {
        let (Some(path), Some(pump)) = (path, pump) else { return Ok(()) };
        let Some(mut record) = Self::read(path)? else { return Ok(()) };
        let mut motors = record.motors.iter_mut();
        let Some(motor) = motors.find(|motor| motor.pump.as_deref() == Some(pump)) else { return Ok(()) };
        if motor.met && motor.pins == *pins {
            return Ok(());
        }
        (motor.met, motor.pins) = (true, pins.clone());
        record.write(path)
    }

    /// Notes on the record at `path` that the board has lost its session, which each of its pumps hears then.
    pub(super) fn note_reset(path: Option<&Path>) -> Result<(), KlipperError> {
        let Some(path) = path else { return Ok(()) };
        let Some(record) = Self::read(path)? else { return Ok(()) };
        Self { session: SessionRecord::draw(), before: Vec::new(), by: None, ..record }.write(path)
    }

    /// Notes one more shutdown on the record at `path`, before it is ended. Returns the number of all.
    pub(super) fn note_cut(path: Option<&Path>, known: u32) -> Result<u32, KlipperError> {
        let Some(path) = path else { return Ok(known + 1) };
        let Some(record) = Self::read(path)? else { return Ok(known + 1) };
        let record = Self { cuts: record.cuts + 1, ..record };
        record.write(path)?;
        Ok(record.cuts)
    }
}
