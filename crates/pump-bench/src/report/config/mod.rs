//! The configuration in words and as JSON.

mod shown;

pub use shown::{ShownConfig, ShownPump, ShownRack};
