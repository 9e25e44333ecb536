//! A moment as people write it: a time ago, a date, or a time with its offset.

use jiff::civil::{Date, DateTime};
use thiserror::Error;

use super::Stamp;

/// Units of a time ago, with their seconds.
const UNITS: [(&str, f64); 5] = [("s", 1.0), ("min", 60.0), ("h", 3600.0), ("d", 86_400.0), ("w", 604_800.0)];

/// Text that names no moment.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "`{text}` is no moment; write a time ago as 90min, 12h, 2d or 1w, a date as 2026-11-23, a local time as \
         2026-11-23 08:00, or a time with its offset as 2026-11-23T08:00:00+01:00"
)]
#[non_exhaustive]
pub struct MomentError {
    /// Text that was read.
    pub text: String,
}

/// Reads a moment, in seconds since 1970. A time ago counts back from `now`. A date begins at midnight of `now`'s
/// offset, and a time without an offset has it too.
///
/// # Errors
///
/// [`MomentError`] if the text names no moment.
pub fn moment(text: &str, now: Stamp) -> Result<u64, MomentError> {
    let refused = || MomentError { text: text.to_owned() };
    let text = text.trim();
    if let Ok(stamp) = text.parse::<Stamp>() {
        return Ok(stamp.unix_s);
    }
    if let Ok(date) = text.parse::<Date>()
        && text.len() == "2026-11-23".len()
    {
        let midnight = now.offset().to_timestamp(date.at(0, 0, 0, 0)).map_err(|_| refused())?;
        return u64::try_from(midnight.as_second()).map_err(|_| refused());
    }
    if let Ok(local) = text.parse::<DateTime>()
        && text.contains(':')
        // A zone in brackets would be read over.
        && !text.contains('[')
    {
        let time = now.offset().to_timestamp(local).map_err(|_| refused())?;
        return u64::try_from(time.as_second()).map_err(|_| refused());
    }
    let unit = text.trim_start_matches(|letter: char| letter.is_ascii_digit() || letter == '.');
    let (number, unit) = (&text[..text.len() - unit.len()], unit.trim());
    let (_, seconds) = UNITS.into_iter().find(|(name, _)| *name == unit).ok_or_else(refused)?;
    let ago_s = number.parse::<f64>().map_err(|_| refused())? * seconds;
    // A longer time than since 1970 leaves nothing out.
    Ok(now.unix_s.saturating_sub(ago_s as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_calendar_and_others_are_refused() {
        let now = Stamp::new(1_795_400_100, 3600);
        for (text, unix_s) in [
            ("0s", 1_795_400_100),
            ("90min", 1_795_394_700),
            ("1.5h", 1_795_394_700),
            ("2 d", 1_795_227_300),
            ("1w", 1_794_795_300),
            ("99999w", 0),
            // Midnight in a zone one hour before UTC: date -d 2026-11-22T23:00Z +%s, by GNU date.
            ("2026-11-23", 1_795_388_400),
            ("2026-11-23T02:15:00Z", 1_795_400_100),
            ("2026-11-23 03:15", 1_795_400_100),
            ("2026-11-23T03:15:00", 1_795_400_100),
        ] {
            assert_eq!(moment(text, now), Ok(unix_s), "{text}");
        }
        for text in [
            "",
            "2",
            "d",
            "-2d",
            "2 days",
            "NaNd",
            "infd",
            "1e3d",
            "yesterday",
            "2026-13-01",
            "2026-11-23 25:15",
        ] {
            assert!(moment(text, now).is_err(), "{text}");
        }
    }
}
