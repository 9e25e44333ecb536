//! The boards on record, and the pumps that their axes turn.

mod axis_record;
mod known_board;
mod on_record;

#[cfg(any(all(feature = "grbl", feature = "node"), feature = "klipper"))]
pub(super) use axis_record::RecordedPump;
#[cfg(any(feature = "node", feature = "klipper"))]
pub(super) use known_board::MadePlace;
pub use known_board::PlaceTaken;
pub(super) use known_board::{BoardError, KnownBoard, pump_in_words};
pub use on_record::BoardOnRecord;
