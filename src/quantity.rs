//! Quantities with their units, as people type them: `25mL`, `600 mL/min`, `100rpm`, `1.2bara`.
//!
//! Text is parsed once, at the edge; inside there are numbers whose names carry the unit.

use std::fmt;

use thiserror::Error;

/// What a quantity measures, with the units it may be given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// mL
    Volume,
    /// g
    Mass,
    /// mL/s
    Flow,
    /// rad/s of the pump head
    Speed,
    /// s
    Time,
    /// rad
    Angle,
    /// kPa absolute
    Pressure,
}

/// A text that is no such quantity: what was read, and what is accepted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// Nothing there.
    #[error("empty {kind}; write it with its unit, as in {}", .kind.example())]
    Empty {
        /// What was expected.
        kind: Kind,
    },
    /// No number at the start.
    #[error("`{text}` is not a {kind}: it does not start with a number; write for example {}", .kind.example())]
    NotANumber {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A comma as decimal mark.
    #[error("`{text}` has a comma; write the decimal mark as a point and no thousands separators")]
    Comma {
        /// What was read.
        text: String,
    },
    /// NaN, infinity or a number too large for double precision.
    #[error("`{text}` is not a finite number; write for example {}", .kind.example())]
    NotFinite {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A number alone.
    #[error("`{text}` has no unit; write for example {}, or another of: {}", .kind.example(), .kind.units_listed())]
    NoUnit {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A unit that does not exist or does not fit.
    #[error("`{text}`: unknown {kind} unit `{unit}`{hint}; accepted: {}", .kind.units_listed())]
    UnknownUnit {
        /// What was read.
        text: String,
        /// The unit.
        unit: String,
        /// What was expected.
        kind: Kind,
        /// What may have been meant, starting with a comma, or nothing.
        hint: String,
    },
    /// A pressure that may be absolute or gauge.
    #[error(
        "`{text}` may be absolute or gauge; write `{number}{unit}a` (absolute) or `{number}{unit}g` (above ambient)"
    )]
    AbsoluteOrGauge {
        /// What was read.
        text: String,
        /// Its number.
        number: String,
        /// Its unit.
        unit: String,
    },
    /// Zero where it means nothing.
    #[error("`{text}` is zero; a {kind} must be more than that")]
    Zero {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// Negative where it means nothing.
    #[error(
        "`{text}` is negative; a {kind} must be positive (a dose runs in reverse by --reverse or a negative volume)"
    )]
    Negative {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Volume => "volume",
            Self::Mass => "mass",
            Self::Flow => "flow",
            Self::Speed => "speed",
            Self::Time => "time",
            Self::Angle => "angle",
            Self::Pressure => "pressure",
        })
    }
}

/// Unit and its factor to the unit used inside.
type Units = &'static [(&'static str, f64)];

const LITRES: Units = &[
    ("L", 1e3),
    ("l", 1e3),
    ("dL", 100.0),
    ("dl", 100.0),
    ("cL", 10.0),
    ("cl", 10.0),
    ("mL", 1.0),
    ("ml", 1.0),
    ("uL", 1e-3),
    ("ul", 1e-3),
    ("µL", 1e-3),
    ("µl", 1e-3),
    ("nL", 1e-6),
    ("nl", 1e-6),
    ("cm3", 1.0),
    ("mm3", 1e-3),
];
const GRAMS: Units = &[("kg", 1e3), ("g", 1.0), ("mg", 1e-3)];
const SECONDS: Units = &[
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("min", 60.0),
    ("h", 3600.0),
];
const TURN: f64 = std::f64::consts::TAU;
const ANGLES: Units = &[
    ("deg", TURN / 360.0),
    ("°", TURN / 360.0),
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("rev", TURN),
];
const SPEEDS: Units = &[
    ("rpm", TURN / 60.0),
    ("r/min", TURN / 60.0),
    ("rev/min", TURN / 60.0),
    ("rev/s", TURN),
    ("r/s", TURN),
    ("rad/s", 1.0),
    ("deg/s", TURN / 360.0),
];
/// To kPa; with `a` or `g` behind. The pound-force per square inch is 6.894757293168361 kPa (NIST SP 811).
const PRESSURES: Units = &[
    ("Pa", 1e-3),
    ("hPa", 0.1),
    ("kPa", 1.0),
    ("MPa", 1e3),
    ("mbar", 0.1),
    ("bar", 100.0),
    ("psi", 6.894_757_293_168_361),
];

