//! The times of a rack: the begin of each step, and the appointments of each pump.

mod appointments;
mod board_room;
mod line_speeds;
mod lines;
mod timetable;

pub(super) use appointments::{Appointment, appointments};
pub(super) use board_room::check_boards;
pub(super) use line_speeds::LineSpeeds;
pub(super) use timetable::{GIVEN_S, Timetable, Timing};
