//! The ramps of a dose: those after which the outlet's line is nearly at rest.

mod cruise;
mod grid;
mod left_over;
mod lines;
mod plain;
mod ring_down;
mod search;

pub(in crate::plan) use grid::Grid;
pub(in crate::plan) use plain::best_plain;
pub(in crate::plan) use search::{in_time, is_no_fault, line_aware, taken_back_ml};
