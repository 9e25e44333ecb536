//! The times of a rack: the begin of each step, and the appointments of each pump.

mod appointments;
mod line_speeds;
mod lines;
mod timetable;

pub(super) use appointments::{Appointment, appointments};
pub(super) use line_speeds::LineSpeeds;
pub(super) use timetable::{Timetable, Timing};