impl Kind {
    /// An example of what to write.
    pub fn example(self) -> &'static str {
        match self {
            Self::Volume => "25mL",
            Self::Mass => "25g",
            Self::Flow => "10mL/s",
            Self::Speed => "100rpm",
            Self::Time => "1.5s",
            Self::Angle => "30deg",
            Self::Pressure => "120kPaa",
        }
    }

    /// The accepted units in words.
    fn units_listed(self) -> &'static str {
        match self {
            Self::Volume => {
                "L, dL, cL, mL, uL (µL), nL, cm3, mm3 (a mass in kg, g, mg needs the fluid's density)"
            }
            Self::Mass => "kg, g, mg",
            Self::Flow => "a volume over a time, as in mL/s, mL/min, L/h, uL/min",
            Self::Speed => "rpm, r/min, rev/s, rad/s, deg/s",
            Self::Time => "s, ms, us, min, h",
            Self::Angle => "deg, rad, mrad, rev",
            Self::Pressure => {
                "Paa, kPaa, MPaa, mbara, bara, psia (absolute), or with g at the end (gauge)"
            }
        }
    }

    fn factor(self, unit: &str) -> Option<f64> {
        match self {
            Self::Volume => factor_in(LITRES, unit),
            Self::Mass => factor_in(GRAMS, unit),
            Self::Flow => {
                let (volume, time) = unit.split_once('/')?;
                Some(factor_in(LITRES, volume.trim())? / factor_in(SECONDS, time.trim())?)
            }
            Self::Speed => factor_in(SPEEDS, unit),
            Self::Time => factor_in(SECONDS, unit),
            Self::Angle => factor_in(ANGLES, unit),
            Self::Pressure => factor_in(PRESSURES, unit),
        }
    }
}

fn factor_in(units: Units, unit: &str) -> Option<f64> {
    units
        .iter()
        .find(|(name, _)| *name == unit)
        .map(|(_, factor)| *factor)
}

/// What a dose may be given as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// mL, not zero; negative in reverse.
    Volume(f64),
    /// g, not zero; negative in reverse.
    Mass(f64),
}

impl Amount {
    /// The volume in mL, of a fluid with this density in kg/m³.
    ///
    /// ```
    /// use pump_dose::quantity::{Amount, amount};
    /// assert_eq!(amount("25mL")?.volume_ml(997.0), 25.0);
    /// assert!((amount("25 g")?.volume_ml(997.0) - 25.0752).abs() < 1e-4);
    /// # Ok::<(), pump_dose::quantity::QuantityError>(())
    /// ```
    pub fn volume_ml(self, density_kg_m3: f64) -> f64 {
        match self {
            Self::Volume(ml) => ml,
            Self::Mass(grams) => grams * 1e3 / density_kg_m3,
        }
    }
}

/// A volume or a mass: `25mL`, `-5mL`, `0.025 L`, `1e3uL`, `25 g`. Not zero.
pub fn amount(text: &str) -> Result<Amount, QuantityError> {
    let read = Reading::new(text, Kind::Volume)?;
    let mass = Kind::Mass.factor(&read.unit);
    let kind = if mass.is_some() {
        Kind::Mass
    } else {
        Kind::Volume
    };
    let value = Reading { kind, ..read }.value()?;
    if value == 0.0 {
        return Err(QuantityError::Zero {
            text: shown(text),
            kind,
        });
    }
    Ok(if mass.is_some() {
        Amount::Mass(value)
    } else {
        Amount::Volume(value)
    })
}

/// A flow in mL/s, positive.
pub fn flow_ml_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Flow)
}

/// A speed of the pump head in rad/s, positive.
pub fn speed_rad_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Speed)
}

/// A time in s, positive.
pub fn time_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Time)
}

/// An angle in rad; zero and negative ones too.
pub fn angle_rad(text: &str) -> Result<f64, QuantityError> {
    Reading::new(text, Kind::Angle)?.value()
}

/// A pressure that says what it is measured against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pressure {
    /// kPa absolute.
    Absolute(f64),
    /// kPa above ambient.
    Gauge(f64),
}

