//! Pump files: one TOML file that says everything about a pump, each number with its unit in its key.

use std::path::{Path, PathBuf};

use pump_ctl::plan::PlanError;
use pump_model::math::radians;
use pump_model::{Friction, Geometry, ModelError, Pump};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::displacement::SpeedLawError;

use super::drive::{DriveTable, DriverName};
use super::fluid::FluidTable;
use super::limits::LimitsTable;
use super::line::LineTable;
use super::motor::MotorTable;
use super::roller_volume::RollerVolumeTable;
use super::speed_law::SpeedLawTable;
use super::tube::TubeTable;

/// Schema of pump files.
pub const SCHEMA: &str = "pump/1";

/// A pump file's contents, checked by [`PumpFile::check`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PumpFile {
    /// `pump/1`.
    pub schema: String,
    /// Name and defaults.
    pub pump: PumpTable,
    /// The tube.
    pub tube: TubeTable,
    /// The rollers.
    pub rollers: RollersTable,
    /// The backplate (raceway).
    pub backplate: BackplateTable,
    /// Volume that a roller displaces.
    pub roller_volume: RollerVolumeTable,
    /// How the volume of a revolution depends on the speed.
    #[serde(default)]
    pub speed_law: SpeedLawTable,
    /// Line from the inlet's reservoir to the pump.
    pub inlet: LineTable,
    /// Line from the pump to the outlet's reservoir.
    pub outlet: LineTable,
    /// The stepper motor.
    pub motor: MotorTable,
    /// What is pumped.
    pub fluid: FluidTable,
    /// Surroundings.
    pub ambient: AmbientTable,
    /// Pressures that a dose must keep.
    #[serde(default, skip_serializing_if = "LimitsTable::is_empty")]
    pub limits: LimitsTable,
    /// How far to trust the model.
    pub uncertainty: UncertaintyTable,
    /// What turns the motor; without it doses are simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<DriveTable>,
}

/// `[pump]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PumpTable {
    /// Lower-case letters, digits, `-` and `_`: names the folder of its record.
    pub id: String,
    /// For people.
    pub name: String,
    /// Rate of a dose that names none, mL/s.
    pub default_rate_ml_s: f64,
    /// Angle at which the rotor's mark meets the housing's, deg.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mark_angle_deg: Option<f64>,
}

/// `[rollers]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollersTable {
    /// NU.
    pub count: u32,
    /// r_roller, mm.
    pub radius_mm: f64,
    /// r_offset, mm.
    pub offset_mm: f64,
}

/// `[backplate]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackplateTable {
    /// r_b, mm.
    pub radius_mm: f64,
    /// beta, deg: the backplate spans 180 + 2 beta.
    pub contact_angle_deg: f64,
}

/// `[ambient]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AmbientTable {
    /// Atmospheric pressure, kPa absolute: what gauge pressures are measured against.
    pub pressure_kpa: f64,
}

/// `[uncertainty]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UncertaintyTable {
    /// Standard uncertainty of the model's volume, percent of it.
    pub model_percent: f64,
    /// Standard deviation of repeated doses, percent of the volume.
    pub repeatability_percent: f64,
    /// Standard uncertainty of the volume of one roller, mL: what a dose within a single pulse is unsure of.
    pub roller_volume_ml: f64,
}

