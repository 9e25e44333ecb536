//! A claim that must hold.

use std::error::Error;

/// Fails if a claim does not hold.
pub(crate) fn check(holds: bool, what: &str) -> Result<(), Box<dyn Error>> {
    if holds { Ok(()) } else { Err(format!("{what} does not hold").into()) }
}
