//! The stretches of a motion that the journal announces ahead of the motor.

use pump_ctl::plan::Plan;
use pump_model::Pump;
use pump_model::math::ceil;

/// Longest stretch between two entries of the journal, in s.
const STRETCH_S: f64 = 0.5;

/// Largest stretch between two entries of the journal, in mL. The shorter of the two limits counts.
const STRETCH_ML: f64 = 0.5;

/// Stretches of a plan that the journal announces.
pub(super) struct Stretches<'a> {
    plan: &'a Plan,
    /// Most steps that give [`STRETCH_ML`].
    steps: u64,
    /// Steps of a stop from the fastest speed.
    stop: u64,
    /// Last step of the stretch under way.
    pub(super) end: u64,
}

impl<'a> Stretches<'a> {
    /// Divides `plan` into stretches, none of them begun.
    pub(super) fn new(plan: &'a Plan, model: &Pump) -> Self {
        let (_, most_ml_rad) = model.outlet_curve().flow_range_ml_rad();
        let peak_rad_s = plan.profile.peak_rad_s();
        let stop_rad = peak_rad_s * peak_rad_s / (2.0 * plan.profile.acceleration_rad_s2());
        Self {
            plan,
            steps: ((STRETCH_ML / (most_ml_rad * plan.step_rad)) as u64).max(1),
            stop: ceil(stop_rad / plan.step_rad) as u64 + 1,
            end: 0,
        }
    }

    /// Goes on to the stretch that begins with step `first`.
    ///
    /// Returns the most steps that may be made before the next entry: the steps of the stretch and of a stop
    /// at its end.
    pub(super) fn next(&mut self, first: u64) -> u64 {
        let time_s = |step: u64| self.plan.profile.time_of(step as f64 * self.plan.step_rad);
        let latest_s = time_s(first) + STRETCH_S;
        let all = self.plan.steps.unsigned_abs();
        let (mut within, mut beyond) = (first, (first + self.steps).min(all + 1));
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if time_s(middle) <= latest_s {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        self.end = within;
        (within + self.stop).min(all)
    }
}
