//! Claims about a flow over time.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../reversing/heads.rs"]
#[allow(dead_code, reason = "the heads of another test")]
mod heads;
mod motions;
mod profiles;
mod refused;

use core::f64::consts::TAU;

use pump_ctl::plan::{FlowError, FlowPlan, FlowRow, Motor, Phase, Step};
use pump_model::Pump;

/// Returns the published pump's motor.
pub(crate) fn motor() -> Motor {
    Motor::new(12_800.0, 17.8, 500.0)
}

/// Angle of a step of that motor, rad.
pub(crate) const STEP_RAD: f64 = TAU / 12_800.0;

/// Returns rows of these times and flows.
pub(crate) fn rows(of: &[(f64, f64)]) -> Vec<FlowRow> {
    of.iter().map(|(time_s, flow_ml_s)| FlowRow::new(*time_s, *flow_ml_s)).collect()
}

/// Returns all steps of a flow over time, or why there are none.
pub(crate) fn steps(pump: &Pump, start_rad: f64, of: &[FlowRow]) -> Result<Vec<Step>, FlowError> {
    let mut plan = FlowPlan::new(pump, motor(), Phase::known(start_rad))?;
    let mut steps = Vec::new();
    for row in of {
        steps.extend(plan.take(*row)?.into_iter().flatten());
    }
    plan.end()?;
    assert_eq!(plan.steps().unsigned_abs(), steps.len() as u64);
    Ok(steps)
}
