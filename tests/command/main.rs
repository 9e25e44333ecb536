//! The command as a user types it: exit codes, messages, files, and that nothing moves when it refuses.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod balance;
mod bought_head;
mod calibrate;
mod calibrate_last;
mod calibration_limits;
mod configuration;
mod dose;
#[cfg(unix)]
mod home;
mod hostile;
mod identify;
mod line;
mod pins;
mod pumps;
mod racks;
mod record;
mod records;
mod simulate;
mod size;
mod tube;
mod unattended;
mod user;
