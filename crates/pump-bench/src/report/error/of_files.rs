//! The facts of errors of quantities, pump files, tables and calibrations.

use std::io;
use std::path::Path;

use pump_model::Shown;

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::calibration::CalibrationError;
use crate::config::ConfigError;
use crate::dosing::ProfileError;
use crate::export::PlotError;
use crate::files::{FileError, TableError};
use crate::notice::Remedy;
use crate::pump_file::{FluidError, PumpFileError};
use crate::units::QuantityError;

impl ErrorFacts {
    /// Returns the facts of a file that cannot be read or written for this reason.
    pub fn of_file(kind: ErrorKind, path: &Path, error: &io::Error) -> Self {
        let facts = Self::of(kind).value(path.display());
        match FileError::of(error) {
            Some(FileError::NotReadable { .. }) => facts.allowed("a plain file"),
            Some(FileError::TooLarge { most, .. }) => facts.allowed(format!("{most} bytes at most")),
            Some(FileError::NotWritable { .. } | FileError::Occupied) => facts.allowed(FileError::OUTPUTS),
            None if error.kind() == io::ErrorKind::IsADirectory => facts.allowed("a plain file"),
            None => facts,
        }
    }
}

impl Explain for QuantityError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Quantity);
        match self {
            Self::Empty { kind } => facts.value("").allowed(kind.wanted()),
            Self::NotANumber { text, kind }
            | Self::NotFinite { text, kind }
            | Self::NoUnit { text, kind } => facts.value(text).allowed(kind.wanted()),
            Self::Comma { text } => facts.value(text).allowed("a decimal point"),
            Self::UnknownUnit { text, kind, .. } => facts.value(text).allowed(kind.units_listed()),
            Self::AbsoluteOrGauge { text, number, unit } => {
                facts.value(text).allowed(format!("{number}{unit}a, {number}{unit}g"))
            }
            Self::NoWall { text, bore_mm, .. } => {
                facts.value(text).allowed(format!("an outer diameter of more than {bore_mm} mm"))
            }
            Self::NoTube { text } => facts.value(text).allowed("bore x outer diameter, as 10x14mm"),
            Self::NoHose { text } => {
                facts.value(text).allowed("bore x outer diameter and the length, as 6x10mm,1m")
            }
            Self::OutOfRange { text, allowed } => facts.value(text).allowed(*allowed),
            Self::Count { text, least, most, .. } => facts.value(text).allowed(format!("{least} to {most}")),
            Self::NoTolerance { text } => facts.value(text).allowed("a tolerance, as in 30deg+-1deg"),
            Self::Tolerance { text, most_deg, .. } => {
                facts.value(text).allowed(format!("0 to {most_deg} deg"))
            }
            Self::Zero { text, .. } | Self::Negative { text, .. } => facts.value(text).allowed("more than 0"),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Tolerance { .. } => vec![Remedy::SayUnknownAngle],
            _ => Vec::new(),
        }
    }
}

impl Explain for ConfigError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Config);
        match self {
            Self::Read { path, source } => ErrorFacts::of_file(ErrorKind::Input, path, source),
            Self::Syntax { .. } => facts,
            Self::Value { value, allowed, .. } => facts.value(value).allowed(allowed),
            Self::UnknownPump { name, configured, built_in, .. } => {
                ErrorFacts::of(ErrorKind::PumpFile).value(name).allowed(format!("{configured}, {built_in}"))
            }
            Self::UnknownRack { name, configured } => {
                ErrorFacts::of(ErrorKind::Rack).value(name).allowed(configured)
            }
            Self::Taken { name, .. } => facts.value(name).allowed("a name that no pump has"),
            Self::NoRoom { line, .. } => facts.value(line),
            Self::NoLine { name, .. } => facts.value(name),
            Self::SameId { id, .. } => facts.value(id).allowed("an id of its own for each name"),
            Self::Pump(error) => error.facts(),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Pump(error) => error.remedies(),
            _ => Vec::new(),
        }
    }
}