/// A pump file that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PumpFileError {
    /// It cannot be read.
    #[error("cannot read pump file {}: {source}", .path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Neither a built-in pump nor a file.
    #[error("there is no pump `{name}`; built-in pumps: {known}; or name a TOML pump file")]
    Unknown {
        /// What was named.
        name: String,
        /// The built-in pumps.
        known: String,
    },
    /// It is no TOML, or has unknown, missing or mistyped keys.
    #[error("pump file {origin}: {message}")]
    Syntax {
        /// Which file.
        origin: String,
        /// What the parser says, with line and column.
        message: String,
    },
    /// Its schema is not ours.
    #[error("pump file {origin}: schema is `{schema}`; this version reads `pump/1`")]
    Schema {
        /// Which file.
        origin: String,
        /// What it says.
        schema: String,
    },
    /// A value is not allowed.
    #[error("pump file {origin}: {key} is {value}; allowed: {allowed}")]
    Value {
        /// Which file.
        origin: String,
        /// Table and key.
        key: &'static str,
        /// What it says.
        value: String,
        /// What is accepted.
        allowed: &'static str,
    },
    /// The pump that it describes cannot work.
    #[error("pump file {origin}: {source}")]
    Model {
        /// Which file.
        origin: String,
        /// Why.
        source: ModelError,
    },
    /// Its speed law has no speed for the default rate.
    #[error("pump file {origin}: [pump] default_rate_ml_s: {source}")]
    SpeedLaw {
        /// Which file.
        origin: String,
        /// Why.
        source: SpeedLawError,
    },
    /// Its motor or limits cannot work.
    #[error("pump file {origin}: {source}")]
    Limits {
        /// Which file.
        origin: String,
        /// Why.
        source: PlanError,
    },
}

