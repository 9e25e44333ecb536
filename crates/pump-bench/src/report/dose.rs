//! The report of a dose, and its JSON for programs. `dose_text.rs` and `dose_details.rs` have its words for people.

mod by_profile;
mod by_weight;
mod calibration;
mod made;
mod phase;
mod run;

use pump_ctl::plan::{Finish, LimitedBy, SetBy};
use pump_model::units::{degrees, rpm};
use serde::Serialize;

pub use self::by_weight::ByWeightReport;
pub use self::calibration::CalibrationReport;
use self::made::{
    WholeDose, back_flow_ml, carry_ml, is_ended_run, made, part_made, retract_steps, retraction_ml, told_ml,
    warnings,
};
pub use self::phase::PhaseReport;
pub use self::run::{ProfileReport, RunReport, Until};
use super::choices::{VolumeBasis, finish_word, limit_word, set_by_word};
use crate::bench::{Bench, Delivered, DeliveredByWeight, PreparedByWeight};
use crate::calibration::{Applied, Weighing};
use crate::dosing::{
    Prepared, PulseErrors, RippleAt, RippleReport, Share, SureRipples, pressure_uncertainty_kpa,
    sure_ripples, weighed_shares,
};
use crate::drives::{Identity, registry};
use crate::notice::{Notice, Wording};
use crate::numbers::microlitres;
use crate::pump_file::{DriverName, PumpFile, UncheckedLimit};
use crate::record::{Purpose, ShortText, Stamp};

