//! The pump file itself: its tables, its text and the pump that it describes.

use std::path::Path;

use pump_model::units::radians;
use pump_model::{Friction, Geometry, ModelError, Port, Pump, SpeedLaw};
use serde::{Deserialize, Serialize};

use super::ambient::AmbientTable;
use super::drive::{DriveTable, DriverName};
use super::error::PumpFileError;
use super::fluid::FluidTable;
use super::head::{BackplateTable, HeadTable, RollerVolumeTable, RollersTable, TubeTable};
use super::limits::LimitsTable;
use super::limits::safety::SafetyTable;
use super::line::outlet::OutletTable;
use super::line::reservoir::Side;
use super::line::{LineSource, LineTable};
use super::motor::MotorTable;
use super::pump::PumpTable;
use super::speed_law::SpeedLawTable;
use super::uncertainty::UncertaintyTable;
use crate::displacement::{DisplacementLaw, PulsePrior, SpeedDependentPump};
use crate::files::{MOST_PUMP_FILE_BYTES, read_text};
use crate::notice::Notice;

/// Schema of pump files.
pub(crate) const SCHEMA: &str = "pump/1";

/// The contents of a pump file. [`PumpFile::check`] checks them.
///
/// ```
/// use pump_bench::PumpFile;
///
/// let text = pump_bench::built_in("three-roller").unwrap().to_toml();
/// let file = PumpFile::parse(&text, "three.toml")?;
/// assert_eq!(file.rollers.count, 3);
/// assert!((file.model()?.revolution_ml() - 21.3185).abs() < 1e-3);
///
/// let refused = PumpFile::parse(&text.replace("gear = 1.0", "gear = 0.0"), "three.toml").unwrap_err();
/// assert_eq!(refused.to_string(), "pump file three.toml: [motor] gear is 0; allowed: 0.001 to 10000");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PumpFile {
    /// Schema of the file, `pump/1`.
    pub schema: String,
    /// Name of the pump and its defaults.
    pub pump: PumpTable,
    /// Bought head, of which the volume of a revolution is known and no dimension. `None` for a head that is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head: Option<HeadTable>,
    /// Tube that the rollers squeeze.
    #[serde(default, skip_serializing_if = "TubeTable::is_empty")]
    pub tube: TubeTable,
    /// Rollers of the pump head. A head of the catalogue may give their number.
    #[serde(default = "RollersTable::not_given")]
    pub rollers: RollersTable,
    /// Backplate (raceway) of the pump head. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub backplate: Option<BackplateTable>,
    /// Volume that a roller displaces. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roller_volume: Option<RollerVolumeTable>,
    /// Dependence of the volume of a revolution on the speed.
    #[serde(default)]
    pub speed_law: SpeedLawTable,
    /// Line from the inlet's reservoir to the pump.
    #[serde(default, skip_serializing_if = "LineTable::is_absent")]
    pub inlet: LineTable,
    /// Line from the pump to the outlet's reservoir, with its nozzle.
    #[serde(default, skip_serializing_if = "OutletTable::is_absent")]
    pub outlet: OutletTable,
    /// Stepper motor of the pump head.
    pub motor: MotorTable,
    /// Fluid that is pumped.
    pub fluid: FluidTable,
    /// Surroundings of the pump.
    #[serde(default)]
    pub ambient: AmbientTable,
    /// Pressures that a dose must keep.
    #[serde(default, skip_serializing_if = "LimitsTable::is_empty")]
    pub limits: LimitsTable,
    /// Limits that keep the pump safe while nobody looks.
    #[serde(default, skip_serializing_if = "SafetyTable::is_empty")]
    pub safety: SafetyTable,
    /// Uncertainty of the model and of repeated doses.
    #[serde(default, skip_serializing_if = "UncertaintyTable::is_assumed")]
    pub uncertainty: UncertaintyTable,
    /// Drive that turns the motor. Without a drive, doses are simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<DriveTable>,
}

