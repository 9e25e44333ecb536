//! A board in software at the end of a line, on one clock.

mod hardware;
mod misread;
mod shared_world;
mod world;

pub(crate) use hardware::{Hardware, TICK_HZ};
pub(crate) use shared_world::SharedWorld;
pub(crate) use world::Event;
