//! Plan of a flow over time, for the published pump. The tests of the Klipper driver use it too.

use pump_bench::built_in;
use pump_ctl::plan::{FlowKnot, FlowMotion, FlowPace, FlowPlan, FlowRow, Phase};
use pump_model::Pump;

/// Plan of a flow in a direction.
pub(crate) struct Flow {
    pump: Pump,
    knots: Vec<FlowKnot>,
    pace: FlowPace,
}

impl Flow {
    /// Plans rows of times in s and flows in mL/s. `sign` is that of the direction.
    pub(crate) fn new(rows: &[(f64, f64)], sign: f64) -> Self {
        let file = built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        let mut plan = FlowPlan::new(&pump, file.limits().motor, Phase::known(0.9)).unwrap();
        let mut knots = Vec::new();
        for (time_s, flow_ml_s) in rows {
            plan.take(FlowRow::new(*time_s, sign * flow_ml_s)).unwrap();
            knots.extend(plan.knot());
        }
        let pace = plan.end().unwrap();
        Self { pump, knots, pace }
    }

    pub(crate) fn motion(&self) -> FlowMotion<'_> {
        let motor = built_in("three-roller").unwrap().limits().motor;
        FlowMotion::new(&self.pump, motor, Phase::known(0.9), &self.knots, self.pace)
    }
}
