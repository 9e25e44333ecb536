//! A bench: one pump, what turns it, and its record; doses are prepared, run and recorded here.

use std::path::Path;

use pump_ctl::plan::{Cruise, Limits, Phase, Plan, PlanError, Prediction, Request, plan};
use pump_model::Pump;
use pump_model::integrator::IntegrationError;
use serde::Serialize;
use thiserror::Error;

use crate::pump_file::{DriverName, PumpFile, PumpFileError};
use crate::record::{Folder, Lock, Record, RecordError};
use crate::sim::Sim;
use crate::uncertainty::Budget;

/// The simulated vessel is read after this many settling times: the prediction holds for a smooth motion, and the last
/// microlitre arrives a little sooner or later in steps.
const WEIGHED_AFTER: f64 = 2.0;

/// A pump with its driver and the folder of its record.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    file: PumpFile,
    model: Pump,
    driver: DriverName,
    folder: Folder,
}

/// Why the pump is to turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A dose into the vessel; earlier doses' carry is settled with it.
    Dose,
    /// Filling the line before a dose; owes nothing and repays nothing.
    Prime,
    /// Emptying the line; owes nothing and repays nothing.
    Purge,
}

/// What is asked of a bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoseRequest {
    /// Why.
    pub purpose: Purpose,
    /// mL; negative in reverse; not zero.
    pub volume_ml: f64,
    /// How fast; none takes the pump file's default rate.
    pub cruise: Option<Cruise>,
    /// Where the rollers stand, rad; none takes the recorded angle.
    pub start_angle_rad: Option<f64>,
    /// Limit at the port that pushes, kPa absolute; none takes the pump file's.
    pub max_outlet_kpa: Option<f64>,
    /// Limit at the port that sucks, kPa absolute; none takes the pump file's.
    pub min_inlet_kpa: Option<f64>,
}

impl DoseRequest {
    /// A dose with the pump file's defaults.
    pub fn dose(volume_ml: f64) -> Self {
        Self {
            purpose: Purpose::Dose,
            volume_ml,
            cruise: None,
            start_angle_rad: None,
            max_outlet_kpa: None,
            min_inlet_kpa: None,
        }
    }
}

/// Where the start angle comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PhaseSource {
    /// A fresh simulated pump stands at 0 deg.
    Home,
    /// The record of earlier motion.
    Recorded,
    /// The request.
    Given,
}

/// A dose that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// What was asked.
    pub request: DoseRequest,
    /// Steps and profile.
    pub plan: Plan,
    /// Pressures and settling.
    pub prediction: Prediction,
    /// How sure the volume is.
    pub budget: Budget,
    /// What it was planned within.
    pub limits: Limits,
    /// Where the start angle comes from.
    pub phase_source: PhaseSource,
    /// The carry on record, mL; a prime or purge leaves it.
    pub recorded_carry_ml: f64,
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
        // A damaged record stands in the way of nothing that does not need it.
        let record = match (self.folder.read(), request.start_angle_rad) {
            (Err(RecordError::Damaged { .. }), Some(_)) => None,
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
        let recorded_carry_ml = record.map_or(0.0, |record| record.carry_ml);
        let carry_in_ml = if request.purpose == Purpose::Dose { recorded_carry_ml } else { 0.0 };
        let default_cruise = Cruise::Flow { ml_s: self.file.pump.default_rate_ml_s };
        let planned = Request {
            volume_ml: request.volume_ml,
            carry_in_ml,
            cruise: request.cruise.unwrap_or(default_cruise),
        };
        let mut limits = self.file.limits();
        limits.max_outlet_kpa = request.max_outlet_kpa.or(limits.max_outlet_kpa);
        limits.min_inlet_kpa = request.min_inlet_kpa.or(limits.min_inlet_kpa);

        let plan = plan(&self.model, start, &planned, &limits)?;
        let prediction = plan.predict(&self.model)?;
        let budget = Budget::new(&self.model, &plan, &self.file.uncertainty);
        Ok(Prepared { request, plan, prediction, budget, limits, phase_source, recorded_carry_ml })
    }

    /// Takes the pump for this process.
    pub fn lock(&self) -> Result<Lock, DoseError> {
        Ok(self.folder.lock()?)
    }

    /// Runs a prepared dose and records where the rollers stand and what is owed. Returns what was delivered, mL.
    /// `progress` is told now and then how many steps are done.
    pub fn run(&self, lock: &Lock, prepared: &Prepared, progress: impl FnMut(u64)) -> Result<f64, DoseError> {
        let plan = &prepared.plan;
        let delivered_ml = match self.driver {
            DriverName::Sim => Sim::new(&self.model)
                .run(plan, WEIGHED_AFTER * prepared.prediction.settle_s, progress)
                .map_err(DoseError::Drive)?,
        };
        let carry_ml = match prepared.request.purpose {
            Purpose::Dose => plan.carry_ml,
            Purpose::Prime | Purpose::Purge => prepared.recorded_carry_ml,
        };
        let record = Record::new(plan.end_angle_rad(), plan.start.half_width_rad, carry_ml);
        lock.write(&record).map_err(|source| DoseError::NotRecorded {
            delivered_ml,
            end_angle_deg: pump_model::math::degrees(record.angle_rad),
            source,
        })?;
        Ok(delivered_ml)
    }
}
