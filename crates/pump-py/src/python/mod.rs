//! Python as every room needs it: exceptions, warnings, interrupts, memory and arrays.

pub(crate) mod advice;
mod array;
pub(crate) mod errors;
pub(crate) mod first;
mod interrupt;
mod memory;
pub(crate) mod plain;
pub(crate) mod readable;
mod renamed;
pub(crate) mod spare;
pub(crate) mod warnings;

pub(crate) use array::{frozen, frozen_rows};
pub(crate) use interrupt::SignalCheck;
pub(crate) use memory::{append, collected, no_memory, reserve, try_collected};
pub(crate) use renamed::renamed;
