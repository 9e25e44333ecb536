//! The options of commands that read a balance.

mod by_weight;
mod device;

pub(crate) use by_weight::ByWeightOptions;
pub(crate) use device::{BalanceOptions, read_still};
