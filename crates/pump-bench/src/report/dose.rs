//! What a dose reports to programs: one JSON object. `report_text.rs` is the same for people.

use pump_ctl::plan::{Finish, LimitedBy, SetBy};
use pump_model::Ripple;
use pump_model::math::{degrees, rpm};
use serde::Serialize;

use crate::bench::Bench;
use crate::bench::Delivered;
use crate::calibration::Made;
use crate::dosing::Prepared;
use crate::dosing::{Budget, Share};
use crate::pump_file::{DriverName, PumpFile};
use crate::record::PhaseSource;

/// A dose, planned or done (`schema` `dose/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DoseReport {
    /// `dose/1`.
    pub schema: &'static str,
    /// Pump id.
    pub pump: String,
    /// Driver.
    pub driver: &'static str,
    /// Whether no motor moved.
    pub simulated: bool,
    /// Where the motor is connected; null if it is simulated.
    pub device: Option<String>,
    /// `dose`, `prime`, `purge` or `calibrate`.
    pub purpose: &'static str,
    /// Volume asked for, mL.
    pub requested_ml: f64,
    /// What earlier doses owed, mL.
    pub carry_in_ml: f64,
    /// Model volume of the planned steps after settling, mL; the middle of the two that follow.
    pub planned_ml: f64,
    /// Smallest model volume of the planned steps from an angle at which the rollers may stand, mL.
    pub volume_least_ml: f64,
    /// Largest such volume, mL; both are `planned_ml` if the angle is known exactly.
    pub volume_most_ml: f64,
    /// What the vessel received, mL; null on a dry run.
    pub delivered_ml: Option<f64>,
    /// `model`: from the model alone; `estimated`: from the model of a drawing; `calibrated`: from what was weighed.
    pub volume_basis: &'static str,
    /// The calibration that was used; null if there was none.
    pub calibration: Option<CalibrationReport>,
    /// Volumes are the model's times this at the dose's cruise speed by the pump file's speed law; null if that is off or a
    /// calibration takes its place.
    pub speed_law_factor: Option<f64>,
    /// Expanded uncertainty (k = 2), mL.
    pub expanded_uncertainty_ml: f64,
    /// Its shares.
    pub uncertainty_budget: Vec<Share>,
    /// How the start angle is known.
    pub phase: PhaseReport,
    /// Angle at the start, deg; like the end, the middle of what may be.
    pub start_angle_deg: f64,
    /// Angle at the end, the retraction included, deg, counted on from the start.
    pub end_angle_deg: f64,
    /// Planned motor steps; negative in reverse.
    pub steps: i64,
    /// Steps made; null on a dry run.
    pub steps_made: Option<i64>,
    /// Steps per revolution of the pump head.
    pub steps_per_rev: f64,
    /// What is sucked back after the dose, mL: of a dose that was run, what was; null if it was not asked for.
    pub retraction_ml: Option<f64>,
    /// Where in a pitch the dose may end: `any` or `low-flow`.
    pub finish: &'static str,
    /// What the next dose owes, mL: requested + carry in - planned; after a prime or purge, what was owed before.
    pub carry_ml: f64,
    /// Speed while cruising, r/min; of a smooth flow its mean over time.
    pub cruise_speed_rpm: f64,
    /// Fastest speed, r/min.
    pub peak_speed_rpm: f64,
    /// Mean flow while cruising, mL/s.
    pub cruise_flow_ml_s: f64,
    /// Planned volume over the time of motion, mL/s.
    pub mean_flow_ml_s: f64,
    /// Time from the start to the last step, s.
    pub motion_s: f64,
    /// Time from the last step until less than 1 uL is undelivered, s.
    pub settle_s: f64,
    /// Smallest predicted inlet pressure, kPa absolute.
    pub inlet_min_kpa: f64,
    /// Largest.
    pub inlet_max_kpa: f64,
    /// Smallest predicted outlet pressure, kPa absolute.
    pub outlet_min_kpa: f64,
    /// Largest.
    pub outlet_max_kpa: f64,
    /// Ambient pressure, kPa absolute.
    pub ambient_kpa: f64,
    /// Largest torque that the motor needs compared with what it has at that speed, N m at the pump head; null if nothing is known
    /// of the torque.
    pub torque_needed_n_m: Option<f64>,
    /// What it has there, N m.
    pub torque_available_n_m: Option<f64>,
    /// Ripple of the flow at the outlet's rollers while cruising, at constant speed.
    pub ripple_before: RippleReport,
    /// The same as planned: less with a smooth flow.
    pub ripple_after: RippleReport,
    /// What keeps the dose from being faster.
    pub limited_by: &'static str,
    /// Smallest pressure that is allowed at the port that sucks, kPa absolute; null if none is known.
    pub inlet_limit_kpa: Option<f64>,
    /// What it is: `given`, `tube_collapse` or `vapour_pressure`, the largest of those that are known.
    pub inlet_limit: Option<&'static str>,
    /// Limits for which no value is known, so that nobody checked them.
    pub limits_not_checked: Vec<&'static str>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Whether the dose was delivered in full.
    pub completed: bool,
}

