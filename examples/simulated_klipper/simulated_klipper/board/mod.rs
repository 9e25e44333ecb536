//! The board's logic: commands in, responses out, and events at their ticks between.

mod board;
mod commands;
mod configured;
mod events;
mod part;
#[cfg(test)]
mod tests;

pub(super) use board::Board;
