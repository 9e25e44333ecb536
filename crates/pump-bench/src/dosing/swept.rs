//! The turn whose volume an uncertainty budget is of.

use pump_ctl::plan::{FlowMotion, Phase, Plan, PlannedMotion};
use pump_model::Pump;

/// The turn whose volume an uncertainty budget is of: a plan, or the part of it that was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Swept {
    /// Angle of the rollers at the start.
    pub(crate) start: Phase,
    /// Angle at the end, in rad, counted on from the start angle.
    pub(crate) end_rad: f64,
    /// Volume, in mL.
    pub(crate) volume_ml: f64,
    /// Smallest and largest volume over the angles at which the rollers may stand, in mL.
    pub(crate) range_ml: (f64, f64),
    /// Volume of the last step, in mL.
    pub(crate) end_step_ml: f64,
    /// Carry of earlier doses, in mL.
    pub(crate) carry_in_ml: f64,
}

impl Swept {
    /// Returns the turn of the whole plan.
    pub(crate) fn whole(pump: &Pump, plan: &Plan) -> Self {
        Self {
            start: plan.start(),
            end_rad: plan.end_angle_rad(),
            volume_ml: plan.planned_ml(),
            range_ml: (plan.least_ml(), plan.most_ml()),
            end_step_ml: plan.end_step_ml(pump),
            carry_in_ml: plan.carry_in_ml(),
        }
    }

    /// Returns the turn of the first `made` steps of a flow over time, whose start angle is known.
    pub(crate) fn flow(pump: &Pump, flow: &FlowMotion<'_>, made: u64) -> Self {
        let volume_ml = PlannedMotion::Flow(flow).delivered_ml(pump, made);
        let end_rad = flow.angle_after(made);
        Self {
            start: flow.start(),
            end_rad,
            volume_ml,
            range_ml: (volume_ml, volume_ml),
            end_step_ml: pump.outlet_curve().flow_ml_rad(end_rad).abs() * flow.step_rad(),
            carry_in_ml: 0.0,
        }
    }

    /// Returns the turn of the first `made` steps of the plan.
    pub(crate) fn part(pump: &Pump, plan: &Plan, made: u64) -> Self {
        let end_rad = plan.angle_after(made);
        Self {
            end_rad,
            volume_ml: plan.delivered_ml(pump, made),
            range_ml: plan.range_ml(pump, made),
            end_step_ml: pump.outlet_curve().flow_ml_rad(end_rad).abs() * plan.step_rad(),
            ..Self::whole(pump, plan)
        }
    }
}
