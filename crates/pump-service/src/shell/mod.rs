//! Commands of the user for the system's shell: those of inputs, and the one that tells a person of a failure.

pub(crate) mod command;
mod on_fail;

pub(crate) use self::on_fail::{Failed, on_fail};
