//! Dates in text.

use std::time::{SystemTime, UNIX_EPOCH};

/// Returns the present date and time by the system's clock, UTC, as `2026-11-21T13:50:00Z`.
pub fn now() -> String {
    let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
    of_unix(unix_s)
}

/// Returns the Gregorian date of a time since 1970. Days count from 1 March of the year 0, so that leap days
/// come last in a year.
pub(super) fn of_unix(unix_s: u64) -> String {
    const DAYS_OF_400_YEARS: u64 = 146_097;
    /// Days from 1 March of the year 0 to 1970.
    const DAYS_BEFORE: u64 = 719_468;
    let (days, second) = (unix_s / 86_400 + DAYS_BEFORE, unix_s % 86_400);
    let day = days % DAYS_OF_400_YEARS;
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    // Months from March on have 31, 30, 31, 30, 31 days, over and over: 153 in five.
    let month = (5 * day + 2) / 153;
    let (day, month) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let year = year + 400 * (days / DAYS_OF_400_YEARS) + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (unix_s, date) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_704_067_199, "2023-12-31T23:59:59Z"),
            (1_709_210_096, "2024-02-29T12:34:56Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(of_unix(unix_s), date);
        }
    }
}
