//! Whole numbers of things, as rollers, steps and doses.

use std::ops::RangeInclusive;

use super::QuantityError;

/// Rollers that a pump may have.
pub const ROLLERS: RangeInclusive<u32> = 1..=1000;

/// Steps per revolution that a motor may have, microsteps included.
pub const STEPS_PER_REV: RangeInclusive<u32> = 4..=100_000_000;

/// Full steps per revolution that a motor may have.
pub const FULL_STEPS_PER_REV: RangeInclusive<u32> = 4..=100_000;

/// Microsteps that a full step may have.
pub const MICROSTEPS: RangeInclusive<u32> = 1..=100_000;

/// Returns the reader of a whole number of things within a range. `name` is that of the number, as `number of rollers`.
///
/// ```
/// use pump_bench::units::{ROLLERS, count};
///
/// let rollers = count("number of rollers", ROLLERS);
/// assert_eq!(rollers("4")?, 4);
/// let refused = rollers("2.5").unwrap_err().to_string();
/// assert_eq!(refused, "number of rollers is 2.5; allowed: whole numbers from 1 to 1000");
/// # Ok::<(), pump_bench::units::QuantityError>(())
/// ```
///
/// # Errors
///
/// The reader returns [`QuantityError::Count`] for anything else.
pub fn count(
    name: &'static str,
    range: RangeInclusive<u32>,
) -> impl Fn(&str) -> Result<u32, QuantityError> + Clone + Send + Sync + 'static {
    move |text| {
        let (least, most) = (*range.start(), *range.end());
        let number = text.trim().parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| QuantityError::Count { name, text: text.to_owned(), least, most })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_is_whole_and_within_its_range() {
        let read = count("number of runs", 2..=1000);
        assert_eq!(read(" 1000 "), Ok(1000));
        for text in ["2.5", "1", "1001", "", "ten", "-3", "1e2", "99999999999999999999"] {
            let refused = read(text).unwrap_err().to_string();
            let said = format!("number of runs is {text}; allowed: whole numbers from 2 to 1000");
            assert_eq!(refused, said);
        }
    }
}
