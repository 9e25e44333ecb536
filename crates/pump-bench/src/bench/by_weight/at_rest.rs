//! A balance that is read at rest.

use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::balance::{Balance, BalanceError, BalanceReading};
use crate::drives::StopRequest;

/// Time between two readings that must agree, for a balance at rest.
const AGREES_AFTER: Duration = Duration::from_millis(300);

/// Reads a balance at rest: two readings that stand still and agree to a digit. A balance may call a slow trickle
/// still.
pub(super) fn at_rest(
    balance: &mut dyn Balance,
    longest: Duration,
    stop: &StopRequest,
    simulated: bool,
) -> Result<BalanceReading, BalanceError> {
    let until = Instant::now() + longest;
    let mut before = balance.read_still(longest, stop)?;
    loop {
        if !simulated {
            sleep(AGREES_AFTER);
        }
        let left = until.saturating_duration_since(Instant::now());
        let reading = balance.read_still(left.max(AGREES_AFTER), stop)?;
        if (reading.mass_g - before.mass_g).abs() < 1.5 * reading.step_g {
            return Ok(reading);
        }
        if left.is_zero() {
            let last = format!("{} g", reading.mass_g);
            return Err(BalanceError::NotStill { within: longest, last });
        }
        before = reading;
    }
}
