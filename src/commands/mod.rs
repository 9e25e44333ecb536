//! The commands, a file each; a command with subcommands is a folder.

pub(crate) mod accept;
mod batch;
mod by_weight;
pub(crate) mod calibrate;
pub(crate) mod completions;
pub(crate) mod config;
mod delivery;
pub(crate) mod dose;
pub(crate) mod home;
pub(crate) mod identify;
#[cfg(feature = "man")]
pub(crate) mod man_pages;
pub(crate) mod prime;
pub(crate) mod pumps;
pub(crate) mod purge;
pub(crate) mod record;
pub(crate) mod release;
pub(crate) mod resume;
pub(crate) mod run;
pub(crate) mod safety;
pub(crate) mod serve;
pub(crate) mod setup;
pub(crate) mod simulate;
pub(crate) mod size;
pub(crate) mod tube;
