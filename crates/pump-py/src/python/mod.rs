//! Python as every room needs it: exceptions, interrupts and arrays.

mod array;
pub(crate) mod errors;
mod interrupt;

pub(crate) use array::{frozen, reserve};
pub(crate) use interrupt::Interrupt;
