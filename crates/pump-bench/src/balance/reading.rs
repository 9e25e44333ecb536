//! Readings as balances print them.

use super::BalanceError;
use super::words::shown_line;

/// Reading of a balance that stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BalanceReading {
    /// Mass that the balance shows, in g. Negative below its tare.
    pub mass_g: f64,
    /// Step of the last digit that the balance shows, in g.
    pub step_g: f64,
}

impl BalanceReading {
    /// Returns the mass with the digits of the balance, as it would print it.
    pub fn shown(&self) -> String {
        let decimals = (-libm::log10(self.step_g)).clamp(0.0, 9.0).round() as usize;
        format!("{:.decimals$} g", self.mass_g)
    }

    /// Returns the standard uncertainty of the difference of two readings with this last digit, in g. Each is unsure
    /// by a step over the square root of 12 (GUM, F.2.2.1).
    pub fn difference_standard_g(&self) -> f64 {
        self.step_g * libm::sqrt(2.0 / 12.0)
    }
}

/// Reads a number with its unit, as balances print it: `+   23.456 g`, `-0.01 kg`, `12.3 mg`. Digits that are not
/// verified stand in brackets, `23.45[6] g`.
///
/// ```
/// use pump_bench::balance::printed_reading;
///
/// let reading = printed_reading("+   23.45[6] g")?;
/// assert!((reading.mass_g - 23.456).abs() < 1e-12 && (reading.step_g - 0.001).abs() < 1e-15);
/// assert!(printed_reading("23.456").is_err());
/// # Ok::<(), pump_bench::balance::BalanceError>(())
/// ```
///
/// # Errors
///
/// [`BalanceError::NoUnit`] for a number alone, and [`BalanceError::Unreadable`] for anything else.
pub fn printed_reading(text: &str) -> Result<BalanceReading, BalanceError> {
    let unreadable = || BalanceError::Unreadable { said: shown_line(text) };
    let text: String = text.trim().chars().filter(|c| !matches!(c, '[' | ']')).collect();
    if text.parse::<f64>().is_ok_and(f64::is_finite) {
        return Err(BalanceError::NoUnit { said: shown_line(&text) });
    }
    let split = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ' ')));
    let (number, unit) = text.split_at(split.ok_or_else(unreadable)?);
    let factor_g = match unit.trim() {
        "kg" => 1e3,
        "g" => 1.0,
        "mg" => 1e-3,
        _ => return Err(unreadable()),
    };
    let number: String = number.chars().filter(|c| *c != ' ').collect();
    let digits = number.trim_start_matches(['+', '-']);
    let decimals = digits.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let has_inner_sign = digits.contains(['+', '-']);
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() && !has_inner_sign => Ok(BalanceReading {
            mass_g: value * factor_g,
            step_g: libm::pow(10.0, -(decimals as f64)) * factor_g,
        }),
        _ => Err(unreadable()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_are_read_with_their_units_and_steps() {
        for (text, mass_g, step_g) in [
            ("     100.00 g", 100.0, 0.01),
            ("+   123.45[6] g  ", 123.456, 0.001),
            ("-      0.0123 kg", -12.3, 0.1),
            ("250 mg", 0.25, 0.001),
            ("- 5 g", -5.0, 1.0),
        ] {
            let read = printed_reading(text).unwrap();
            assert!(
                (read.mass_g - mass_g).abs() < 1e-9 && (read.step_g / step_g - 1.0).abs() < 1e-9,
                "{text}"
            );
        }
    }

    #[test]
    fn what_is_no_mass_is_an_error_that_repeats_it() {
        for text in
            ["", "g", "12.3 lb", "12.3 pcs", "1.2.3 g", "1-2 g", "\u{fffd}\u{fffd} g", "inf g", "Err 54"]
        {
            let error = printed_reading(text).unwrap_err().to_string();
            assert!(error.contains("which is no mass"), "{text}: {error}");
        }
        let bare = printed_reading(" 12.3 ").unwrap_err().to_string();
        assert!(bare.contains("`12.3`, a number without a unit"), "{bare}");
    }
}
