//! Python as every room needs it: exceptions, warnings, interrupts and arrays.

pub(crate) mod advice;
mod array;
pub(crate) mod errors;
mod interrupt;
pub(crate) mod plain;
mod readable;
mod renamed;
pub(crate) mod warnings;

pub(crate) use array::{frozen, reserve};
pub(crate) use interrupt::SignalCheck;
pub(crate) use renamed::renamed;
