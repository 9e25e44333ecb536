//! The part of a dose that was made, or all of a dry run, with its retraction.

use pump_model::Extremes;

use crate::bench::Delivered;
use crate::dosing::{Prepared, RunEnd, Swept};
use crate::notice::Notice;

use super::phase::PhaseReport;

/// A dose with its retraction: predicted pressures, kPa absolute, and the angle at its end, planned or made.
pub(in crate::report) struct WholeDose {
    pub(in crate::report) inlet: Extremes,
    pub(in crate::report) outlet: Extremes,
    pub(in crate::report) end_rad: f64,
}

impl WholeDose {
    pub(in crate::report) fn of(prepared: &Prepared, delivered: Option<&Delivered>) -> Self {
        let Prepared { prediction, plan, .. } = prepared;
        let (mut inlet, mut outlet, mut end_rad) =
            (prediction.inlet, prediction.outlet, plan.end_angle_rad());
        if let Some(back) = &prepared.retraction {
            (inlet, outlet) = (inlet.and(back.prediction.inlet), outlet.and(back.prediction.outlet));
            end_rad = back.plan.end_angle_rad();
        }
        Self { inlet, outlet, end_rad: delivered.map_or(end_rad, |delivered| delivered.end_angle_rad) }
    }
}

/// The part of the plan that was made: a dose that was stopped is as unsure as that part.
pub(in crate::report) fn part_made(prepared: &Prepared, delivered: Option<&Delivered>) -> Swept {
    let (model, plan) = (&prepared.model, &prepared.plan);
    match delivered.filter(|delivered| !delivered.completed) {
        Some(delivered) => Swept::part(model, plan, delivered.made),
        None => Swept::whole(model, plan),
    }
}

/// The volume of a dose that was made, mL. From an angle that is not known it is what the log books: a simulated vessel
/// knows more, and does not tell.
pub(in crate::report) fn told_ml(prepared: &Prepared, delivered: &Delivered) -> f64 {
    if PhaseReport::of(prepared).is_stated() {
        delivered.volume_ml
    } else {
        part_made(prepared, Some(delivered)).volume_ml
    }
}

/// True for a run until it is stopped that somebody stopped: it is complete.
pub(in crate::report) fn is_ended_run(prepared: &Prepared, delivered: &Delivered) -> bool {
    prepared.request.end == RunEnd::Stop && !delivered.unfinished
}

/// The warnings of the plan, then those of the motion.
pub(in crate::report) fn warnings(prepared: &Prepared, delivered: Option<&Delivered>) -> Vec<Notice> {
    let after = delivered.map_or(&[][..], |delivered| &delivered.warnings);
    [&prepared.warnings, after].concat()
}

/// The volume that is sucked back, or was, mL.
pub(in crate::report) fn retraction_ml(prepared: &Prepared, delivered: Option<&Delivered>) -> Option<f64> {
    let back = prepared.retraction.as_ref()?;
    Some(delivered.map_or(-back.plan.planned_ml(), |delivered| delivered.retracted_ml))
}

/// The steps of the retraction, planned or made.
pub(in crate::report) fn retract_steps(prepared: &Prepared, delivered: Option<&Delivered>) -> Option<i64> {
    let back = &prepared.retraction.as_ref()?.plan;
    let Some(delivered) = delivered else { return Some(back.steps()) };
    let turned_rad = delivered.end_angle_rad - back.start().angle_rad();
    let steps = (turned_rad / back.step_rad()).round() as i64;
    Some(if delivered.completed { steps.clamp(back.steps(), 0) } else { 0 })
}

/// The back flow of a dose, mL, and the reverse flow unless the dose was stopped on its way, mL.
pub(in crate::report) fn back_flow_ml(
    prepared: &Prepared,
    delivered: Option<&Delivered>,
) -> (Option<f64>, Option<f64>) {
    let (all, made) = (prepared.plan.steps().unsigned_abs(), made(prepared, delivered));
    (prepared.backflow_of_ml(made), (made == all).then_some(prepared.back_flow.reverse_flow_ml))
}

/// The number of the steps that were made, or of all of a dry run.
pub(in crate::report) fn made(prepared: &Prepared, delivered: Option<&Delivered>) -> u64 {
    delivered.map_or(prepared.plan.steps().unsigned_abs(), |delivered| delivered.made)
}

/// The carry to the next dose, mL: the planned one on a dry run, or that on record.
pub(in crate::report) fn carry_ml(prepared: &Prepared, delivered: Option<&Delivered>) -> f64 {
    delivered.map_or(prepared.owes_ml(), |delivered| delivered.carry_ml)
}
