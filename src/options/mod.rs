//! The groups of options that commands are made of, a file each.

pub(crate) mod balance;
pub(crate) mod batch;
pub(crate) mod bench;
pub(crate) mod choice;
pub(crate) mod dosing;
pub(crate) mod files;
pub(crate) mod finish;
pub(crate) mod fluid;
pub(crate) mod limits;
pub(crate) mod motor;
pub(crate) mod pump;
pub(crate) mod report;
pub(crate) mod speed;
pub(crate) mod start_angle;
pub(crate) mod unattended;
pub(crate) mod volume;
