//! Kinds of quantities and their units.

use std::fmt;

/// A kind of quantity. Each kind accepts a list of units and is kept in one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Volume, kept in mL.
    Volume,
    /// Mass, kept in g.
    Mass,
    /// Volume or mass, whose unit says which.
    Amount,
    /// Reading of a scale or of a measuring vessel: a mass or a volume, whose unit says which.
    Reading,
    /// Flow, kept in mL/s.
    Flow,
    /// Speed of the pump head, kept in rad/s.
    Speed,
    /// Time, kept in s.
    Time,
    /// Angle, kept in rad.
    Angle,
    /// Pressure, kept in kPa.
    Pressure,
    /// Temperature, kept in °C.
    Temperature,
    /// Length, kept in mm.
    Length,
    /// Electric current, kept in A.
    Current,
    /// Life of a tube: a volume, a time or a turn, whose unit says which.
    Life,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Volume => "volume",
            Self::Mass => "mass",
            Self::Amount => "volume or mass",
            Self::Reading => "mass or volume",
            Self::Flow => "flow",
            Self::Speed => "speed",
            Self::Time => "time",
            Self::Angle => "angle",
            Self::Pressure => "pressure",
            Self::Temperature => "temperature",
            Self::Length => "length",
            Self::Current => "current",
            Self::Life => "tube life",
        })
    }
}

/// Units, each with its factor to the unit of the kind.
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
    ("cc", 1.0),
    ("mm3", 1e-3),
];
const GRAMS: Units = &[("kg", 1e3), ("g", 1.0), ("mg", 1e-3)];
const SECONDS: Units =
    &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("min", 60.0), ("h", 3600.0), ("d", 86_400.0)];
const TURN: f64 = std::f64::consts::TAU;
const ANGLES: Units =
    &[("deg", TURN / 360.0), ("°", TURN / 360.0), ("rad", 1.0), ("mrad", 1e-3), ("rev", TURN)];
const CELSIUS: Units = &[("degC", 1.0), ("°C", 1.0), ("celsius", 1.0)];
const SPEEDS: Units = &[
    ("rpm", TURN / 60.0),
    ("r/min", TURN / 60.0),
    ("rev/min", TURN / 60.0),
    ("rev/s", TURN),
    ("r/s", TURN),
    ("rad/s", 1.0),
    ("deg/s", TURN / 360.0),
];
/// Units of pressure, to which users append `a` or `g`. The pound-force per square inch is 6.894757293168361
/// kPa (NIST SP 811).
const PRESSURES: Units = &[
    ("Pa", 1e-3),
    ("hPa", 0.1),
    ("kPa", 1.0),
    ("MPa", 1e3),
    ("mbar", 0.1),
    ("bar", 100.0),
    ("psi", 6.894_757_293_168_361),
];

/// Units of length. The international inch is 25.4 mm.
const LENGTHS: Units =
    &[("mm", 1.0), ("cm", 10.0), ("m", 1e3), ("um", 1e-3), ("µm", 1e-3), ("in", 25.4), ("inch", 25.4)];

const AMPERES: Units = &[("A", 1.0), ("mA", 1e-3)];

impl Kind {
    /// Says how to write a quantity of this kind.
    pub(crate) fn wanted(self) -> String {
        format!("{} with its unit, as {}", self.with_article(), self.example())
    }

    /// Returns the name of the kind after its article.
    pub(super) fn with_article(self) -> String {
        let article = if self == Self::Angle { "an" } else { "a" };
        format!("{article} {self}")
    }

