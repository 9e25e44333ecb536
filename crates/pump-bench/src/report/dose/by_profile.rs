//! The report of a run that follows a flow over time.

use pump_ctl::plan::LimitedBy;
use pump_model::units::{degrees, rpm};

use super::{DoseReport, RunReport};
use crate::bench::{Bench, Delivered, PreparedProfile};
use crate::calibration::Weighing;
use crate::dosing::{RippleAt, RippleReport, Swept};

impl DoseReport {
    /// Reports a run that followed a flow over time, or a dry run of one.
    pub fn by_profile(bench: &Bench, prepared: &PreparedProfile, delivered: Option<&Delivered>) -> Self {
        let (whole, flow) = (&prepared.whole, prepared.motion());
        let (all, file) = (flow.steps().unsigned_abs(), bench.file());
        let made = delivered.map_or(all, |delivered| delivered.made);
        let part = Swept::flow(&whole.model, &flow, made);
        let backflow_ml = whole.backflow_in_ml((&flow).into(), made);
        let budget = whole.budget(file, &part, backflow_ml.unwrap_or(whole.back_flow.backflow_ml));
        let has_outlet = !file.outlet.line.is_unknown();
        let of_outlet = |value: f64| has_outlet.then_some(value);
        let planned_ml = prepared.planned_ml();
        let volume_ml = delivered.map_or(planned_ml, |delivered| delivered.volume_ml);
        let report = Self::new(bench, whole, delivered);
        let told_ml = |end: &Delivered| if report.phase.is_stated() { end.volume_ml } else { part.volume_ml };
        let delivered_ml = delivered.map(told_ml);
        let even = RippleReport { peak_to_peak: 0.0, rms: 0.0 };
        Self {
            planned_ml,
            requested_ml: flow.volume_ml(),
            volume_least_ml: part.range_ml.0,
            volume_most_ml: part.range_ml.1,
            delivered_ml,
            booked_ml: part.volume_ml,
            balance_g: Weighing::of(file).reading_g(volume_ml),
            expanded_uncertainty_ml: budget.expanded_ml(),
            uncertainty_budget: budget.shares,
            end_angle_deg: degrees(flow.angle_after(made)),
            steps: flow.steps(),
            steps_made: delivered.map(|end| end.made as i64 * flow.steps().signum()),
            peak_speed_rpm: rpm(flow.pace().peak_rad_s),
            mean_flow_ml_s: planned_ml.abs() / flow.duration_s(),
            motion_s: flow.duration_s(),
            settle_s: of_outlet(whole.settle_in_s((&flow).into(), made)),
            backflow_ml: backflow_ml.and_then(of_outlet),
            reverse_flow_ml: Some(whole.back_flow.reverse_flow_ml)
                .filter(|_| made == all)
                .and_then(of_outlet),
            limited_by: LimitedBy::Nothing,
            // The rollers follow the rows, so that what departs from their mean is what was asked for.
            ripple_after: even,
            ripple_at_rollers: RippleAt { planned: even, ..report.ripple_at_rollers },
            ripple_at_line_end: None,
            run: Some(RunReport::of_profile(prepared, delivered, delivered_ml)),
            ..report
        }
    }
}
