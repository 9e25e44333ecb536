//! The settings on record: what a board told the last time about the way of its motor.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::error::GrblError;
use super::Settings;
use crate::drives::{DriveError, DriveLimits, Opening};
use crate::files::{read_plain, replace_plain};
use crate::pump_file::DriveTable;

/// Form of the record.
const SCHEMA: &str = "board-settings/1";

/// Settings of a board as a file holds them.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    /// Values of the settings by their numbers.
    settings: BTreeMap<u16, f64>,
}

/// Compares the settings of a board with those on record at `path`, and records them where there are none if `records`
/// is true.
///
/// Changed settings are refused, unless `accepted`. Returns the numbers of the settings whose changes were accepted,
/// each with its note.
pub(super) fn compare(
    found: &Settings,
    path: &Path,
    accepted: bool,
    records: bool,
) -> Result<Vec<(u16, String)>, GrblError> {
    let before = match recorded(path) {
        Err(_) if accepted => BTreeMap::new(),
        before => before?,
    };
    let mut now = before.clone();
    let mut changes = Vec::new();
    for number in found.numbers() {
        let (old, new) = (before.get(&number).copied(), found.values.get(&number).copied());
        match new {
            Some(value) => now.insert(number, value),
            None => now.remove(&number),
        };
        if let Some(old) = old.filter(|old| !found.same(number, Some(*old), new)) {
            let new = new.map_or_else(|| "is not listed now".to_owned(), |new| format!("is {new} now"));
            changes.push((number, format!("${number} was {old} and {new}")));
        }
    }
    if !changes.is_empty() && !accepted {
        let changes: Vec<String> = changes.into_iter().map(|(_, change)| change).collect();
        return Err(GrblError::SettingsChanged { changes: changes.join(", "), record: path.to_owned() });
    }
    if now != before && records {
        write(path, now)?;
    }
    Ok(changes.into_iter().map(|(number, change)| (number, format!("{change}: accepted"))).collect())
}

/// Returns the limits of the axis of `table` by the settings on record. `step_rad` is a step of the motor, in rad of
/// the pump head. `None` if they are not on record.
///
/// # Errors
///
/// [`DriveError::Device`] if the record cannot be read.
pub(in crate::drives) fn recorded_limits(
    table: &DriveTable,
    opening: &Opening,
    step_rad: f64,
) -> Result<Option<DriveLimits>, DriveError> {
    let Some(path) = &opening.settings_record else { return Ok(None) };
    let settings = recorded(path)?;
    let of_axis = |first: u16| {
        let value = settings.get(&(first + table.axis.number() as u16)).copied();
        value.filter(|value| *value > 0.0)
    };
    let limits = of_axis(100).zip(of_axis(110)).map(|(steps_per_unit, units_min)| {
        let unit_rad = steps_per_unit * step_rad;
        let acceleration_rad_s2 = of_axis(120).map(|units_s2| units_s2 * unit_rad);
        DriveLimits { acceleration_rad_s2, ..DriveLimits::of_speed(units_min / 60.0 * unit_rad) }
    });
    Ok(limits)
}

/// Returns the settings on record. There are none before the board was first met.
fn recorded(path: &Path) -> Result<BTreeMap<u16, f64>, GrblError> {
    let unread = |reason| GrblError::SettingsRecord { action: "read", record: path.to_owned(), reason };
    let bytes = match read_plain(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeMap::new()),
        read => read.map_err(|error| unread(error.to_string()))?,
    };
    let recorded: Recorded = serde_json::from_slice(&bytes).map_err(|error| unread(error.to_string()))?;
    if recorded.schema != SCHEMA {
        return Err(unread(format!("its schema is {:?}; allowed: {SCHEMA:?}", recorded.schema)));
    }
    Ok(recorded.settings)
}

fn write(path: &Path, settings: BTreeMap<u16, f64>) -> Result<(), GrblError> {
    let recorded = Recorded { schema: SCHEMA.to_owned(), settings };
    replace_plain(path, |to| {
        serde_json::to_writer(&mut *to, &recorded)?;
        to.write_all(b"\n")
    })
    .map_err(|error| GrblError::SettingsRecord {
        action: "written",
        record: path.to_owned(),
        reason: error.to_string(),
    })
}