    /// Returns an example of how to write a quantity of this kind.
    pub(crate) fn example(self) -> &'static str {
        match self {
            Self::Volume => "25mL",
            Self::Mass => "25g",
            Self::Amount => "25mL or 25g",
            Self::Reading => "25g or 25mL",
            Self::Flow => "10mL/s",
            Self::Speed => "100rpm",
            Self::Time => "1.5s",
            Self::Angle => "30deg",
            Self::Pressure => "120kPaa",
            Self::Temperature => "20degC",
            Self::Length => "63mm",
            Self::Current => "0.5A",
            Self::Life => "100L, 500h or 1e6rev",
        }
    }

    /// Returns the accepted units in words.
    pub(crate) fn units_listed(self) -> &'static str {
        match self {
            Self::Volume => {
                "L, dL, cL, mL, uL (µL), nL, cm3 (cc), mm3 (a mass in kg, g, mg needs the fluid's density)"
            }
            Self::Mass => "kg, g, mg",
            Self::Amount | Self::Reading => "kg, g, mg; L, dL, cL, mL, uL (µL), nL, cm3 (cc), mm3",
            Self::Flow => "a volume over a time, as in mL/s, mL/min, L/h, uL/min",
            Self::Speed => "rpm, r/min, rev/s, rad/s, deg/s",
            Self::Time => "s, ms, us, min, h, d",
            Self::Angle => "deg, rad, mrad, rev",
            Self::Pressure => "Paa, kPaa, MPaa, mbara, bara, psia (absolute), or with g at the end (gauge)",
            Self::Temperature => "degC (°C)",
            Self::Length => "mm, cm, m, um (µm), in",
            Self::Current => "A, mA",
            Self::Life => "L, mL and other volumes; h, d and other times; rev",
        }
    }

    /// Returns the unit that may have been meant by one that does not fit, after a comma. Empty if no unit is
    /// near.
    pub(super) fn hint(self, unit: &str) -> String {
        let lower = unit.to_lowercase();
        let own: Units = match self {
            Self::Volume => LITRES,
            Self::Flow => &[],
            Self::Mass => GRAMS,
            Self::Amount | Self::Reading if GRAMS.iter().any(|(name, _)| name.to_lowercase() == lower) => {
                GRAMS
            }
            Self::Amount | Self::Reading => LITRES,
            Self::Speed => SPEEDS,
            Self::Time => SECONDS,
            Self::Angle => ANGLES,
            Self::Pressure => PRESSURES,
            Self::Temperature => CELSIUS,
            Self::Length => LENGTHS,
            Self::Current => AMPERES,
            Self::Life => LITRES,
        };
        if let Some((name, _)) = own.iter().find(|(name, _)| name.to_lowercase() == lower) {
            return format!(", did you mean `{name}` (case matters)");
        }
        let all = [
            Self::Volume,
            Self::Mass,
            Self::Flow,
            Self::Speed,
            Self::Time,
            Self::Angle,
            Self::Pressure,
            Self::Length,
        ];
        let other = all.into_iter().find(|other| *other != self && other.factor(unit).is_some());
        other.map_or(String::new(), |other| {
            // An angle alone begins with a vowel.
            let article = if other == Self::Angle { "an" } else { "a" };
            format!(", which is {article} {other} unit")
        })
    }

    /// Returns the factor from `unit` to the unit of this kind, or `None` for an unknown unit.
    pub(super) fn factor(self, unit: &str) -> Option<f64> {
        match self {
            Self::Volume => factor_in(LITRES, unit),
            Self::Mass => factor_in(GRAMS, unit),
            Self::Amount | Self::Reading => factor_in(GRAMS, unit).or_else(|| factor_in(LITRES, unit)),
            Self::Flow => {
                let (volume, time) = unit.split_once('/')?;
                Some(factor_in(LITRES, volume.trim())? / factor_in(SECONDS, time.trim())?)
            }
            Self::Speed => factor_in(SPEEDS, unit),
            Self::Time => factor_in(SECONDS, unit),
            Self::Angle => factor_in(ANGLES, unit),
            Self::Pressure => factor_in(PRESSURES, unit),
            Self::Temperature => factor_in(CELSIUS, unit),
            Self::Length => factor_in(LENGTHS, unit),
            Self::Current => factor_in(AMPERES, unit),
            Self::Life => factor_in(LITRES, unit),
        }
    }
}

/// Returns the factor of `unit` in a list of units.
fn factor_in(units: Units, unit: &str) -> Option<f64> {
    units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
}