impl Pressure {
    /// kPa absolute, at this ambient pressure in kPa.
    pub fn absolute_kpa(self, ambient_kpa: f64) -> f64 {
        match self {
            Self::Absolute(kpa) => kpa,
            Self::Gauge(kpa) => kpa + ambient_kpa,
        }
    }
}

/// A pressure: `120kPaa`, `20kPag`, `1.2bara`, `15psig`. A bare `15psi` is refused with both readings.
pub fn pressure(text: &str) -> Result<Pressure, QuantityError> {
    let read = Reading::new(text, Kind::Pressure)?;
    if Kind::Pressure.factor(&read.unit).is_some() {
        let (number, unit) = (read.number.clone(), read.unit.clone());
        return Err(QuantityError::AbsoluteOrGauge {
            text: shown(text),
            number,
            unit,
        });
    }
    for (suffix, of) in [
        ('a', Pressure::Absolute as fn(f64) -> Pressure),
        ('g', Pressure::Gauge),
    ] {
        if let Some(unit) = read.unit.strip_suffix(suffix)
            && Kind::Pressure.factor(unit).is_some()
        {
            return Ok(of(Reading {
                unit: unit.to_owned(),
                ..read
            }
            .value()?));
        }
    }
    Err(read.unknown_unit())
}

fn positive(text: &str, kind: Kind) -> Result<f64, QuantityError> {
    let value = Reading::new(text, kind)?.value()?;
    if value == 0.0 {
        Err(QuantityError::Zero {
            text: shown(text),
            kind,
        })
    } else if value < 0.0 {
        Err(QuantityError::Negative {
            text: shown(text),
            kind,
        })
    } else {
        Ok(value)
    }
}

/// A number and a unit, not yet put together.
struct Reading {
    text: String,
    number: String,
    unit: String,
    kind: Kind,
}

impl Reading {
    fn new(text: &str, kind: Kind) -> Result<Self, QuantityError> {
        let trimmed = shown(text.trim());
        if trimmed.is_empty() {
            return Err(QuantityError::Empty { kind });
        }
        let bare = trimmed.trim_start_matches(['+', '-']).to_ascii_lowercase();
        if bare.starts_with("nan") || bare.starts_with("inf") {
            return Err(QuantityError::NotFinite {
                text: trimmed,
                kind,
            });
        }
        let length = number_length(&trimmed);
        if length == 0 {
            return Err(QuantityError::NotANumber {
                text: trimmed,
                kind,
            });
        }
        let (number, unit) = trimmed.split_at(length);
        if unit.starts_with(',') {
            return Err(QuantityError::Comma { text: trimmed });
        }
        let unit = unit.trim().replace('\u{3bc}', "\u{b5}"); // Greek mu to micro sign
        if unit.is_empty() {
            return Err(QuantityError::NoUnit {
                text: trimmed,
                kind,
            });
        }
        Ok(Self {
            number: number.to_owned(),
            unit,
            text: trimmed,
            kind,
        })
    }

    fn value(self) -> Result<f64, QuantityError> {
        let Some(factor) = self.kind.factor(&self.unit) else {
            return Err(self.unknown_unit());
        };
        match self.number.parse::<f64>().map(|number| number * factor) {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(QuantityError::NotFinite {
                text: self.text,
                kind: self.kind,
            }),
        }
    }

    fn unknown_unit(self) -> QuantityError {
        let others = [
            Kind::Volume,
            Kind::Mass,
            Kind::Flow,
            Kind::Speed,
            Kind::Time,
            Kind::Angle,
            Kind::Pressure,
        ];
        let other = others
            .into_iter()
            .find(|other| *other != self.kind && other.factor(&self.unit).is_some());
        let lower = self.unit.to_lowercase();
        let same_letters = LITRES
            .iter()
            .find(|(name, _)| self.kind == Kind::Volume && name.to_lowercase() == lower);
        let hint = match (same_letters, other) {
            (Some((name, _)), _) => {
                format!(", did you mean `{name}` (prefixes are case-sensitive)")
            }
            (None, Some(other)) => format!(", which is a {other} unit"),
            (None, None) => String::new(),
        };
        QuantityError::UnknownUnit {
            text: self.text,
            unit: self.unit,
            kind: self.kind,
            hint,
        }
    }
}

/// Length of the number at the start of `text`: sign, digits, point, digits, exponent. Zero if there is none.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes
            .iter()
            .skip(from)
            .take_while(|byte| byte.is_ascii_digit())
            .count()
    };
    let mut at = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}

