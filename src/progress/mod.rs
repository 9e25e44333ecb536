//! The progress of a motion: a bar for a person, and lines for a program that supervises the command.

mod bar;
pub(crate) mod supervised;

pub(crate) use self::bar::{MotionBar, until_next};
