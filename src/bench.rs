//! A bench: one pump, what turns it, and its record; doses are prepared, run and recorded here.

use std::path::Path;

use pump_ctl::plan::{Phase, PlanError};
use pump_model::Pump;
use pump_model::integrator::IntegrationError;
use pump_model::math::degrees;
use thiserror::Error;

use crate::dose::{DoseRequest, PhaseSource, Prepared};
use crate::drivers::Sim;
use crate::pump_file::{DriverName, PumpFile, PumpFileError};
use crate::record::{Folder, Lock, Record, RecordError};

/// A pump with its driver and the folder of its record.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    file: PumpFile,
    model: Pump,
    driver: DriverName,
    folder: Folder,
}

/// A dose that was refused or failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DoseError {
    /// The pump file cannot be used.
    #[error(transparent)]
    PumpFile(#[from] PumpFileError),
    /// The dose cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The record cannot be used; nothing has moved.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The drive failed on the way.
    #[error("the simulated drive failed: {0}; its record still says where it stood before")]
    Drive(IntegrationError),
    /// The dose is done but could not be recorded.
    #[error(
        "{delivered_ml:.4} mL were delivered and the rotor stands at {end_angle_deg:.4} deg, but this could not be \
         recorded: {source}; start the next dose with --start-angle {end_angle_deg:.4}deg"
    )]
    NotRecorded {
        /// mL.
        delivered_ml: f64,
        /// deg.
        end_angle_deg: f64,
        /// Why.
        source: RecordError,
    },
}

impl Bench {
    /// A bench for the pump of `file` with the driver that it names, or `driver` instead. Creates nothing yet.
    pub fn new(file: PumpFile, driver: Option<DriverName>, state_dir: &Path) -> Result<Self, DoseError> {
        file.check(&file.pump.id)?;
        let model = file.model().map_err(PlanError::from)?;
        let driver = driver.unwrap_or(file.driver());
        let folder = Folder::new(state_dir, &file.pump.id, driver.as_str());
        Ok(Self { file, model, driver, folder })
    }

    /// The pump file.
    pub fn file(&self) -> &PumpFile {
        &self.file
    }

    /// The pump's model.
    pub fn model(&self) -> &Pump {
        &self.model
    }

    /// What turns the motor.
    pub fn driver(&self) -> DriverName {
        self.driver
    }

    /// Where its record is kept.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Plans a dose from the recorded angle and predicts it. Moves and writes nothing.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let mut warnings = Vec::new();
        // A damaged record stands in the way of nothing that does not need it.
        let record = match (self.folder.read(), request.start_angle_rad) {
            (Err(error @ RecordError::Damaged { .. }), Some(_)) => {
                warnings.push(format!("{error}; what earlier doses owed is lost and set to zero"));
                None
            }
            (record, _) => record?,
        };
        let (start, phase_source) = match (request.start_angle_rad, &record) {
            (Some(angle_rad), _) => (Phase::known(angle_rad), PhaseSource::Given),
            (None, Some(record)) => {
                let phase = Phase { angle_rad: record.angle_rad, half_width_rad: record.half_width_rad };
                (phase, PhaseSource::Recorded)
            }
            (None, None) => (Phase::known(0.0), PhaseSource::Home),
        };
        let carry_ml = record.map_or(0.0, |record| record.carry_ml);
        let mut prepared = Prepared::new(&self.file, &self.model, request, start, phase_source, carry_ml)?;
        prepared.warnings.splice(0..0, warnings);
        Ok(prepared)
    }

    /// Takes the pump for this process until the session is dropped.
    pub fn session(&self) -> Result<Session<'_>, DoseError> {
        Ok(Session { bench: self, lock: self.folder.lock()? })
    }
}

/// A bench that no other process can move meanwhile.
#[derive(Debug)]
pub struct Session<'a> {
    bench: &'a Bench,
    lock: Lock,
}

impl Session<'_> {
    /// Plans a dose from the recorded angle and predicts it. Moves nothing.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        self.bench.prepare(request)
    }

    /// Runs a dose that this session prepared and records where the rollers stand and what is owed. Returns what was
    /// delivered, mL. `progress` is told now and then how many steps are done.
    pub fn run(&self, prepared: &Prepared, progress: impl FnMut(u64)) -> Result<f64, DoseError> {
        let plan = &prepared.plan;
        let delivered_ml = match self.bench.driver {
            DriverName::Sim => {
                let mut sim = Sim::new(&self.bench.model);
                sim.run(plan, progress).and_then(|()| sim.settle()).map_err(DoseError::Drive)?;
                sim.received_ml()
            }
        };
        let record = Record::new(plan.end_angle_rad(), plan.start.half_width_rad, prepared.carry_out_ml);
        self.lock.write(&record).map_err(|source| DoseError::NotRecorded {
            delivered_ml,
            end_angle_deg: degrees(record.angle_rad),
            source,
        })?;
        Ok(delivered_ml)
    }
}