impl PumpFile {
    /// Reads and checks a file.
    pub fn read(path: &Path) -> Result<Self, PumpFileError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| PumpFileError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Parses and checks TOML; `origin` names it in errors.
    pub fn parse(text: &str, origin: &str) -> Result<Self, PumpFileError> {
        let file: Self = toml::from_str(text).map_err(|error| PumpFileError::Syntax {
            origin: origin.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        file.check(origin)?;
        Ok(file)
    }

    /// The file as TOML.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_else(|error| unreachable!("a pump file is plain tables: {error}"))
    }

    /// Refuses contents that are contradictory or cannot work; `origin` names them in errors.
    pub fn check(&self, origin: &str) -> Result<(), PumpFileError> {
        let origin = || origin.to_owned();
        if self.schema != SCHEMA {
            return Err(PumpFileError::Schema { origin: origin(), schema: self.schema.clone() });
        }
        let value = |ok: bool, key, value: &dyn std::fmt::Display, allowed| {
            if ok {
                Ok(())
            } else {
                Err(PumpFileError::Value { origin: origin(), key, value: value.to_string(), allowed })
            }
        };
        let id = &self.pump.id;
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        value(
            (1..=64).contains(&id.len()) && id.chars().all(letters),
            "[pump] id",
            &format_args!("`{id}`"),
            "1 to 64 of a-z, 0-9, - and _",
        )?;
        if let Some(mark) = self.pump.mark_angle_deg {
            value(mark.is_finite() && mark.abs() <= 360.0, "[pump] mark_angle_deg", &mark, "-360 to 360")?;
        }
        if let Some((key, found, allowed)) = self.tube.wrong().or_else(|| self.motor.wrong()) {
            value(false, key, &found, allowed)?;
        }
        if let Some((key, found, allowed)) = self.speed_law.wrong() {
            value(false, key, &found, allowed)?;
        }
        if let Some(drive) = &self.drive {
            drive.check(value)?;
        }
        let density = self.fluid.density_kg_m3;
        value((10.0..=25_000.0).contains(&density), "[fluid] density_kg_m3", &density, "10 to 25000")?;
        let temperature = self.fluid.temperature_degc;
        value(
            (-273.15..=1000.0).contains(&temperature),
            "[fluid] temperature_degc",
            &temperature,
            "-273.15 to 1000",
        )?;
        if let Some(vapour) = self.fluid.vapour_kpa {
            value((0.0..=1e4).contains(&vapour), "[fluid] vapour_kpa", &vapour, "0 to 10000 (absolute)")?;
        }
        let has_hose = self.inlet.is_estimated() || self.outlet.is_estimated();
        if let Some(key) = self.fluid.missing().filter(|_| has_hose) {
            value(
                false,
                key,
                &"missing",
                "a number: a line from a hose needs it, and nothing is known of this fluid",
            )?;
        }
        let ambient = self.ambient.pressure_kpa;
        value((1.0..=1e4).contains(&ambient), "[ambient] pressure_kpa", &ambient, "1 to 10000")?;
        let percent = 0.0..=100.0;
        let uncertainty = &self.uncertainty;
        value(
            percent.contains(&uncertainty.model_percent),
            "[uncertainty] model_percent",
            &uncertainty.model_percent,
            "0 to 100 (the paper's pump reaches 2.4)",
        )?;
        value(
            percent.contains(&uncertainty.repeatability_percent),
            "[uncertainty] repeatability_percent",
            &uncertainty.repeatability_percent,
            "0 to 100 (the paper's pump reaches 0.47)",
        )?;
        value(
            (0.0..=1e4).contains(&uncertainty.roller_volume_ml),
            "[uncertainty] roller_volume_ml",
            &uncertainty.roller_volume_ml,
            "0 to 10000 (the paper's two figures differ by 0.045)",
        )?;

        let limits = self.limits();
        limits.validate().map_err(|source| PumpFileError::Limits { origin: origin(), source })?;
        let model = self.model().map_err(|source| PumpFileError::Model { origin: origin(), source })?;
        let rate = self.pump.default_rate_ml_s;
        self.check_speed_law(&model, rate, origin)?;
        let fastest = model.average_flow_ml_s(limits.motor.max_speed_rad_s);
        value(
            rate > 0.0 && rate <= fastest,
            "[pump] default_rate_ml_s",
            &rate,
            "more than 0, and no more than the flow at [motor] max_speed_rpm",
        )
    }

    /// Refuses a speed law that cannot be computed or has no speed for the default rate.
    fn check_speed_law(
        &self,
        model: &Pump,
        rate_ml_s: f64,
        origin: impl Fn() -> String,
    ) -> Result<(), PumpFileError> {
        let of_model = |source| PumpFileError::Model { origin: origin(), source };
        let Some(law) = self.speed_law().map_err(of_model)? else { return Ok(()) };
        match law.up_to(self.motor.max_speed_rpm).speed_for_flow(model, rate_ml_s) {
            Ok(_) => Ok(()),
            Err(SpeedLawError::Model(source)) => Err(of_model(source)),
            Err(source) => Err(PumpFileError::SpeedLaw { origin: origin(), source }),
        }
    }

    /// Its dimensions.
    pub(super) fn geometry(&self) -> Geometry {
        Geometry {
            rollers: self.rollers.count,
            bore_radius_mm: self.tube.bore_radius_mm,
            tube_outer_radius_mm: self.tube.outer_radius_mm,
            backplate_radius_mm: self.backplate.radius_mm,
            contact_angle_rad: radians(self.backplate.contact_angle_deg),
            roller_radius_mm: self.rollers.radius_mm,
            roller_offset_mm: self.rollers.offset_mm,
        }
    }

    /// The pump that it describes, without its speed law.
    pub fn model(&self) -> Result<Pump, ModelError> {
        let geometry = self.geometry();
        let volume = self.roller_volume.curve(&geometry)?;
        let line = |table: &LineTable| table.line(|| self.fluid.fluid(), self.pump.default_rate_ml_s);
        Pump::new(geometry, volume, line(&self.inlet)?, line(&self.outlet)?)
    }

    /// What the hoses of inlet and outlet resist at every flow; none where a line is given by its R.
    pub fn frictions(&self) -> Result<[Option<Friction>; 2], ModelError> {
        let friction = |table: &LineTable| table.friction(|| self.fluid.fluid());
        Ok([friction(&self.inlet)?, friction(&self.outlet)?])
    }

    /// Whether volumes follow from a drawing that nobody has held against the pump.
    pub fn is_estimated(&self) -> bool {
        self.roller_volume.is_estimated()
    }

    /// What turns the motor unless another driver is named.
    pub fn driver(&self) -> DriverName {
        self.drive.as_ref().map_or(DriverName::Sim, |drive| drive.driver)
    }
}
