//! A time with the offset of the local clock.

use std::fmt;
use std::str::FromStr;

use jiff::Timestamp;
use jiff::fmt::temporal::Pieces;
use jiff::tz::Offset;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// Time with the offset of the local clock from UTC. Its text is that of RFC 3339: `2026-11-23T02:15:00+01:00`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Stamp {
    /// Seconds since 1970, UTC.
    pub unix_s: u64,
    /// Local time less UTC, in s.
    pub utc_offset_s: i32,
}

impl Stamp {
    /// Names a time by its seconds since 1970 and the offset of the local clock from UTC, in s.
    pub fn new(unix_s: u64, utc_offset_s: i32) -> Self {
        Self { unix_s, utc_offset_s }
    }

    /// Returns the date of the local clock: `2026-11-23`.
    pub fn date(&self) -> String {
        self.to_string().split('T').next().unwrap_or_default().to_owned()
    }

    /// Returns the offset, or UTC where the offset is none that a clock has.
    pub(super) fn offset(&self) -> Offset {
        Offset::from_seconds(self.utc_offset_s).unwrap_or(Offset::UTC)
    }
}

impl fmt::Display for Stamp {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = i64::try_from(self.unix_s).unwrap_or(i64::MAX);
        let time = Timestamp::from_second(seconds).unwrap_or(Timestamp::MAX);
        to.pad(&format!("{:.0}", time.display_with_offset(self.offset())))
    }
}

impl FromStr for Stamp {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pieces = Pieces::parse(text).map_err(|error| error.to_string())?;
        let offset = pieces.to_numeric_offset().ok_or("the time has no offset from UTC")?;
        let time = pieces.time().ok_or("the text has a date and no time")?;
        let time = offset.to_timestamp(pieces.date().to_datetime(time)).map_err(|error| error.to_string())?;
        let unix_s = u64::try_from(time.as_second()).map_err(|_| "the time is before 1970")?;
        Ok(Self { unix_s, utc_offset_s: offset.seconds() })
    }
}

impl Serialize for Stamp {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Stamp {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from)?.parse().map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_that_of_the_calendar_and_its_offset_stays() {
        // date -u -d @1795400100 and its local times, by GNU date.
        for (offset_s, text) in [
            (0, "2026-11-23T02:15:00+00:00"),
            (3600, "2026-11-23T03:15:00+01:00"),
            (-12_600, "2026-11-22T22:45:00-03:30"),
        ] {
            let stamp = Stamp::new(1_795_400_100, offset_s);
            assert_eq!(stamp.to_string(), text);
            assert_eq!(text.parse(), Ok(stamp));
            assert_eq!(stamp.date(), text[..10]);
        }
        assert_eq!("2026-11-23T02:15:00Z".parse(), Ok(Stamp::new(1_795_400_100, 0)));
        for text in ["", "2026-11-23", "2026-11-23T02:15:00", "1969-12-31T23:59:59Z", "now"] {
            assert!(text.parse::<Stamp>().is_err(), "{text}");
        }
        // No clock shows such a time. It is written all the same.
        assert!(Stamp::new(u64::MAX, i32::MAX).to_string().starts_with("9999-"));
    }
}