impl Explain for PumpFileError {
    fn facts(&self) -> ErrorFacts {
        let of_pump_file = |facts| ErrorFacts { kind: ErrorKind::PumpFile, ..facts };
        let facts = ErrorFacts::of(ErrorKind::PumpFile);
        match self {
            Self::Read { path, source } => ErrorFacts::of_file(ErrorKind::Input, path, source),
            Self::Unknown { name, known } => facts.value(name).allowed(known),
            Self::Syntax { .. } => facts,
            Self::Schema { schema, .. } => facts.value(schema).allowed(crate::pump_file::SCHEMA),
            Self::Value { value, allowed, .. } => facts.value(value).allowed(allowed),
            Self::Model { source, .. } => of_pump_file(source.facts()),
            Self::Displacement { source, .. } => of_pump_file(source.facts()),
            Self::Limits { source, .. } => of_pump_file(source.facts()),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}

impl Explain for FluidError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Range);
        match self {
            Self::Unknown { name, own } => facts.value(name).allowed(format!(
                "water, ethanol, isopropanol, glycerol with its part as `glycerol 50%`, {own}"
            )),
            Self::Temperature { asked_degc, known_degc, .. } => facts
                .value(format!("{} °C", Shown(*asked_degc)))
                .allowed(format!("{known_degc} °C, within 2 °C")),
            Self::Model(error) => error.facts(),
        }
    }
}

impl Explain for ProfileError {
    fn facts(&self) -> ErrorFacts {
        let of = ErrorFacts::of(ErrorKind::Table);
        match self {
            Self::TooLong { rows, most } => {
                of.value(format!("{rows} rows")).allowed(format!("{most} rows at most"))
            }
            Self::Unequal { flows, times } => {
                of.value(format!("{flows} flows")).allowed(format!("{times} flows"))
            }
            Self::Table(_) | Self::Column { .. } | Self::Row { .. } => of,
        }
    }
}

impl Explain for TableError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of(ErrorKind::Table)
    }
}

impl Explain for PlotError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of(ErrorKind::Output)
    }
}

impl Explain for CalibrationError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Calibration);
        match self {
            Self::File { path, source, .. } => ErrorFacts::of_file(ErrorKind::Record, path, source),
            Self::Damaged { path, .. } | Self::DamagedLog { path, .. } => {
                ErrorFacts::of(ErrorKind::Record).value(path.display())
            }
            Self::Table(error) => error.facts(),
            Self::TooFew { given, needed, .. } => facts.value(given).allowed(format!("{needed} at least")),
            Self::UnknownAngle { turned_deg, pitch_deg, .. }
            | Self::PartOfPitch { turned_deg, pitch_deg } => {
                facts.value(format!("{turned_deg} deg")).allowed(format!("whole pitches of {pitch_deg} deg"))
            }
            Self::NoLastDose => facts,
            Self::DosedSince { volume, .. } => ErrorFacts::of(ErrorKind::Changed).value(volume),
            Self::NoSuchDose { dose } => ErrorFacts::of(ErrorKind::Record).value(dose),
            Self::UnsureLastDose { turned_deg, half_width_deg } => facts
                .value(format!("± {half_width_deg:.3} deg"))
                .allowed(format!("± {:.3} deg at most", 1e-3 * turned_deg.abs())),
            Self::LastDoseFromUnknownAngle { turned_deg, pitch_deg, .. } => {
                facts.value(format!("{turned_deg} deg")).allowed(format!("whole pitches of {pitch_deg} deg"))
            }
            Self::UnlikelyReading { measured_ml, expected_ml, expanded_ml } => {
                let allowed = [expected_ml - 2.0 * expanded_ml, expected_ml + 2.0 * expanded_ml];
                facts.value(format!("{measured_ml:.4} mL")).allowed(format!(
                    "{:.4} to {:.4} mL",
                    allowed[0].max(0.0),
                    allowed[1]
                ))
            }
            Self::DosedWith { source, .. } | Self::Fluid(source) => source.facts(),
            Self::WeighedWith { weighed, now, .. } => facts.value(now).allowed(weighed),
            Self::WeighedOtherwise { version, .. } => facts.value(format!("calibration {version}")),
            Self::Implausible { measured_ml, model_ml, .. }
            | Self::ImplausibleReading { measured_ml, model_ml, .. } => facts
                .value(format!("{measured_ml:.4} mL"))
                .allowed(format!("{:.4} to {:.4} mL", 0.5 * model_ml, 2.0 * model_ml)),
            Self::FluidTemperature { temperature_degc, known_degc, .. } => {
                facts.value(format!("{temperature_degc} °C")).allowed(format!("{known_degc} °C"))
            }
            Self::OutsideSpeeds { least_rpm, most_rpm, asked, .. } => ErrorFacts::of(ErrorKind::Limit)
                .value(asked)
                .allowed(format!("{least_rpm:.4} to {most_rpm:.4} r/min")),
            Self::OtherPump { then_ml, now_ml, .. } => {
                facts.value(format!("{now_ml:.6} mL")).allowed(format!("{then_ml:.6} mL"))
            }
            Self::NoSuchVersion { version, known } => facts.value(version).allowed(known),
            Self::NoSpeed { .. } | Self::NoLaw { .. } | Self::Undetermined { .. } => facts,
            Self::Model(error) => error.facts(),
        }
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}
