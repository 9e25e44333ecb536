//! The rest of a balance that does not say whether it stands still: its readings agree.

use std::thread::sleep;
use std::time::{Duration, Instant};

use super::{BalanceError, BalanceReading};
use crate::drives::StopRequest;

/// Readings in a row that agree once a balance stands still.
const AGREE: usize = 3;

/// Time between two of them. A balance that settles with a time constant of 0.5 s is then off by less than a digit.
const BETWEEN: Duration = Duration::from_millis(300);

/// Takes readings until three in a row agree to a digit, over 0.6 s at least, and returns the last. A balance whose
/// answers do not tell whether it stands still has no other sign of it.
///
/// # Errors
///
/// [`BalanceError::NotStill`] if they do not agree within `longest`, [`BalanceError::Stopped`] if `stop` is made, and
/// the errors of `read`.
pub fn agreeing(
    longest: Duration,
    stop: &StopRequest,
    mut read: impl FnMut() -> Result<BalanceReading, BalanceError>,
) -> Result<BalanceReading, BalanceError> {
    let began = Instant::now();
    let mut row: Vec<BalanceReading> = Vec::with_capacity(AGREE);
    loop {
        if stop.is_made() {
            return Err(BalanceError::Stopped);
        }
        let reading = read()?;
        let agree = |other: &BalanceReading| {
            (other.mass_g - reading.mass_g).abs() < 1.5 * reading.step_g.max(other.step_g)
        };
        if !row.iter().all(agree) {
            if began.elapsed() >= longest {
                return Err(BalanceError::NotStill { within: longest, last: reading.shown() });
            }
            row.clear();
        }
        row.push(reading);
        if row.len() == AGREE {
            return Ok(reading);
        }
        sleep(BETWEEN);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(shown_g: &[f64], longest: Duration) -> Result<f64, BalanceError> {
        let mut next = shown_g.iter().copied();
        let last_g = shown_g.last().copied().unwrap_or_default();
        let read = || Ok(BalanceReading { mass_g: next.next().unwrap_or(last_g), step_g: 0.01 });
        agreeing(longest, &StopRequest::default(), read).map(|reading| reading.mass_g)
    }

    #[test]
    fn a_balance_that_still_settles_gives_no_reading() {
        let shown_g = [8.0, 9.31, 9.86, 9.95, 9.98, 10.0, 10.0];
        assert_eq!(found(&shown_g, Duration::from_secs(60)).unwrap(), 10.0);
        // The last digit may flicker.
        assert_eq!(found(&[10.0, 10.01, 10.0], Duration::ZERO).unwrap(), 10.0);
    }

    #[test]
    fn a_balance_that_never_settles_is_told_with_its_last_words() {
        let error = found(&[1.0, 2.0], Duration::ZERO).unwrap_err().to_string();
        assert!(error.contains("did not stand still") && error.contains("`2.00 g`"), "{error}");
    }

    #[test]
    fn a_stop_ends_the_wait() {
        let read = || Ok(BalanceReading { mass_g: 1.0, step_g: 0.01 });
        let stopped = agreeing(Duration::from_secs(60), &StopRequest::new(|| true), read);
        assert!(matches!(stopped, Err(BalanceError::Stopped)));
    }
}
