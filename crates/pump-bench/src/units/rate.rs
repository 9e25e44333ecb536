//! The rate of a dose: a flow, or the fastest one.

use pump_ctl::plan::Cruise;

use super::error::QuantityError;
use super::quantity::flow_ml_s;

/// Reads a rate: a positive flow, or `max` for the fastest flow that keeps every limit.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is neither `max` nor a positive flow.
pub fn rate(text: &str) -> Result<Cruise, QuantityError> {
    if text.trim() == "max" { Ok(Cruise::Fastest) } else { Ok(Cruise::Flow { ml_s: flow_ml_s(text)? }) }
}
