//! `dose serve` as programs, people and commands use it: over HTTP and MQTT, by its schedule, and killed at random
//! instants.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod asked;
mod broker;
mod edits;
mod guard;
mod hostile;
mod kills;
mod laboratory;
mod mqtt;
mod openapi;
mod orders;
mod proxy;
mod racks;
mod schedule;
mod url;
