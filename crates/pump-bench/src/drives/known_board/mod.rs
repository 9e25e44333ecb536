//! The boards on record, and the pumps that their axes turn.

mod axis_record;
mod known_board;

pub(super) use axis_record::RecordedPump;
pub(super) use known_board::{BoardError, KnownBoard, MadePlace, pump_in_words};
