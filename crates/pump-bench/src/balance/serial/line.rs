//! The serial line of a balance: its speed and its framing.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Data bits, parity and stop bits of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// Eight data bits, no parity, one stop bit: Mettler-Toledo's usual.
    EightNone,
    /// Seven data bits, odd parity, one stop bit: Sartorius's usual.
    SevenOdd,
    /// Seven data bits, even parity, one stop bit.
    SevenEven,
}

/// Speed and framing of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SerialLine {
    /// Speed, in baud.
    pub baud: u32,
    /// Framing of each character.
    pub framing: Framing,
}

/// Words of the framings.
const FRAMINGS: [(&str, Framing); 3] =
    [("8N1", Framing::EightNone), ("7O1", Framing::SevenOdd), ("7E1", Framing::SevenEven)];

/// Range of speeds, in baud.
const BAUD: std::ops::RangeInclusive<u32> = 300..=921_600;

impl FromStr for SerialLine {
    type Err = String;

    /// Reads a line such as `9600,8N1`, or `9600`, which is 8N1.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is no serial line; allowed: a speed of 300 to 921600 baud, with 8N1, 7O1 or 7E1, as 9600,8N1"
            )
        };
        let (baud, framing) = text.split_once(',').unwrap_or((text, "8N1"));
        let baud = baud.trim().parse().ok().filter(|baud| BAUD.contains(baud)).ok_or_else(wrong)?;
        let found = FRAMINGS.iter().find(|(word, _)| word.eq_ignore_ascii_case(framing.trim()));
        let (_, framing) = found.ok_or_else(wrong)?;
        Ok(Self { baud, framing: *framing })
    }
}

impl Display for SerialLine {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        let word = FRAMINGS.iter().find(|(_, framing)| *framing == self.framing).map_or("", |(word, _)| word);
        write!(to, "{},{word}", self.baud)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_as_they_are_written() {
        for text in ["9600,8N1", "1200,7O1", "19200,7E1"] {
            assert_eq!(text.parse::<SerialLine>().unwrap().to_string(), text);
        }
        assert_eq!("4800".parse::<SerialLine>().unwrap().framing, Framing::EightNone);
        for text in ["", "fast", "9600,8X1", "12,8N1"] {
            assert!(text.parse::<SerialLine>().unwrap_err().contains("9600,8N1"), "{text}");
        }
    }
}
