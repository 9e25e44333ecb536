//! `dose serve` as programs, people and commands use it: over HTTP, by its schedule, and killed at random instants.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod asked;
mod guard;
mod hostile;
mod kills;
mod laboratory;
mod orders;
mod schedule;