/// The report of a dose that was planned or made (`schema` `dose/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct DoseReport {
    /// `dose/1`.
    pub schema: &'static str,
    /// Id of the pump.
    pub pump: String,
    /// Name of the drive.
    pub driver: String,
    /// True if no motor moved.
    pub simulated: bool,
    /// Port to which the motor is connected; null if the motor is simulated.
    pub device: Option<String>,
    /// Reason why the pump turns: `dose`, `prime`, `purge`, `run`, `calibrate` or `retract`.
    pub purpose: Purpose,
    /// Time at which the dose began, RFC 3339 with the offset of the local clock; null on a dry run.
    pub time: Option<Stamp>,
    /// Volume as it was typed; null if a program gave a number.
    pub asked: Option<ShortText>,
    /// Volume that was asked for, mL.
    pub requested_ml: f64,
    /// Carry of earlier doses, mL, positive toward the outlet.
    pub carry_in_ml: f64,
    /// Model volume of the planned steps after the line has settled, mL. From an angle that is known to 2 deg or worse
    /// it is the part of this dose in the middle of all sums with the earlier doses.
    pub planned_ml: f64,
    /// Smallest model volume of the planned steps from an angle at which the rollers may stand, mL.
    pub volume_least_ml: f64,
    /// Largest model volume of the planned steps, mL; least and most are `planned_ml` if the angle is known exactly.
    pub volume_most_ml: f64,
    /// Volume that was delivered, mL: that of the steps made. A simulated vessel says what it received, if the angle
    /// at the start is known. Null on a dry run.
    pub delivered_ml: Option<f64>,
    /// Volume of the steps that were made, or that are planned, as the log books it, mL.
    #[serde(skip)]
    pub booked_ml: f64,
    /// Reading of a balance in air of `ambient_kpa` for the volume that the vessel received, from any angle, or that is
    /// planned on a dry run, g, at the pump file's temperature of the fluid; null if the density is not known there.
    pub balance_g: Option<f64>,
    /// Basis of the volume: the model, the model of a drawing, or the volumes that were weighed.
    pub volume_basis: VolumeBasis,
    /// Calibration that was used; null if there was none.
    pub calibration: Option<CalibrationReport>,
    /// Factor of the pump file's speed law on the model's volumes at the dose's cruise speed; null if the law is off or
    /// a calibration takes its place.
    pub speed_law_factor: Option<f64>,
    /// Expanded uncertainty, mL: 95.45 % of doses lie within it, k = 2 from an exact angle.
    pub expanded_uncertainty_ml: f64,
    /// Shares of the uncertainty.
    pub uncertainty_budget: Vec<Share>,
    /// Knowledge of the start angle.
    pub phase: PhaseReport,
    /// Angle of the rollers at the start, deg; the middle of the angles that may be.
    pub start_angle_deg: f64,
    /// Angle of the rollers at the end, the retraction included, deg, counted on from the start.
    pub end_angle_deg: f64,
    /// Planned motor steps; negative in reverse.
    pub steps: i64,
    /// Motor steps that were made; null on a dry run.
    pub steps_made: Option<i64>,
    /// Motor steps of the retraction, planned or made, negative; null if no retraction was asked for.
    pub retract_steps: Option<i64>,
    /// Steps per revolution of the pump head.
    pub steps_per_rev: f64,
    /// Volume that is sucked back after the dose, or was, mL; null if no retraction was asked for.
    pub retraction_ml: Option<f64>,
    /// True if the whole retraction was made; null if none was asked for, or on a dry run.
    pub retraction_completed: Option<bool>,
    /// Place in a pitch at which the dose may end: `any` or `low-flow`.
    #[serde(serialize_with = "finish_word")]
    pub finish: Finish,
    /// Carry to the next dose, mL: requested + carried over - planned; a prime or purge leaves the carry as it was.
    pub carry_ml: f64,
    /// Half width of the range around `carry_ml` that holds the true carry, mL; 0 if the carry is known exactly.
    pub carry_half_width_ml: f64,
    /// Speed of the pump head while cruising, r/min; the mean over time if the flow is smooth.
    pub cruise_speed_rpm: f64,
    /// Fastest speed of the pump head, r/min.
    pub peak_speed_rpm: f64,
    /// Mean flow while cruising, mL/s.
    pub cruise_flow_ml_s: f64,
    /// Planned volume over the time of motion, mL/s.
    pub mean_flow_ml_s: f64,
    /// Time from the start to the last step, s.
    pub motion_s: f64,
    /// Time from the start to the last step that was made, s, by the clock; null on a dry run. That of a simulated
    /// motor is the time of its plan, unless it keeps real time.
    pub measured_motion_s: Option<f64>,
    /// Time from the last step until less than 1 µL is undelivered, s; null if the outlet's line is not known. It is
    /// predicted, for a dose that was stopped early by its stop.
    pub settle_s: Option<f64>,
    /// Largest volume delivered less the final one, before any retraction, mL: the line swings at the stop. It is
    /// predicted, for a dose that was stopped early by its stop.
    pub backflow_ml: Option<f64>,
    /// All that the line takes back from the vessel on the way, before any retraction, mL; null if the dose was stopped
    /// early.
    pub reverse_flow_ml: Option<f64>,
    /// Smallest predicted inlet pressure, kPa absolute; null if the inlet's line is not known.
    pub inlet_min_kpa: Option<f64>,
    /// Largest predicted inlet pressure, kPa absolute; null if the inlet's line is not known.
    pub inlet_max_kpa: Option<f64>,
    /// Smallest predicted outlet pressure, kPa absolute; null if the outlet's line is not known.
    pub outlet_min_kpa: Option<f64>,
    /// Largest predicted outlet pressure, kPa absolute; null if the outlet's line is not known.
    pub outlet_max_kpa: Option<f64>,
    /// Expanded uncertainty (k = 2) of the predicted inlet pressures, kPa, by the correlation with measured pressures
    /// that McIntyre et al. state: 0.51 of the predicted swing.
    pub inlet_pressure_uncertainty_kpa: Option<f64>,
    /// Expanded uncertainty (k = 2) of the predicted outlet pressures, kPa, as that of the inlet's.
    pub outlet_pressure_uncertainty_kpa: Option<f64>,
    /// Ambient pressure, kPa absolute.
    pub ambient_kpa: f64,
    /// Torque that the motor needs where it comes closest to the torque that it has, N m at the pump head; null if
    /// nothing is known of the torque.
    pub torque_needed_n_m: Option<f64>,
    /// Torque that the motor has there, N m.
    pub torque_available_n_m: Option<f64>,
    /// Ripple of the flow at the outlet's rollers while cruising, at constant speed.
    pub ripple_before: RippleReport,
    /// Ripple of the planned flow at the outlet's rollers, if the pump is exactly as its model. `ripple_at_rollers` has
    /// the ripple that is expected of a pump that is not known so well.
    pub ripple_after: RippleReport,
    /// Ripple of the flow at the outlet's rollers while cruising, with its uncertainty.
    pub ripple_at_rollers: RippleAt,
    /// Ripple of the flow at the end of the outlet line, which the vessel sees, with its uncertainty; null at a
    /// resonance that nothing damps.
    pub ripple_at_line_end: Option<RippleAt>,
    /// Limit that keeps the dose from being faster: `none`, `speed`, `acceleration`, `torque`, or a pressure by its
    /// port. `inlet_pressure` and `outlet_pressure` are the largest pressures allowed there, `inlet_suction` and
    /// `outlet_suction` the smallest.
    #[serde(serialize_with = "limit_word")]
    pub limited_by: LimitedBy,
    /// Smallest pressure that is allowed at the suction port, kPa absolute; null if none is known. The suction port is
    /// the inlet, and the outlet in reverse.
    pub inlet_limit_kpa: Option<f64>,
    /// Origin of the smallest pressure at the suction port: `given`, or the larger of `tube_collapse` and
    /// `vapour_pressure`.
    #[serde(serialize_with = "set_by_word")]
    pub inlet_limit: Option<SetBy>,
    /// Limits for which no value is known, so that nobody checked them. Pressures have the names of the roles:
    /// `discharge_pressure` is the largest at the port that pushes, `suction_pressure` the smallest at the port that
    /// sucks.
    pub limits_not_checked: Vec<UncheckedLimit>,
    /// Warnings for the user.
    pub warnings: Vec<Notice>,
    /// True if the dose was delivered in full.
    pub completed: bool,
    /// Weighing of a dose that a balance ended. Any other dose has no such key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_weight: Option<ByWeightReport>,
    /// End and mean flow of a run of continuous flow, or of a prime or purge for a time. A volume that is dosed has no
    /// such key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<RunReport>,
}