impl PumpFile {
    /// Returns the warning of a fluid whose viscosity the resistance of a line does not follow. `None` where the fluid
    /// is the file's, flows as that one does, or where every line is a hose or unknown.
    ///
    /// ```
    /// let mut file = pump_bench::built_in("three-roller").unwrap();
    /// assert_eq!(file.resistance_warning(), None);
    /// file.fluid = file.fluid.changed_to(Some("glycerol 50%"), Some(20.0)).unwrap();
    /// let warning = file.resistance_warning().unwrap();
    /// assert!(warning.text().contains("stay those of water at 25 °C"), "{warning}");
    /// ```
    pub fn resistance_warning(&self) -> Option<Notice> {
        let is_given = |source| matches!(source, &LineSource::Given { .. });
        self.fluid.resistance_warning([&self.inlet.source, &self.outlet.line.source].map(is_given))
    }

    /// Reads and checks a pump file.
    ///
    /// # Errors
    /// [`PumpFileError::Read`] if the file cannot be read. Otherwise as [`PumpFile::parse`].
    pub fn read(path: &Path) -> Result<Self, PumpFileError> {
        let text = read_text(path, MOST_PUMP_FILE_BYTES)
            .map_err(|source| PumpFileError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Parses and checks TOML. `origin` names the file in errors.
    ///
    /// # Errors
    /// [`PumpFileError::Syntax`] if the text is not the TOML of a pump file. Otherwise as
    /// [`PumpFile::check`].
    pub fn parse(text: &str, origin: &str) -> Result<Self, PumpFileError> {
        let mut file: Self = toml::from_str(text).map_err(|error| PumpFileError::Syntax {
            origin: origin.to_owned(),
            message: match error.message() {
                "missing field `driver`" => {
                    "[drive] has no driver, sim, grbl, node or klipper; add it, as driver = \"sim\" beside pace"
                        .to_owned()
                }
                _ => error.to_string().trim_end().to_owned(),
            },
        })?;
        file.fill_from_catalogue();
        let file = file.with_assumptions();
        file.check(origin)?;
        Ok(file)
    }

    /// Returns the file with the uncertainty of a bought head that nobody weighed, if it states none: that of the bore
    /// that it names. [`PumpFile::parse`] has done so.
    #[must_use]
    pub fn with_assumptions(mut self) -> Self {
        if let Some(head) = self.head.as_ref().filter(|_| self.uncertainty.is_assumed()) {
            self.uncertainty = UncertaintyTable::of_bought(head.tube_bore_mm);
        }
        self
    }

    /// Returns the file as TOML.
    pub fn to_toml(&self) -> String {
        let text = toml::to_string(self)
            .unwrap_or_else(|error| unreachable!("a pump file is plain tables: {error}"));
        match &self.drive {
            // The pins of such a board say which motor turns, and it has no axes.
            Some(drive) if drive.driver == DriverName::Klipper => text.replacen("\naxis = \"X\"\n", "\n", 1),
            _ => text,
        }
    }

    /// Returns the dimensions of the pump head. A dimension that is not known is 0, and the model refuses it.
    fn geometry(&self) -> Geometry {
        let known = Option::unwrap_or_default;
        let backplate = self.backplate.as_ref();
        let contact_angle_deg = backplate.map(|backplate| backplate.contact_angle_deg);
        Geometry {
            rollers: self.rollers.count,
            bore_radius_mm: known(self.tube.bore_radius_mm),
            tube_outer_radius_mm: known(self.tube.outer_radius_mm),
            backplate_radius_mm: known(backplate.map(|backplate| backplate.radius_mm)),
            contact_angle_rad: radians(known(contact_angle_deg)),
            roller_radius_mm: known(self.rollers.radius_mm),
            roller_offset_mm: known(self.rollers.offset_mm),
        }
    }

    /// Returns the pump that the file describes, without the law of its displacement.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of dimensions, a roller volume, a fluid or a line that cannot work.
    pub fn model(&self) -> Result<Pump, ModelError> {
        let line = |table: &LineTable, port| {
            table.line(|| self.fluid.fluid(), self.pump.default_rate_ml_s, self.reservoir_kpa(port))
        };
        let (inlet, outlet) = (line(&self.inlet, Port::Inlet)?, line(&self.outlet.line, Port::Outlet)?);
        if let Some(head) = &self.head {
            let rollers = self.rollers.count;
            return Pump::from_ml_per_rev(
                head.ml_per_rev,
                rollers,
                PulsePrior::of(rollers).pulse(),
                inlet,
                outlet,
            );
        }
        let (rollers, geometry) = (self.rollers.count, self.geometry());
        let table = self.roller_volume.as_ref().ok_or(ModelError::DimensionsUnknown { rollers })?;
        Pump::new(geometry, table.curve(&geometry)?, inlet, outlet)
    }

    /// Returns the pressure at the end of a port's line, in kPa absolute.
    pub(crate) fn reservoir_kpa(&self, port: Port) -> f64 {
        let (table, side) = match port {
            Port::Inlet => (&self.inlet, Side::Inlet),
            Port::Outlet => (&self.outlet.line, Side::Outlet),
        };
        table.reservoir.pressure_kpa(side, self.fluid.density_kg_m3, self.ambient.pressure_kpa)
    }

    /// Returns the heights of the lines that state an absolute pressure, in mm, suction first: those of the columns of
    /// the file's fluid in its air. `None` for a line that states its height.
    pub(crate) fn heights_of_pressures_mm(&self) -> [Option<f64>; 2] {
        [(&self.inlet, Side::Inlet), (&self.outlet.line, Side::Outlet)].map(|(table, side)| {
            let (density_kg_m3, ambient_kpa) = (self.fluid.density_kg_m3, self.ambient.pressure_kpa);
            table.reservoir.column_mm(side, density_kg_m3, ambient_kpa)
        })
    }

    /// Returns the default pulse of a head that is known by its volume alone, or `None` for a head that is drawn.
    pub(crate) fn pulse_prior(&self) -> Option<PulsePrior> {
        self.head.as_ref().map(|_| PulsePrior::of(self.rollers.count))
    }

    /// Returns the law by which the volume of a revolution depends on the speed, or `None` if every speed has
    /// the same volume.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of dimensions from which no closure angle follows.
    pub fn displacement_law(&self) -> Result<Option<DisplacementLaw>, ModelError> {
        self.speed_law.law(&self.geometry(), self.ambient.pressure_kpa)
    }

    /// Returns the standard uncertainty of the volumes by the law, as a part of them, or `None` without a
    /// law.
    pub(crate) fn law_standard(&self) -> Option<f64> {
        self.speed_law.standard()
    }

    /// Returns the speed law whose s and D a calibration seeks, with theta_c and P_atm of this pump.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of dimensions from which no closure angle follows.
    pub(crate) fn speed_law_to_fit(&self) -> Result<SpeedLaw, ModelError> {
        self.speed_law.law_to_fit(&self.geometry(), self.ambient.pressure_kpa)
    }

    /// Returns the pump that the file describes, with the law of its displacement if it has one.
    ///
    /// # Errors
    /// Errors of [`PumpFile::model`] and [`PumpFile::displacement_law`].
    pub fn speed_dependent_pump(&self) -> Result<SpeedDependentPump, ModelError> {
        Ok(SpeedDependentPump::new(self.model()?, self.displacement_law()?))
    }

    /// Returns the standard uncertainty of a volume that was not weighed, as a part of it.
    pub(crate) fn model_standard(&self) -> f64 {
        self.law_standard().unwrap_or(self.uncertainty.unweighed())
    }

    /// Returns the friction in the hoses of inlet and outlet. It is `None` where the file gives a line by its
    /// R.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a hose or a fluid that is out of range.
    pub fn frictions(&self) -> Result<[Option<Friction>; 2], ModelError> {
        let friction = |table: &LineTable| table.friction(|| self.fluid.fluid());
        Ok([friction(&self.inlet)?, friction(&self.outlet.line)?])
    }

    /// Returns true if volumes follow from a drawing or from a volume per revolution that nobody has compared with
    /// the pump.
    pub fn is_estimated(&self) -> bool {
        self.head.is_some() || self.roller_volume.as_ref().is_some_and(RollerVolumeTable::is_estimated)
    }

    /// Returns the driver that turns the motor unless another driver is named.
    pub fn driver(&self) -> DriverName {
        self.drive.as_ref().map_or(DriverName::Sim, |drive| drive.driver)
    }
}