/// How far a flow departs from its mean over time, over the mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RippleReport {
    /// (largest - smallest) / mean.
    pub peak_to_peak: f64,
    /// Root of the mean square deviation, over the mean.
    pub rms: f64,
}

impl From<Ripple> for RippleReport {
    fn from(ripple: Ripple) -> Self {
        Self { peak_to_peak: ripple.peak_to_peak, rms: ripple.rms }
    }
}

/// The calibration of a dose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationReport {
    /// Its number.
    pub version: u32,
    /// When it was made, UTC.
    pub date: String,
    /// Volumes are the model's times this, at the dose's cruise speed.
    pub displacement_factor: f64,
    /// Model angle of the rollers where the record says 0, deg.
    pub zero_deg: f64,
}

/// How the start angle is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PhaseReport {
    /// Whether it is known at all.
    pub known: bool,
    /// Where it comes from.
    pub source: PhaseSource,
    /// How far off it may be, deg.
    pub half_width_deg: f64,
}

impl DoseReport {
    /// Report of a prepared dose that was run, or of a dry run.
    pub fn new(bench: &Bench, prepared: &Prepared, delivered: Option<&Delivered>) -> Self {
        let device = bench.drive().port.as_ref().map(|port| port.display().to_string());
        Self { device, ..Self::without_bench(bench.file(), bench.driver(), prepared, delivered) }
    }