impl DoseReport {
    /// Reports a prepared dose that was run, or a dry run.
    pub fn new(bench: &Bench, prepared: &Prepared, delivered: Option<&Delivered>) -> Self {
        let device = bench.drive().port.as_ref().map(|port| port.display().to_string());
        Self { device, ..Self::of(bench.file(), bench.identity(), prepared, delivered) }
    }

    /// Reports a dose that was planned without a bench, so without a record.
    pub fn without_bench(
        file: &PumpFile,
        driver: DriverName,
        prepared: &Prepared,
        delivered: Option<&Delivered>,
    ) -> Self {
        Self::of(file, &registry::identity(driver), prepared, delivered)
    }

    /// Returns the smallest and the largest volume that was delivered, in mL, over the angles at which the rollers may
    /// have stood. Both are 0 for a dry run.
    pub fn delivered_range_ml(&self) -> (f64, f64) {
        let Some(volume_ml) = self.delivered_ml else { return (0.0, 0.0) };
        if self.volume_least_ml == self.volume_most_ml {
            return (volume_ml, volume_ml);
        }
        (self.volume_least_ml.min(volume_ml), self.volume_most_ml.max(volume_ml))
    }

    #[allow(clippy::too_many_lines, reason = "a line for each field of the report")]
    fn of(file: &PumpFile, drive: &Identity, prepared: &Prepared, delivered: Option<&Delivered>) -> Self {
        let (model, plan, applied) = (&prepared.model, &prepared.plan, prepared.applied.as_ref());
        let (whole, part) = (WholeDose::of(prepared, delivered), part_made(prepared, delivered));
        let (backflow_ml, reverse_flow_ml) = back_flow_ml(prepared, delivered);
        let budget = prepared.budget(file, &part, backflow_ml.unwrap_or(prepared.back_flow.backflow_ml));
        let motion_s = plan.profile().duration_s();
        let SureRipples { rollers, line_end } = sure_ripples(plan, model, &PulseErrors::of(file, applied));
        let line_end = line_end.filter(|_| !file.outlet.line.is_unknown());
        let lowest = prepared.limits.lowest_where_it_sucks();
        let is_known = [!file.inlet.is_unknown(), !file.outlet.line.is_unknown()];
        let [of_inlet, of_outlet] = is_known.map(|is_known| move |value: f64| is_known.then_some(value));
        Self {
            schema: "dose/1",
            pump: file.pump.id.clone(),
            driver: drive.id.clone(),
            simulated: drive.is_simulated,
            device: None,
            purpose: prepared.request.purpose,
            time: delivered.map(|delivered| delivered.began),
            asked: prepared.request.asked,
            requested_ml: plan.requested_ml(),
            carry_in_ml: plan.carry_in_ml(),
            planned_ml: plan.planned_ml(),
            volume_least_ml: part.range_ml.0,
            volume_most_ml: part.range_ml.1,
            delivered_ml: delivered.map(|delivered| told_ml(prepared, delivered)),
            booked_ml: part.volume_ml,
            balance_g: Weighing::of(file)
                .reading_g(delivered.map_or(plan.planned_ml(), |delivered| delivered.volume_ml)),
            volume_basis: basis(file, applied),
            calibration: applied.and_then(CalibrationReport::of),
            speed_law_factor: applied.and_then(|by| by.law_standard().map(|_| by.correction.factor)),
            expanded_uncertainty_ml: budget.expanded_ml(),
            uncertainty_budget: budget.shares,
            phase: PhaseReport::of(prepared),
            start_angle_deg: degrees(plan.start().angle_rad()),
            end_angle_deg: degrees(whole.end_rad),
            steps: plan.steps(),
            steps_made: delivered.map(|end| end.made as i64 * plan.steps().signum()),
            retract_steps: retract_steps(prepared, delivered),
            steps_per_rev: plan.steps_per_rev(),
            retraction_ml: retraction_ml(prepared, delivered),
            retraction_completed: prepared.retraction.as_ref().and(delivered).map(|end| end.sucked_back),
            finish: plan.finish(),
            carry_ml: carry_ml(prepared, delivered),
            carry_half_width_ml: delivered
                .map_or(prepared.carry_within_ml(whole.end_rad), |delivered| delivered.carry_half_width_ml),
            cruise_speed_rpm: rpm(plan.profile().cruise_rad_s()),
            peak_speed_rpm: rpm(plan.profile().peak_rad_s()),
            cruise_flow_ml_s: plan.cruise_flow_ml_s(model),
            mean_flow_ml_s: plan.planned_ml().abs() / motion_s,
            motion_s,
            measured_motion_s: delivered.map(|delivered| delivered.measured_s),
            settle_s: of_outlet(prepared.settle_of_s(made(prepared, delivered))),
            backflow_ml: backflow_ml.and_then(of_outlet),
            reverse_flow_ml: reverse_flow_ml.and_then(of_outlet),
            inlet_min_kpa: of_inlet(whole.inlet.min_kpa),
            inlet_max_kpa: of_inlet(whole.inlet.max_kpa),
            outlet_min_kpa: of_outlet(whole.outlet.min_kpa),
            outlet_max_kpa: of_outlet(whole.outlet.max_kpa),
            inlet_pressure_uncertainty_kpa: of_inlet(pressure_uncertainty_kpa(whole.inlet)),
            outlet_pressure_uncertainty_kpa: of_outlet(pressure_uncertainty_kpa(whole.outlet)),
            ambient_kpa: file.ambient.pressure_kpa,
            torque_needed_n_m: prepared.margins.torque.map(|torque| torque.reached),
            torque_available_n_m: prepared.margins.torque.map(|torque| torque.limit),
            ripple_before: rollers.constant_speed,
            ripple_after: rollers.planned,
            ripple_at_rollers: rollers,
            ripple_at_line_end: line_end,
            limited_by: plan.limited_by(),
            inlet_limit_kpa: lowest.map(|lowest| lowest.kpa),
            inlet_limit: lowest.map(|lowest| lowest.set_by),
            limits_not_checked: file.not_checked(&prepared.limits),
            warnings: warnings(prepared, delivered),
            completed: delivered.is_some_and(|end| end.completed || is_ended_run(prepared, end)),
            by_weight: None,
            run: RunReport::of(prepared, delivered),
        }
    }

