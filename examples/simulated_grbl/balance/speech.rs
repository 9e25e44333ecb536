//! The answers of a simulated balance.

use std::str::FromStr;

use super::vessel::{Defect, Reading};

/// Protocol of a simulated balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Speech {
    /// MT-SICS, level 0 (Mettler-Toledo, reference manual 11780711).
    MtSics,
    /// SBI of Sartorius with 16 characters a line (operating manual of the Quintix series, "Data interface").
    Sbi,
}

impl FromStr for Speech {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "mt-sics" => Ok(Self::MtSics),
            "sbi" => Ok(Self::Sbi),
            other => Err(format!("no protocol {other}: mt-sics or sbi")),
        }
    }
}

impl Speech {
    /// Returns the answer to a question, which is empty if the balance says nothing.
    pub(super) fn answer(self, question: &[u8], reading: &Reading, defect: Defect) -> String {
        let Reading { mass_g, decimals, is_still } = *reading;
        let mass = format!("{:.decimals$}", mass_g.abs());
        let sign = if mass_g < 0.0 { '-' } else { '+' };
        match (self, question, defect) {
            (_, _, Defect::Silent) => String::new(),
            (_, _, Defect::Garbage) => "S S  \u{fffd}\u{7}12,3,4 g\r\n".to_owned(),
            (Self::MtSics, b"SI\r\n", Defect::OtherUnit) => format!("S S {:>10.3} oz\r\n", mass_g / 28.35),
            (Self::Sbi, b"\x1bP\r\n", Defect::OtherUnit) => format!("{sign} {mass:>9} oz \r\n"),
            (Self::MtSics, b"SI\r\n", Defect::Overload) => "S +\r\n".to_owned(),
            (Self::Sbi, b"\x1bP\r\n", Defect::Overload) => "      High    \r\n".to_owned(),
            (Self::MtSics, b"SI\r\n", _) => {
                let (state, signed) =
                    (if is_still { 'S' } else { 'D' }, if sign == '-' { format!("-{mass}") } else { mass });
                format!("S {state} {signed:>10} g\r\n")
            }
            // The unit is left out while the load moves.
            (Self::Sbi, b"\x1bP\r\n", _) => {
                format!("{sign} {mass:>9} {:3}\r\n", if is_still { "g" } else { "" })
            }
            (Self::MtSics, ..) => "ES\r\n".to_owned(),
            (Self::Sbi, ..) => String::new(),
        }
    }
}
