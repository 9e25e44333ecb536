//! Arguments from Python: numbers and arrays, speeds, quantities as text, and words of a fixed set.

mod choice;
mod cruise;
mod flag;
mod floats;
mod items;
mod number;
mod object;
mod port;
mod quantity;
pub(crate) mod speed;
mod whole;

pub(crate) use choice::{choice, finish_named, ramps_named, told, word};
pub(crate) use cruise::cruise;
pub(crate) use flag::flag;
pub(crate) use floats::{_numbers, Floats};
pub(crate) use items::Items;
pub(crate) use number::{_number, number, number_of, optional};
pub(crate) use object::{object, told_of};
pub(crate) use port::{PORTS, port_named};
pub(crate) use quantity::{quantity, retracted_ml, text};
pub(crate) use speed::Argument;
pub(crate) use whole::whole;
