//! What quantities measure, and their units.

use std::fmt;

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
    /// °C
    Temperature,
    /// mm
    Length,
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
            Self::Temperature => "temperature",
            Self::Length => "length",
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
    ("cc", 1.0),
    ("mm3", 1e-3),
];
const GRAMS: Units = &[("kg", 1e3), ("g", 1.0), ("mg", 1e-3)];
const SECONDS: Units = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("min", 60.0), ("h", 3600.0)];
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

/// The international inch is 25.4 mm.
const LENGTHS: Units =
    &[("mm", 1.0), ("cm", 10.0), ("m", 1e3), ("um", 1e-3), ("µm", 1e-3), ("in", 25.4), ("inch", 25.4)];

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
            Self::Temperature => "20degC",
            Self::Length => "63mm",
        }
    }

    /// The accepted units in words.
    pub(super) fn units_listed(self) -> &'static str {
        match self {
            Self::Volume => {
                "L, dL, cL, mL, uL (µL), nL, cm3 (cc), mm3 (a mass in kg, g, mg needs the fluid's density)"
            }
            Self::Mass => "kg, g, mg",
            Self::Flow => "a volume over a time, as in mL/s, mL/min, L/h, uL/min",
            Self::Speed => "rpm, r/min, rev/s, rad/s, deg/s",
            Self::Time => "s, ms, us, min, h",
            Self::Angle => "deg, rad, mrad, rev",
            Self::Pressure => "Paa, kPaa, MPaa, mbara, bara, psia (absolute), or with g at the end (gauge)",
            Self::Temperature => "degC (°C)",
            Self::Length => "mm, cm, m, um (µm), in",
        }
    }

    /// What may have been meant by a unit that does not fit, starting with a comma, or nothing.
    pub(super) fn hint(self, unit: &str) -> String {
        let lower = unit.to_lowercase();
        let own: Units = match self {
            Self::Volume => LITRES,
            Self::Flow => &[],
            Self::Mass => GRAMS,
            Self::Speed => SPEEDS,
            Self::Time => SECONDS,
            Self::Angle => ANGLES,
            Self::Pressure => PRESSURES,
            Self::Temperature => CELSIUS,
            Self::Length => LENGTHS,
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
        other.map_or(String::new(), |other| format!(", which is a {other} unit"))
    }

    pub(super) fn factor(self, unit: &str) -> Option<f64> {
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
            Self::Temperature => factor_in(CELSIUS, unit),
            Self::Length => factor_in(LENGTHS, unit),
        }
    }
}

fn factor_in(units: Units, unit: &str) -> Option<f64> {
    units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
}
