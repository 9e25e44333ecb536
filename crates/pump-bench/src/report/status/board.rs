//! The board that the record of a pump names.

use serde::Serialize;

use crate::bench::Bench;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
use crate::drives::{BoardOnRecord, port_name};
use crate::pump_file::Axis;

/// The board that the record of a pump names. Another one at its port is refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct BoardStatus {
    /// Number of the board, hexadecimal; null if it tells none.
    pub number: Option<String>,
    /// Name that its port keeps; null if it keeps none.
    pub port_name: Option<String>,
    /// Axis that turns the pump; null for a board without axes.
    pub axis: Option<Axis>,
    /// The place that the pump file names, if it is another one.
    #[serde(skip)]
    pub moved_to: Option<String>,
}

impl BoardStatus {
    /// Returns nothing: a program without boards has none on record.
    #[cfg(not(any(feature = "grbl", feature = "node", feature = "klipper")))]
    pub(super) fn of(_bench: &Bench) -> Option<Self> {
        None
    }

    /// Reads the board on record, if it can be told from others.
    #[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
    pub(super) fn of(bench: &Bench) -> Option<Self> {
        let BoardOnRecord { number, port_name: recorded, axis } = BoardOnRecord::of(bench.opening())?;
        if number.is_none() && recorded.is_none() {
            return None;
        }
        let drive = bench.drive();
        let port = drive.port.as_deref().zip(bench.opening().port_names.as_deref());
        let named = port.and_then(|(port, folder)| port_name(port, folder));
        let of_port = named.filter(|named| recorded.as_ref().is_some_and(|recorded| recorded != named));
        let of_axis = axis.filter(|axis| *axis != drive.axis).map(|_| format!("axis {}", drive.axis));
        let moved_to = match (of_port, of_axis) {
            (Some(port), Some(axis)) => Some(format!("{axis} at {port}")),
            (port, axis) => port.or(axis),
        };
        let number = number.map(|number| format!("{number:016x}"));
        Some(Self { number, port_name: recorded, axis, moved_to })
    }

    /// The board in words.
    pub(in crate::report) fn text(&self) -> String {
        let name = match (&self.number, &self.port_name) {
            (Some(number), Some(port)) => format!("{number} ({port})"),
            (Some(name), None) | (None, Some(name)) => name.clone(),
            (None, None) => String::new(),
        };
        let axis = self.axis.map_or_else(String::new, |axis| format!(", axis {axis}"));
        let moved =
            self.moved_to.as_ref().map_or_else(String::new, |to| format!("; its pump file names {to} now"));
        format!("board on record: {name}{axis}{moved}")
    }
}
