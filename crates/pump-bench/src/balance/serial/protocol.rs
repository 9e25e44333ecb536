//! The questions and answers of balances over a serial line.

use super::line::{Framing, SerialLine};
use crate::balance::words::shown_line;
use crate::balance::{BalanceError, BalanceReading, printed_reading};
use crate::words::words;

/// Protocol of a balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// MT-SICS of Mettler-Toledo, which other makers' balances speak too (reference manual 11780711, level 0).
    MtSics,
    /// SBI of Sartorius, with 16 or 22 characters a line (operating manuals of the Quintix and Master series,
    /// chapter "Data interface").
    Sbi,
}

words!(Protocol { MtSics = "mt-sics", Sbi = "sbi" });

/// Answer of a balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Answer {
    /// The balance stands still and shows this.
    Still(BalanceReading),
    /// The balance moves and shows this, or is busy and shows nothing.
    Moving(Option<BalanceReading>),
    /// The line answers another question.
    Other,
}

impl Protocol {
    /// Returns the speed and framing that balances of this protocol usually have.
    pub fn usual_line(self) -> SerialLine {
        let framing = match self {
            Self::MtSics => Framing::EightNone,
            Self::Sbi => Framing::SevenOdd,
        };
        SerialLine { baud: 9600, framing }
    }

    /// Returns the question for the present mass.
    pub(super) fn question(self) -> &'static [u8] {
        match self {
            // The mass at once, with a word whether it stands still: the balance never waits by itself.
            Self::MtSics => b"SI\r\n",
            Self::Sbi => b"\x1bP\r\n",
        }
    }

    /// Returns true if a balance of this protocol answers each question at once. One of SBI may be set to print a mass
    /// only once it stands still, and is silent until then.
    pub(super) fn answers_at_once(self) -> bool {
        self == Self::MtSics
    }

    /// Reads a line of the balance. `unit` is that of the last mass that stood still: SBI leaves the unit out while the
    /// balance moves.
    pub(super) fn answer(self, line: &str, unit: &str) -> Result<Answer, BalanceError> {
        match self {
            Self::MtSics => mt_sics(line),
            Self::Sbi => sbi(line, unit),
        }
    }
}

/// Returns the error of a balance that speaks `seen` where it was asked in `asked`.
pub(super) fn other_protocol(asked: Protocol, seen: Protocol, line: &str) -> BalanceError {
    BalanceError::OtherProtocol { asked: asked.as_str(), seen: seen.as_str(), said: shown_line(line) }
}

/// Reads an answer of MT-SICS: `S S     100.00 g` stands still, `S D` moves, `S I` is busy.
fn mt_sics(line: &str) -> Result<Answer, BalanceError> {
    let said = || shown_line(line);
    let mut words = line.trim().splitn(3, ' ');
    let (kind, state) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let mut mass = || {
        printed_reading(words.next().unwrap_or_default())
            .map_err(|_| BalanceError::Unreadable { said: said() })
    };
    match (kind, state) {
        ("S", "S") => mass().map(Answer::Still),
        ("S", "D") => mass().map(|reading| Answer::Moving(Some(reading))),
        ("S", "I") => Ok(Answer::Moving(None)),
        ("S", "+") => Err(BalanceError::OutOfRange { state: "overloaded", said: said() }),
        ("S", "-") => Err(BalanceError::OutOfRange { state: "underloaded", said: said() }),
        ("ES" | "ET" | "EL", _) => Err(BalanceError::Refused { said: said() }),
        ("S", _) => Err(BalanceError::Unreadable { said: said() }),
        // A balance of SBI prints by itself where it is set so.
        _ if matches!(sbi(line, ""), Ok(Answer::Still(_))) => {
            Err(other_protocol(Protocol::MtSics, Protocol::Sbi, line))
        }
        _ => Ok(Answer::Other),
    }
}