/// The text with an ASCII minus, as the user typed it: a leading minus may arrive as U+2212, see `cli`.
fn shown(text: &str) -> String {
    text.replace('\u{2212}', "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ml(text: &str) -> f64 {
        amount(text).unwrap().volume_ml(1000.0)
    }

    #[test]
    fn every_form_of_the_contract_is_read() {
        for (text, expected) in [
            ("25mL", 25.0),
            ("25 mL", 25.0),
            ("0.025 L", 25.0),
            ("0.025l", 25.0),
            ("250uL", 0.25),
            ("250\u{b5}L", 0.25),
            ("250\u{3bc}L", 0.25),
            ("1e3uL", 1.0),
            ("1E-3L", 1.0),
            (".5mL", 0.5),
            ("5.mL", 5.0),
            ("+5mL", 5.0),
            ("-5mL", -5.0),
            ("\u{2212}5mL", -5.0),
            ("25 g", 25.0),
            ("2500mg", 2.5),
        ] {
            assert!((ml(text) - expected).abs() < 1e-12, "{text}");
        }
        assert!((flow_ml_s("600 mL/min").unwrap() - 10.0).abs() < 1e-12);
        assert!((flow_ml_s("2 L/h").unwrap() - 2000.0 / 3600.0).abs() < 1e-12);
        assert!((flow_ml_s("10mL/s").unwrap() - 10.0).abs() < 1e-12);
        assert!((speed_rad_s("60rpm").unwrap() - TURN).abs() < 1e-12);
        assert!((speed_rad_s("60 r/min").unwrap() - TURN).abs() < 1e-12);
        assert_eq!(time_s("1.5s").unwrap(), 1.5);
        assert_eq!(time_s("2min").unwrap(), 120.0);
        assert!((angle_rad("-30deg").unwrap() + TURN / 12.0).abs() < 1e-15);
        assert_eq!(angle_rad("0.5rad").unwrap(), 0.5);
        assert_eq!(angle_rad("1rev").unwrap(), TURN);
        assert_eq!(angle_rad("0deg").unwrap(), 0.0);
        assert_eq!(pressure("120kPaa").unwrap().absolute_kpa(85.7), 120.0);
        assert!((pressure("20kPag").unwrap().absolute_kpa(85.7) - 105.7).abs() < 1e-12);
        assert!((pressure("1.2bara").unwrap().absolute_kpa(85.7) - 120.0).abs() < 1e-12);
        assert!((pressure("15psia").unwrap().absolute_kpa(85.7) - 103.4213594).abs() < 1e-6);
    }

    #[test]
    fn what_is_refused_names_what_was_read_and_what_is_accepted() {
        let refused = |text: &str| amount(text).unwrap_err().to_string();
        assert!(refused("25").starts_with("`25` has no unit; write for example 25mL"));
        assert!(refused("25ML").contains("unknown volume unit `ML`, did you mean `mL`"));
        assert!(refused("25 furlongs").contains("unknown volume unit `furlongs`; accepted: L,"));
        assert!(refused("25rpm").contains("which is a speed unit"));
        for text in ["NaN mL", "infmL", "-inf mL", "1e999mL"] {
            assert!(refused(text).contains("not a finite number"), "{text}");
        }
        assert!(refused("0mL").contains("is zero"));
        assert!(refused("2,5mL").contains("comma"));
        assert!(refused("").contains("empty volume"));
        assert!(refused("mL").contains("does not start with a number"));
        assert!(
            flow_ml_s("-5mL/s")
                .unwrap_err()
                .to_string()
                .contains("`-5mL/s` is negative")
        );
        assert!(flow_ml_s("0mL/s").is_err());
        assert!(
            flow_ml_s("5mL")
                .unwrap_err()
                .to_string()
                .contains("which is a volume unit")
        );
        assert_eq!(
            pressure("15 psi").unwrap_err().to_string(),
            "`15 psi` may be absolute or gauge; write `15psia` (absolute) or `15psig` (above ambient)"
        );
        assert!(pressure("15").is_err());
        assert!(pressure("15furlongsa").is_err());
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "\\PC*") {
            let _ = (amount(&text), flow_ml_s(&text), speed_rad_s(&text), time_s(&text));
            let _ = (angle_rad(&text), pressure(&text));
        }
    }
}
