//! The volume of a dose, as it is typed.

use pump_bench::units::{self, Amount};

use crate::failure::Failure;

/// A volume or a mass that was asked for.
#[derive(Debug, Clone)]
pub(crate) struct AskedVolume {
    pub(crate) amount: Amount,
    /// The amount as it was typed, with a space between number and unit.
    pub(crate) typed: String,
}

/// Reads one amount from the words that were typed: `25mL`, or `25 mL` as two words.
pub(crate) fn asked(words: &[String]) -> Result<AskedVolume, Failure> {
    let text = match words {
        [] => return Err(Failure::refused("how much? Write a volume with its unit, as in `dose 25mL`")),
        [word] => word.clone(),
        [number, unit] if !unit.starts_with(is_numeric) => format!("{number} {unit}"),
        words => {
            let words = words.join(" ");
            return Err(Failure::refused(format!("`{words}`: one volume at a time, as in `dose 25mL`")));
        }
    };
    let amount = units::dose_amount(&text).map_err(Failure::of)?;
    Ok(AskedVolume { amount, typed: spaced(&text) })
}

/// True for a letter with which a number begins.
fn is_numeric(letter: char) -> bool {
    letter.is_ascii_digit() || ['.', '+', '-', '\u{2212}'].contains(&letter)
}

/// Puts one space between number and unit.
pub(crate) fn spaced(text: &str) -> String {
    let text = text.trim().replace('\u{2212}', "-");
    let ends = (1..=text.len()).rev().filter(|end| text.is_char_boundary(*end));
    match ends.into_iter().find(|end| text[..*end].parse::<f64>().is_ok()) {
        Some(end) => format!("{} {}", &text[..end], text[end..].trim_start()),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_and_unit_stand_apart() {
        for (typed, shown) in
            [("25g", "25 g"), ("25 g", "25 g"), ("\u{2212}1e3uL", "-1e3 uL"), ("0.025L", "0.025 L")]
        {
            assert_eq!(spaced(typed), shown);
        }
    }
}
