//! A pin of a board with the Klipper firmware, as its users write it.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Words for the pins that are allowed.
const ALLOWED: &str = "the name of a pin, as PB13; `!` before it inverts it, and `^` or `~` before that pulls an input \
                       up or down";

/// Level to which a board pulls an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PinPull {
    /// The input is not pulled.
    #[default]
    None,
    /// The input is pulled up, `^`.
    Up,
    /// The input is pulled down, `~`.
    Down,
}

/// Pin of a board with the Klipper firmware, by its name.
///
/// The marks are those of that firmware's users: `!` inverts a pin, `^` pulls an input up, and `~` pulls it down
/// (Klipper3d/klipper, `docs/Config_Reference.md`, "Format of micro-controller pin names").
///
/// ```
/// use pump_bench::pump_file::{KlipperPin, PinPull};
///
/// let pin: KlipperPin = "^!PC0".parse()?;
/// assert_eq!((pin.name.as_str(), pin.inverted, pin.pull), ("PC0", true, PinPull::Up));
/// assert_eq!(pin.to_string(), "^!PC0");
/// # Ok::<(), pump_bench::pump_file::KlipperPinError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub struct KlipperPin {
    /// Name of the pin, as the board's firmware has it.
    pub name: String,
    /// True if the pin is active while it is low.
    pub inverted: bool,
    /// Level to which an input is pulled.
    pub pull: PinPull,
}

/// Text that is no pin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no pin of a board; allowed: {ALLOWED}")]
pub struct KlipperPinError {
    text: String,
}

impl FromStr for KlipperPin {
    type Err = KlipperPinError;

    fn from_str(text: &str) -> Result<Self, KlipperPinError> {
        let (pull, rest) = match text.split_at_checked(1) {
            Some(("^", rest)) => (PinPull::Up, rest),
            Some(("~", rest)) => (PinPull::Down, rest),
            _ => (PinPull::None, text),
        };
        let (inverted, name) = rest.strip_prefix('!').map_or((false, rest), |name| (true, name));
        // Names are PB13, gpio4, P1.22, ar54 and, of a Linux board, gpiochip0/gpio17.
        let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "._/".contains(letter);
        if name.is_empty() || !name.chars().all(is_letter) || is_beyond_ports(name) {
            return Err(KlipperPinError { text: text.to_owned() });
        }
        Ok(Self { name: name.to_owned(), inverted, pull })
    }
}

/// Returns true for a name such as PQ7 or PB42: no microcontroller of that firmware has a port beyond PL, or more than
/// 32 pins of one.
///
/// Source: Klipper3d/klipper, `src/avr/Kconfig` (the ATmega2560 has PA to PL), `src/stm32/Kconfig` (PA to PK),
/// `src/atsam/Kconfig` (32 pins a port).
fn is_beyond_ports(name: &str) -> bool {
    let port = name.strip_prefix('P').and_then(|rest| rest.chars().next()).filter(char::is_ascii_uppercase);
    let number = name.get(2..).and_then(|digits| digits.parse::<u32>().ok());
    port.zip(number).is_some_and(|(port, number)| port > 'L' || number > 31)
}

impl Display for KlipperPin {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        let pull = match self.pull {
            PinPull::None => "",
            PinPull::Up => "^",
            PinPull::Down => "~",
        };
        write!(to, "{pull}{}{}", if self.inverted { "!" } else { "" }, self.name)
    }
}

impl TryFrom<String> for KlipperPin {
    type Error = KlipperPinError;

    fn try_from(text: String) -> Result<Self, KlipperPinError> {
        text.parse()
    }
}

impl From<KlipperPin> for String {
    fn from(pin: KlipperPin) -> Self {
        pin.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_are_read_with_their_marks_and_nothing_else_is_a_pin() {
        let read = |text: &str| text.parse::<KlipperPin>();
        for text in ["PB13", "!PB14", "^PC0", "^!PC0", "~gpio17", "P1.22", "gpiochip0/gpio17"] {
            assert_eq!(read(text).unwrap().to_string(), text);
        }
        for text in ["", "!", "^", "PB 13", "!^PC0", "!!PB1", "PB13;", "mcu:PB13", "PQ7", "PB32"] {
            let said = read(text).unwrap_err().to_string();
            assert!(said.starts_with(&format!("`{text}` is no pin of a board; allowed: ")), "{said}");
        }
    }
}
