//! The guard: inputs that must be alive, as a leak sensor. One that is not well, or silent for too long, stops its
//! pumps and puts them to stand. Only a person lets them go on, by a clearing that is on record.

mod error;
mod guard;
mod input;
mod said;
mod stand;

pub use self::error::GuardError;
pub use self::guard::Guard;
pub use self::input::InputView;
pub(crate) use self::said::Said;
