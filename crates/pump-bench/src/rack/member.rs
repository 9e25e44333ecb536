//! A pump of a rack.

use crate::bench::Bench;

/// Pump of a rack with its bench.
#[derive(Debug, Clone)]
pub struct Member {
    /// Name of the pump in the rack.
    pub name: String,
    /// Bench of the pump.
    pub bench: Bench,
}