/// Reads an answer of SBI: `+   123.45 g` stands still, without a unit it moves. A code of six characters may stand
/// before it.
fn sbi(line: &str, unit: &str) -> Result<Answer, BalanceError> {
    let said = || shown_line(line);
    let text = line.trim_end_matches(['\r', '\n']);
    // The code of the longer form begins with a letter, and the mass has the 16 last characters.
    let begins_with_letter = text.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let value = if begins_with_letter && text.len() > 14 { text.get(6..).unwrap_or(text) } else { text };
    let bare = value.trim();
    // MT-SICS does not know the question, or sends a mass by itself.
    let is_mt_sics = line.trim_start().starts_with("S ") && mt_sics(line).is_ok();
    if is_mt_sics || matches!(line.trim(), "ES" | "ET" | "EL") {
        return Err(other_protocol(Protocol::Sbi, Protocol::MtSics, line));
    }
    if bare.starts_with("High") || bare == "H" {
        return Err(BalanceError::OutOfRange { state: "overloaded", said: said() });
    }
    if bare.starts_with("Low") || bare == "L" {
        return Err(BalanceError::OutOfRange { state: "underloaded", said: said() });
    }
    if bare.starts_with("Err") || bare.starts_with("ERR") {
        return Err(BalanceError::Refused { said: said() });
    }
    // A calibration under way, dashes before the first mass, and a mass without unit: the balance is not ready.
    let is_busy =
        bare.is_empty() || bare == "C" || bare.starts_with("Cal") || bare.trim_matches(['-', ' ']).is_empty();
    let is_bare_number =
        bare.chars().all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ' ' | '[' | ']'));
    if is_busy {
        return Ok(Answer::Moving(None));
    }
    if is_bare_number {
        return Ok(Answer::Moving(printed_reading(&format!("{bare} {unit}")).ok()));
    }
    printed_reading(bare).map_err(|_| BalanceError::Unreadable { said: said() }).map(Answer::Still)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moving_g(answer: Result<Answer, BalanceError>) -> Option<f64> {
        match answer {
            Ok(Answer::Moving(Some(reading))) => Some(reading.mass_g),
            _ => None,
        }
    }

    fn still(answer: Result<Answer, BalanceError>) -> Option<f64> {
        match answer {
            Ok(Answer::Still(reading)) => Some(reading.mass_g),
            _ => None,
        }
    }

    #[test]
    fn mt_sics_tells_still_from_moving() {
        let answer = |line| Protocol::MtSics.answer(line, "g");
        assert_eq!(still(answer("S S     100.00 g")), Some(100.0));
        assert_eq!(still(answer("S S      -0.51 g\r")), Some(-0.51));
        assert_eq!(moving_g(answer("S D     100.00 g")), Some(100.0));
        assert_eq!(answer("S I").unwrap(), Answer::Moving(None));
        assert!(answer("S D     100.00 oz").is_err());
        assert_eq!(answer("I4 A \"0123\"").unwrap(), Answer::Other);
        for (line, part) in [
            ("S +", "overloaded"),
            ("S -", "underloaded"),
            ("ES", "refused"),
            ("S S     100.00", "no mass"),
            ("S X  1 g", "no mass"),
        ] {
            assert!(answer(line).unwrap_err().to_string().contains(part), "{line}");
        }
    }

    #[test]
    fn a_balance_that_speaks_the_other_protocol_is_told_by_it() {
        for (protocol, line, seen) in [
            (Protocol::Sbi, "ES\r\n", "mt-sics"),
            (Protocol::Sbi, "S S     100.00 g\r\n", "mt-sics"),
            (Protocol::Sbi, "S D     100.00 g\r\n", "mt-sics"),
            (Protocol::MtSics, "+   123.56 g  \r\n", "sbi"),
            (Protocol::MtSics, "N     +   123.56 g  \r\n", "sbi"),
        ] {
            let error = protocol.answer(line, "g").unwrap_err();
            assert!(
                matches!(error, BalanceError::OtherProtocol { asked, seen: found, .. }
                    if asked == protocol.as_str() && found == seen),
                "{line}: {error}"
            );
        }
    }

    #[test]
    fn sbi_tells_still_from_moving_in_both_forms() {
        let answer = |line| Protocol::Sbi.answer(line, "mg");
        assert_eq!(still(answer("+   123.56 g  \r\n")), Some(123.56));
        assert_eq!(still(answer("N     +   123.56 g  \r\n")), Some(123.56));
        assert_eq!(still(answer("-     0.5[6] g  ")), Some(-0.56));
        // The unit is missing while the balance moves: that of the last mass counts.
        assert_eq!(moving_g(answer("+   123.56    ")), Some(0.12356));
        assert_eq!(moving_g(answer("N     +   123.56    ")), Some(0.12356));
        assert_eq!(answer("      --      ").unwrap(), Answer::Moving(None));
        for (line, part) in [
            ("      High    ", "overloaded"),
            ("Stat         H      ", "overloaded"),
            ("      Low     ", "underloaded"),
            ("   Err  054    ", "refused"),
            ("+   12 3.56 lb", "no mass"),
        ] {
            assert!(answer(line).unwrap_err().to_string().contains(part), "{line}");
        }
    }
}