    /// The same of a dose that was planned without a bench, so without a record.
    pub fn without_bench(
        file: &PumpFile,
        driver: DriverName,
        prepared: &Prepared,
        delivered: Option<&Delivered>,
    ) -> Self {
        let (model, plan, prediction) = (&prepared.model, &prepared.plan, &prepared.prediction);
        let applied = prepared.applied.as_ref();
        let (mut inlet, mut outlet, mut planned_end_rad) =
            (prediction.inlet, prediction.outlet, plan.end_angle_rad());
        if let Some(back) = &prepared.retraction {
            (inlet, outlet) = (inlet.and(back.prediction.inlet), outlet.and(back.prediction.outlet));
            planned_end_rad = back.plan.end_angle_rad();
        }
        let motion_s = plan.profile.duration_s();
        // A dose that was stopped is as unsure as the part that was made.
        let mut part = *plan;
        if let Some(delivered) = delivered.filter(|delivered| !delivered.completed) {
            part.steps = delivered.made as i64 * plan.steps.signum();
            (part.least_ml, part.most_ml) = plan.range_ml(model, delivered.made);
            part.planned_ml = plan.delivered_ml(model, delivered.made);
        }
        let budget = Budget::new(model, &part, &file.uncertainty, applied);
        let limits = &prepared.limits;
        let lowest = limits.lowest_where_it_sucks();
        let ripples = plan.ripples(model);
        Self {
            schema: "dose/1",
            pump: file.pump.id.clone(),
            driver: driver.as_str(),
            simulated: driver == DriverName::Sim,
            device: None,
            purpose: prepared.request.purpose.as_str(),
            requested_ml: plan.requested_ml,
            carry_in_ml: plan.carry_in_ml,
            planned_ml: plan.planned_ml,
            volume_least_ml: part.least_ml,
            volume_most_ml: part.most_ml,
            delivered_ml: delivered.map(|delivered| delivered.volume_ml),
            volume_basis: match applied.and_then(|applied| applied.sureness()) {
                Some(_) => "calibrated",
                None if file.is_estimated() => "estimated",
                None => "model",
            },
            calibration: applied.and_then(|applied| {
                let Made { version, date } = applied.calibration.clone()?;
                Some(CalibrationReport {
                    version,
                    date,
                    displacement_factor: applied.correction.factor,
                    zero_deg: degrees(applied.correction.zero_rad),
                })
            }),
            speed_law_factor: applied
                .and_then(|applied| applied.speed_law().map(|_| applied.correction.factor)),
            expanded_uncertainty_ml: budget.expanded_ml(),
            uncertainty_budget: budget.shares,
            phase: PhaseReport {
                known: plan.start.is_known(model.pitch_rad()),
                source: prepared.phase_source,
                half_width_deg: degrees(plan.start.half_width_rad),
            },
            start_angle_deg: degrees(plan.start.angle_rad),
            end_angle_deg: degrees(delivered.map_or(planned_end_rad, |delivered| delivered.end_angle_rad)),
            steps: plan.steps,
            steps_made: delivered.map(|delivered| delivered.made as i64 * plan.steps.signum()),
            steps_per_rev: plan.steps_per_rev,
            retraction_ml: prepared
                .retraction
                .as_ref()
                .map(|back| delivered.map_or(-back.plan.planned_ml, |delivered| delivered.retracted_ml)),
            finish: match plan.finish {
                Finish::Any => "any",
                Finish::LowFlow => "low-flow",
            },
            carry_ml: delivered
                .map_or(prepared.owes_ml(), |delivered| prepared.carry_out_ml + delivered.retracted_ml),
            cruise_speed_rpm: rpm(plan.profile.cruise_rad_s()),
            peak_speed_rpm: rpm(plan.profile.peak_rad_s()),
            cruise_flow_ml_s: plan.cruise_flow_ml_s(model),
            mean_flow_ml_s: plan.planned_ml.abs() / motion_s,
            motion_s,
            settle_s: prediction.settle_s,
            inlet_min_kpa: inlet.min_kpa,
            inlet_max_kpa: inlet.max_kpa,
            outlet_min_kpa: outlet.min_kpa,
            outlet_max_kpa: outlet.max_kpa,
            ambient_kpa: file.ambient.pressure_kpa,
            torque_needed_n_m: prepared.margins.torque.map(|torque| torque.reached),
            torque_available_n_m: prepared.margins.torque.map(|torque| torque.limit),
            ripple_before: ripples.before.into(),
            ripple_after: ripples.after.into(),
            limited_by: match plan.limited_by {
                LimitedBy::Nothing => "none",
                LimitedBy::Acceleration => "acceleration",
                LimitedBy::Speed => "speed",
                LimitedBy::OutletPressure | LimitedBy::OutletSuction => "outlet_pressure",
                LimitedBy::InletPressure => "inlet_pressure",
                LimitedBy::Torque => "torque",
            },
            inlet_limit_kpa: lowest.map(|lowest| lowest.kpa),
            inlet_limit: lowest.map(|lowest| match lowest.set_by {
                SetBy::Given => "given",
                SetBy::TubeCollapse => "tube_collapse",
                SetBy::Vapour => "vapour_pressure",
            }),
            limits_not_checked: file.not_checked(limits),
            warnings: prepared.warnings.clone(),
            completed: delivered.is_some_and(|delivered| delivered.completed),
        }
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
    }
}