    /// The report whose warnings and shares of the uncertainty have their remedies in a front end's words.
    #[must_use]
    pub fn worded(mut self, words: Wording) -> Self {
        for notice in &mut self.warnings {
            *notice = notice.told(words);
        }
        for share in &mut self.uncertainty_budget {
            share.remedy = share.remedy.told(words);
        }
        self
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
    }
}

/// The basis of the volumes of a pump with what a calibration or a speed law changes of it.
fn basis(file: &PumpFile, applied: Option<&Applied>) -> VolumeBasis {
    match applied.and_then(|applied| applied.sureness()) {
        Some(_) => VolumeBasis::Calibrated,
        None if file.is_estimated() => VolumeBasis::Estimated,
        None => VolumeBasis::Model,
    }
}

impl DoseReport {
    /// Reports a dry run of a dose that a balance would end.
    pub fn planned_by_weight(bench: &Bench, prepared: &PreparedByWeight) -> Self {
        let mut report = Self::new(bench, &prepared.whole, None);
        let most_ml = prepared.most_ml;
        report.warnings.push(Notice::from(format!(
            "a balance would end this dose: the pump would turn for {most_ml:.4} mL at most"
        )));
        report
    }

    /// Reports a dose that a balance ended, or was to end. The difference of two of its readings has the standard
    /// uncertainty `difference_g`, in g.
    pub fn by_weight(
        bench: &Bench,
        prepared: &PreparedByWeight,
        delivered: &DeliveredByWeight,
        difference_g: f64,
    ) -> Self {
        let report = Self::new(bench, &prepared.whole, None);
        let mut warnings = report.warnings;
        warnings.extend(delivered.warnings.iter().cloned());
        if delivered.dropped_ml != 0.0 {
            let carry = microlitres(delivered.dropped_ml);
            warnings
                .push(Notice::from(format!("the carry of {carry} is dropped: the balance ended the dose")));
        }
        let part = Self {
            time: delivered.began,
            requested_ml: prepared.asked_ml(),
            carry_in_ml: 0.0,
            planned_ml: delivered.turned_ml,
            end_angle_deg: degrees(delivered.end_angle_rad),
            steps: delivered.made as i64,
            steps_made: Some(delivered.made as i64),
            carry_ml: 0.0,
            carry_half_width_ml: 0.0,
            motion_s: delivered.measured_s,
            measured_motion_s: Some(delivered.measured_s),
            warnings,
            completed: delivered.completed,
            by_weight: Some(ByWeightReport::of(prepared, delivered)),
            ..report
        };
        if !delivered.completed {
            // The balance was read in motion, and more still arrives. The model knows the steps, with the uncertainty
            // of what they deliver.
            // The part of an earlier command was weighed at rest.
            let before_turned_ml = prepared.begun.map_or(0.0, |begun| begun.turned_ml);
            let turned_ml = delivered.before_ml + delivered.turned_ml - before_turned_ml;
            let (volume_least_ml, volume_most_ml) = (turned_ml, turned_ml);
            let (booked_ml, delivered_ml) = (turned_ml, Some(turned_ml));
            let budget = prepared.whole.budget(bench.file(), &delivered.swept(prepared), 0.0);
            return Self {
                volume_least_ml,
                volume_most_ml,
                delivered_ml,
                booked_ml,
                expanded_uncertainty_ml: budget.expanded_ml(),
                uncertainty_budget: budget.shares,
                ..part
            };
        }
        let (file, volume_ml) = (bench.file(), delivered.volume_ml);
        let reading_ml = difference_g * prepared.z_ml_g;
        // The density was known when the dose was planned.
        let (uncertainty_budget, expanded_uncertainty_ml) =
            weighed_shares(file, volume_ml, reading_ml, prepared.whole.drop_ml).unwrap_or_default();
        Self {
            volume_least_ml: volume_ml,
            volume_most_ml: volume_ml,
            delivered_ml: Some(volume_ml),
            booked_ml: volume_ml,
            balance_g: Some(delivered.mass_g),
            volume_basis: VolumeBasis::Weighed,
            expanded_uncertainty_ml,
            uncertainty_budget,
            ..part
        }
    }
}
